#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "box_tree.h"
#include "hydrotin/lattice.h"
#include "hydrotin/options.h"

/// Vector layers that say where water may leave, or which pits to keep, on the lattice of the data set.
///
/// Coordinates are rounded to lattice points; what follows is exact. A point stands for the lowest corner, by
/// (z, x, y), of the triangle it lies in (of each, on an edge); a line for the lowest corner of each triangle that it
/// meets; a polygon for the vertices inside it or on its border. So each triangle and each vertex decides for itself:
/// tiles need not ask each other.
///
/// Threads  Const functions are safe to call concurrently.

namespace hydrotin {

struct Plan;

class PlaceLayer {
 public:
  PlaceLayer() : segment_tree_({}), ring_tree_({}) {}
  /// All features of a file, brought into the CRS of the data set; features beyond the lattice are dropped.
  /// Fails: Error(input) naming the file: unreadable, or without a feature that can be used.
  PlaceLayer(const std::string& path, const Plan& plan, bool only_polygons);

  /// Whether p lies in a polygon or on its border.
  [[nodiscard]] bool covers(LatticePoint p) const;
  /// Whether a point or line meets a triangle, its border included.
  /// @param corner  counter-clockwise
  [[nodiscard]] bool meets(std::span<const LatticePoint, 3> corner) const;
  [[nodiscard]] std::uint64_t num_polygons() const { return num_polygons_; }
  /// Of all that matters, for recipes.
  [[nodiscard]] std::string hash() const;

 private:
  struct Segment {
    LatticePoint a, b;  ///< equal: a point
    std::uint32_t polygon = 0;
  };
  static BoxTree tree_of(const std::vector<Segment>& segments);

  std::vector<Segment> segment_, ring_;  ///< of points and lines; of polygons
  BoxTree segment_tree_, ring_tree_;
  std::uint64_t num_polygons_ = 0;
};

struct PitPlaces {
  PlaceLayer outlets, keep;
  std::string hash;
};

/// The layers that the options name; empty ones where they name none.
[[nodiscard]] std::shared_ptr<const PitPlaces> load_pit_places(const PitOptions& options, const Plan& plan);

}  // namespace hydrotin
