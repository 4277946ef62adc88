#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/river_statistics.h"

/// Rivers one by one: the tables of Section 7.2 for each of them, and their longitudinal profiles.
///
/// A river is any set of river edges, given by a number for each edge: connected networks, or edges of one name.
///
/// Source   thesis, Tables 7.2 to 7.4. Symbols  R = river edges, G = rivers.
/// Units    metres. Threads: pure.

namespace hydrotin {

struct RiverRow {
  std::uint64_t edges = 0;
  double length = 0, drop_before = 0, drop_after = 0;
  std::uint64_t wrong_flow_before = 0, not_valley_before = 0, flat_before = 0, leaks_before = 0;
  std::uint64_t wrong_flow_after = 0, not_valley_after = 0, flat_after = 0, leaks_after = 0;
  std::uint64_t moved = 0;        ///< vertices, on the river or joined to it by others that moved
  double total = 0, largest = 0;  ///< change of these
};

/// A vertex that moved counts for the river from which the fewest edges between vertices that moved lead to it; of
/// several for the one with the smallest number; for none if it is joined to no river so.
/// @param river  [R] below num_rivers.
/// Complexity: O(n log n + T + R log R).
[[nodiscard]] std::vector<RiverRow> river_table(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                                std::span<const std::uint32_t> river, std::uint32_t num_rivers,
                                                std::span<const double> after, double tolerance);
/// The same with the faults before and after at hand.
[[nodiscard]] std::vector<RiverRow> river_table(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                                std::span<const std::uint32_t> river, std::uint32_t num_rivers,
                                                std::span<const double> after, double tolerance, const RiverFaults& old,
                                                const RiverFaults& now);

/// Longest ways down of rivers as CSR: way of river g: vertex[begin[g] .. begin[g + 1]), from source to mouth.
struct MainStems {
  std::vector<std::size_t> begin{0};
  std::vector<std::uint32_t> vertex;
};

/// Longest in the plane; ties by (x, y). Precondition: no directed cycle. O(n + R log R).
[[nodiscard]] MainStems main_stems(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                   std::span<const std::uint32_t> river, std::uint32_t num_rivers);

}  // namespace hydrotin
