#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common_lattice.h"
#include "hydrotin/lattice.h"
#include "hydrotin/options.h"

/// The plan: which files, which lattice, which tiles.
///
/// Tiles are the leaves of a k-d tree: the box of the data is halved along its longer side until the points expected in
/// a leaf (from the headers: each file's points spread evenly over its box) are no more than the target. The outer
/// leaves reach to infinity, so that every point belongs to one tile whatever the headers claim.

namespace hydrotin {

/// So many reference points weigh as much as one point when tiles are cut and memory is planned.
inline constexpr int kReferencePerPoint = 4;

struct PlanFile {
  std::string path;
  std::uint64_t points = 0;
  LatticeMap map;
  bool is_reference = false;  ///< its points are no vertices
  bool is_dem = false;        ///< a raster: the rows below are what the unit reads
  std::uint64_t first_row = 0, num_rows = 0;

  /// Whether it is the only or the first unit that reads the file.
  [[nodiscard]] bool is_first() const { return first_row == 0; }
};

/// Inner node: points with (axis 0: x, axis 1: y) < `split` go to `below`, others to `above`. Leaf: axis 2, `below` =
/// tile.
struct PlanNode {
  std::uint32_t axis = 2;
  std::int32_t split = 0;
  std::uint32_t below = 0, above = 0;
};

struct Plan {
  std::string recipe;
  std::vector<PlanFile>
      files;  ///< units of ingest: rasters (in ranges of rows) by path, then points by path, then reference points
  std::string crs, crs_wkt;    ///< empty: none
  double metres_per_unit = 1;  ///< of x and y
  Lattice lattice;
  LatticeBox data;                      ///< that the headers claim
  std::vector<PlanNode> nodes;          ///< root first
  std::vector<LatticeBox> core;         ///< [tiles] closed boxes that cover the lattice without overlap
  std::vector<std::uint64_t> expected;  ///< [tiles] points expected, with what reference points weigh

  [[nodiscard]] bool has_reference() const { return !files.empty() && files.back().is_reference; }
  [[nodiscard]] std::uint32_t num_tiles() const { return static_cast<std::uint32_t>(core.size()); }
  [[nodiscard]] std::uint32_t tile_of(LatticePoint p) const {
    std::uint32_t node = 0;
    while (nodes[node].axis != 2)
      node = (nodes[node].axis == 0 ? p.x : p.y) < nodes[node].split ? nodes[node].below : nodes[node].above;
    return nodes[node].below;
  }
};

/// Checks all inputs and cuts the tiles. Reads headers only.
/// Fails: Error(input) for an input that cannot be used, Error(config) if there is none.
[[nodiscard]] Plan make_plan(const PipelineOptions& options);

void save_plan(const Plan& plan, const std::string& path);
[[nodiscard]] Plan load_plan(const std::string& path);

}  // namespace hydrotin
