#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "hydrotin/lattice.h"

/// Vector layers that say where water may leave, or which pits to keep, on the lattice of a terrain.
///
/// Coordinates are rounded to lattice points; what follows is exact. A point stands for the lowest corner, by
/// (z, x, y), of the triangle it lies in (of each, on an edge); a line for the lowest corner of each triangle that it
/// meets; a polygon for the vertices inside it or on its border. So each triangle and each vertex decides for itself:
/// tiles need not ask each other.
///
/// Source   FINDINGS C1: outlets are a policy.
/// Threads  Const functions are safe to call concurrently.

namespace hydrotin {

class PlaceLayer {
 public:
  /// No features.
  PlaceLayer();
  /// All features of a file, brought into a CRS; features beyond the lattice are dropped.
  /// @param crs_wkt  of the terrain; empty = unknown, coordinates are taken as they are.
  /// Fails: Error(input) naming the file: unreadable, or without a feature that can be used.
  PlaceLayer(const std::string& path, const Lattice& lattice, const std::string& crs_wkt, bool only_polygons);
  PlaceLayer(PlaceLayer&&) noexcept;
  PlaceLayer& operator=(PlaceLayer&&) noexcept;
  ~PlaceLayer();

  /// Whether p lies in a polygon or on its border.
  [[nodiscard]] bool covers(LatticePoint p) const;
  /// Whether a point or line meets a triangle, its border included.
  /// @param corner  counter-clockwise
  [[nodiscard]] bool meets(std::span<const LatticePoint, 3> corner) const;
  /// Sets the flags of the vertices that the features stand for.
  /// @param position, height, is_marked  [n]  @param triangle_vertex  [3T] counter-clockwise
  /// Complexity: O((n + T) log s) for s segments spread evenly.
  void mark(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
            std::span<const std::uint32_t> triangle_vertex, std::span<std::uint8_t> is_marked) const;
  [[nodiscard]] std::uint64_t num_polygons() const;
  /// Of all that matters, for recipes.
  [[nodiscard]] std::string hash() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace hydrotin
