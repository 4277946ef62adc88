#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "block_index.h"
#include "hydrotin/id.h"
#include "hydrotin/lattice.h"
#include "store.h"

/// A finished data set read from its files alone.
///
/// Errors  Error(storage) naming the file.

namespace hydrotin {

/// terrain/index.h5.
struct DatasetIndex {
  std::string dir, path;
  Lattice lattice;
  std::vector<std::uint64_t> count;      ///< [tiles] own points
  std::vector<LatticeBox> box;           ///< [tiles] of the own points
  std::vector<std::uint64_t> triangles;  ///< [tiles]
  std::vector<std::uint64_t> checksum;   ///< [tiles] of all bytes of the file; empty in an index that has none
  std::uint64_t points = 0, vertices = 0, duplicates = 0, num_triangles = 0, pits = 0;
  std::uint64_t removed = 0;                   ///< points that thinning removed
  double removed_max_error = 0;                ///< the largest of their errors, z lattice units
  std::int64_t removed_limit_millionths = -1;  ///< that none of them exceeds; negative: nothing is promised
  int order = 0;
  std::string fingerprint;
  std::string outlets;          ///< hull, lowest, layer, or none where pits were left
  std::uint64_t pits_kept = 0;  ///< on purpose
  PointId lowest;
  std::uint64_t river_edges = 0, invalid_river_edges = 0;
  bool river_flow = true, river_valley = true;  ///< what makes a river edge valid
  std::vector<LatticePoint> new_position;       ///< vertices that rivers added: points of tile number num_tiles
  std::vector<std::int32_t> new_height;         ///< interpolated
  std::vector<std::pair<std::uint64_t, std::uint64_t>> contradicted;  ///< river edges that no heights make valid

  [[nodiscard]] std::uint32_t num_tiles() const { return static_cast<std::uint32_t>(count.size()); }
  [[nodiscard]] std::string tile_path(std::uint32_t tile) const;
  /// "(x, y)" in the coordinates of the CRS.
  [[nodiscard]] std::string place(LatticePoint p) const;
};

[[nodiscard]] DatasetIndex load_index(const std::string& dir);

/// terrain/tile_NNNNNN.h5: n = own points + foreign points, numbered as its triangles refer to them.
struct TerrainTile {
  std::string path;
  std::uint32_t tile = 0, num_own = 0;
  std::vector<LatticePoint> position;    ///< [n]
  std::vector<std::int32_t> measured;    ///< [n]
  std::vector<std::int32_t> height;      ///< [n] final, kUnusedHeight where an own point is not used here
  std::vector<std::uint64_t> foreign;    ///< ascending, of other tiles
  std::vector<std::uint32_t> triangle;   ///< [3T] below n
  std::vector<std::uint64_t> hull_edge;  ///< [2H]
  std::vector<LatticeBox> block_box, triangle_box;
  std::vector<std::int32_t> embedded;                     ///< [n] as measured, or as the rivers left it
  std::vector<std::uint32_t> river_edge;                  ///< [2R] below n: from, to
  std::vector<std::uint32_t> added_triangle;              ///< ascending, below T
  std::vector<std::uint32_t> outlet_vertex, kept_vertex;  ///< below n: water may leave; vertices of kept pits
  std::string fingerprint, outlets, pit_method;
  bool pits_removed = false;

  [[nodiscard]] std::uint32_t num_vertices() const { return static_cast<std::uint32_t>(position.size()); }
  [[nodiscard]] std::uint64_t id(std::uint32_t v) const {
    return v < num_own ? PointId(tile, v).value : foreign[v - num_own];
  }
};

/// Reads every array of the file, so that all its checksums are tested, and checks sizes and ranges.
[[nodiscard]] TerrainTile load_terrain_tile(const DatasetIndex& index, std::uint32_t tile);

}  // namespace hydrotin
