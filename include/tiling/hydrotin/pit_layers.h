#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hydrotin/drainage_problem.h"
#include "hydrotin/lattice.h"
#include "hydrotin/pit_hierarchy.h"
#include "hydrotin/vector.h"

/// What users see of pits and of what became of them: the layers `pits` (points), `lifted` (polygons) and `breaches`
/// (lines), and the pits as a table. The same for terrains in tiles and in memory.
///
/// Units    lattice units in, units of the CRS out.
/// Errors   Error(storage) from the writer.
/// Threads  An object belongs to the thread of its writer.

namespace hydrotin {

/// The layer `pits`: id (place in the list), parent (-1: overflows for good), z_before, z_level, depth, spill_x,
/// spill_y, area, volume, vertices, plateau, displacement, kept.
/// @param is_kept  [p] nonzero: stays.
void write_pit_layer(const Lattice& lattice, std::span<const PitBasin> pits, std::span<const std::uint8_t> is_kept,
                     GeoPackageWriter& out);

/// The same as CSV, with x and y before the other columns. Ten significant digits.
[[nodiscard]] std::string pits_csv(const Lattice& lattice, std::span<const PitBasin> pits,
                                   std::span<const std::uint8_t> is_kept);

/// The layer `lifted`: level, lowest, max_depth, vertices, displacement, volume.
class LiftedLayer {
 public:
  LiftedLayer(const Lattice& lattice, GeoPackageWriter& out);

  struct Region {
    std::int32_t level = 0, lowest = 0;  ///< final height; lowest height before
    std::uint64_t vertices = 0;
    std::int64_t displacement = 0;
    double volume = 0;
  };
  void begin(const Region& region);
  /// @param xy  x and y in turn; outer rings come first.
  void add_ring(std::span<const std::int32_t> xy);
  void end();

 private:
  Lattice lattice_;
  GeoPackageWriter* out_;
  int layer_;
  Region region_;
  std::vector<std::vector<VectorPoint>> rings_;
};

/// The layer `breaches`: pit_height, length, max_depth, cost (in the measure), displacement, volume, lowered, from_pit.
class BreachLayer {
 public:
  BreachLayer(const Lattice& lattice, ChangeMeasure measure, GeoPackageWriter& out);

  struct Line {
    std::int32_t pit_height = 0;  ///< kNoLevel: it starts at no pit
    std::int32_t depth = 0;
    std::uint64_t lowered = 0;
    std::int64_t displacement = 0;
    double length = 0, volume = 0;
  };
  /// @param xyz  points with their new heights, from the pit to where it drains.
  void add(const Line& breach, std::span<const std::int32_t> xyz);

 private:
  Lattice lattice_;
  ChangeMeasure measure_;
  GeoPackageWriter* out_;
  int layer_;
  std::vector<VectorPoint> line_;
};

/// Name and unit of a measure: "total", "max", "count", "volume"; the factor from sums of lattice units (of weights
/// that are doubled areas of stars, for volume) to units of the CRS.
[[nodiscard]] std::string name_of(ChangeMeasure measure);
[[nodiscard]] double unit_of(ChangeMeasure measure, const Lattice& lattice);

}  // namespace hydrotin
