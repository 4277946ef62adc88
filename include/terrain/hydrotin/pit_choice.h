#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hydrotin/pit_hierarchy.h"
#include "hydrotin/vertex_graph.h"

/// Choosing which pits to remove and which to keep.
///
/// A kept pit becomes an outlet: all vertices of its plateau. Whatever method then removes the other pits leaves its
/// bottom where it is, and lets water end there. So a kept pit costs nothing, its children (`PitBasin::parent`) drain
/// into it, and the spill level of its own basin no longer matters. Lakes and declared sinks that must stay in any case
/// are outlets from the start and no pits at all.
///
/// Source   thesis, Section 6 ("removing a given subset of the local minima, removing all of them, or removing the
///          cheapest m") and Section 6.1.
/// Symbols  n = vertices, p = pits.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

/// One reason to keep a pit: all of its conditions hold. Areas and volumes of water up to the spill level. A pit that
/// never overflows is deeper, larger and more voluminous than anything.
struct KeepClause {
  std::int64_t deeper_than = -1;  ///< depth > this [z lattice units]
  double larger_than = -1;        ///< area > this [squared lattice units]
  double volume_above = -1;       ///< volume > this [cubed lattice units]
  bool only_marked = false;       ///< the pit is in the list, or in a polygon: `is_marked`
};

/// Which pits are kept: those with at least one reason. ("and" within a clause, "or" between clauses.)
///
/// @param is_marked  [p], or empty: none.
/// @return           [p] nonzero: kept.
/// Complexity: O(p * clauses).
[[nodiscard]] std::vector<std::uint8_t> pits_to_keep(std::span<const PitBasin> pits,
                                                     std::span<const KeepClause> clauses,
                                                     std::span<const std::uint8_t> is_marked);

/// What users say about pits to keep. Empty members are conditions that are not given; none given: no pit is kept.
struct KeepConditions {
  std::optional<double> deeper_than;          ///< depth > this [z lattice units]; a multiple of the unit is not passed
                                              ///< by the rounding of its text
  std::optional<double> larger_than;          ///< area > this [squared lattice units]
  std::optional<double> volume_above;         ///< volume > this [cubed lattice units]
  std::span<const std::uint8_t> is_inside{};  ///< [p] nonzero: in a polygon
  std::span<const std::uint8_t> is_listed{};  ///< [p] nonzero: named
  bool all_conditions = false;                ///< all that are given must hold; else one is enough
};

/// @return  [p] nonzero: kept.
/// Complexity: O(p).
[[nodiscard]] std::vector<std::uint8_t> pits_to_keep(std::span<const PitBasin> pits, const KeepConditions& conditions);

/// Flags of the pits with these numbers.
///
/// @param option  what the user calls the list, for the message.
/// Fails: Error(config) for a number that no pit has.
[[nodiscard]] std::vector<std::uint8_t> listed_pits(std::span<const std::uint64_t> ids, std::size_t num_pits,
                                                    const std::string& option);

/// Keeps all but the m pits that are cheapest to lift together: least total displacement over all choices of m pits,
/// nested pits accounted for; the first m pits by (price, height, representative). Pits that never overflow are kept.
///
/// Why prices: in the tree of merging pools, let c(X, j) be the least cost of removing j of the pits of a pool X. If
/// not all are removed, it is the best split among the pools that X is made of; if all are, X must rise to its own
/// spill, which costs D(X) >= sum of the D of its parts. Convex costs of parts have a convex best split, and raising
/// its last value keeps it convex; so the sequence of increments of X is that of its parts merged in ascending order,
/// the last one increased by D(X) - sum of D. The pit with the last increment bears the increase: the increments, one
/// per pit, are the prices, and for each m the m smallest are an optimal choice.
///
/// @return  [p] nonzero: kept.
/// Complexity: O(p log p).
[[nodiscard]] std::vector<std::uint8_t> keep_all_but_cheapest(std::span<const PitBasin> pits, std::size_t m);

/// The outlets with the plateaus of kept pits added: the terrain on which to remove the others.
///
/// @param is_kept    [p] for the pits of this terrain with these outlets (`Pit::vertex` = its vertices).
/// @return           [n]
/// Complexity: O(n) plus the edges of the kept plateaus.
[[nodiscard]] std::vector<std::uint8_t> outlets_and_kept_pits(const VertexGraph& graph,
                                                              std::span<const std::int32_t> height,
                                                              std::span<const std::uint8_t> is_outlet,
                                                              std::span<const PitBasin> pits,
                                                              std::span<const std::uint8_t> is_kept);

}  // namespace hydrotin
