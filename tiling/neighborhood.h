#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <unordered_set>
#include <vector>

#include "block_index.h"
#include "disc.h"
#include "hydrotin/id.h"
#include "phases.h"

/// The points that one tile has loaded, and the certificate that they are enough.
///
/// A region is *covered* if every block of every tile that meets it is loaded, or meets it only inside the window,
/// whose points are all loaded. Blocks are tight boxes around points, so an uncovered region names exactly which points
/// to fetch, also when they are tiles away across a lake; the nearest are fetched first, since they shrink the region.
///
/// Source   DESIGN section 3, "Ownership and the certificate".
/// Threads  One object by one thread.

namespace hydrotin {

class Neighborhood {
 public:
  /// Loads the tile's own points (vertex ids 0 .. num_own), all other points inside `window`, and the vertices of the
  /// convex hull of everything.
  Neighborhood(const RunContext& context, std::uint32_t tile, double halo);

  [[nodiscard]] std::uint32_t num_own() const { return num_own_; }
  [[nodiscard]] const LatticeBox& window() const { return window_; }
  [[nodiscard]] const LatticeBox& own_box() const { return context_.outline.box[tile_]; }
  [[nodiscard]] const std::vector<LatticePoint>& position() const { return position_; }
  [[nodiscard]] const std::vector<std::int32_t>& height() const { return height_; }
  [[nodiscard]] const std::vector<PointId>& point() const { return point_; }

  /// Whether the region is covered; if not, asks for the blocks of it nearest to `anchor`.
  [[nodiscard]] bool covers(const Region& region, LatticePoint anchor);

  /// Loads what was asked for. Returns whether there was anything.
  bool fetch();

  [[nodiscard]] std::uint64_t num_fetched() const { return num_fetched_; }

 private:
  struct Directory {
    std::vector<LatticeBox> box;
    BoxTree tree{{}};  // of `box`
    std::vector<std::uint8_t> loaded, wanted;
  };

  Directory& directory(std::uint32_t tile);
  const store::Reader& reader(std::uint32_t tile);
  void load_block(std::uint32_t tile, std::uint32_t block, const LatticeBox* only_inside);
  void add(PointId id, LatticePoint position, std::int32_t height);
  [[nodiscard]] bool needs(const Directory& directory, std::uint32_t block, const Region& region) const;

  const RunContext& context_;
  std::uint32_t tile_, num_own_ = 0;
  LatticeBox window_;
  std::map<std::uint32_t, store::Reader> readers_;
  std::map<std::uint32_t, Directory> directories_;
  std::vector<LatticePoint> position_;
  std::vector<std::int32_t> height_;
  std::vector<PointId> point_;
  std::unordered_set<std::uint64_t> single_;  // hull vertices, loaded apart from their blocks
  std::vector<std::pair<std::uint32_t, std::uint32_t>> wanted_;
  std::uint64_t num_fetched_ = 0;
};

}  // namespace hydrotin
