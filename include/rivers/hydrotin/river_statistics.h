#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/river_network.h"

/// What Tables 7.2, 7.3 and 7.4 of the thesis count.
///
/// Source   thesis, Section 7.2.
/// Units    metres. Threads: pure.

namespace hydrotin {

struct RiverStatistics {
  std::uint64_t wrong_flow = 0;     ///< river edges with h_from < h_to
  std::uint64_t not_valley = 0;     ///< river edges with a wingtip below the plane H
  std::uint64_t flat_edges = 0;     ///< river edges with h_from = h_to
  std::uint64_t leak_vertices = 0;  ///< river vertices from which a way is steeper than the steepest river edge down
  std::uint64_t local_minima = 0;   ///< of the terrain; a plateau counts as one
};

/// The same edge by edge.
struct RiverFaults {
  std::vector<std::uint8_t> wrong_flow, not_valley, flat;  ///< [R]
  std::vector<std::uint32_t> leak_vertex;                  ///< ascending
};
[[nodiscard]] RiverFaults river_faults(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                       std::span<const double> height, double tolerance);

/// The steepest way down from some vertices over their triangles, rise over run; negative where all ways rise,
/// -infinity without triangles. Of a vertex whose triangles are in several parts of a terrain the largest counts.
/// Complexity: O(n + T).
[[nodiscard]] std::vector<double> steepest_ways(const RiverTerrain& terrain, std::span<const double> height,
                                                std::span<const std::uint32_t> vertices);

/// Whether water leaks from a river vertex.
/// @param steepest_river  slope of its steepest river edge down; @param shortest  length of its shortest one.
[[nodiscard]] bool is_leak(double steepest_way, double steepest_river, double shortest, double tolerance);

/// @param height     [n] to use in place of those of the terrain.
/// @param tolerance  0: in exact arithmetic (heights as stored); otherwise what a height may be off [m].
/// Complexity: O(n log n + T + R).
[[nodiscard]] RiverStatistics river_statistics(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                               std::span<const double> height, double tolerance);

/// How the heights differ.
struct HeightChange {
  std::uint64_t moved = 0;                     ///< vertices
  double total = 0, average = 0, largest = 0;  ///< the average over the vertices that moved
};

[[nodiscard]] HeightChange height_change(std::span<const double> before, std::span<const double> after,
                                         double tolerance);

}  // namespace hydrotin
