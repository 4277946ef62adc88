#pragma once

#include <span>
#include <vector>

#include "hydrotin/river_constraints.h"
#include "hydrotin/river_embedding.h"

/// What embedded rivers ask of the heights around them, for steps that come after the embedding.
///
/// Source   thesis, Section 7.1.1 (valley constraint); FINDINGS D5 (rivers first, pits last).
/// Units    metres. Threads: pure.

namespace hydrotin {

/// The least height that the valley rows of river edges allow each vertex while the rivers stay as they are: -infinity
/// for vertices that are no wingtip. Rounded upwards: a wingtip at this height or above satisfies its rows exactly.
/// @param height  [n] of the embedded terrain.
[[nodiscard]] std::vector<double> valley_floor(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                               double side_slope, std::span<const double> height);

/// Rows that limit the change and leave no room: heights at the end of a slope limit or of the largest change.
struct BindingLimit {
  RowKind kind = RowKind::slope_limit;
  bool is_largest_change = false;  ///< of one vertex: the kind does not matter
  std::vector<std::uint32_t> vertex;
};

/// @param tolerance  how near to the limit counts [m].
/// @param quantum    of the embedding: rows that leave no room for its margins are no rows, and its steps count as
/// near. Complexity: O(n + T). In (x, y) order. Of a part of a terrain in which every vertex that moved has all its
/// triangles it lists the same.
[[nodiscard]] std::vector<BindingLimit> binding_limits(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                                       const RiverConstraints& constraints,
                                                       std::span<const double> height, double tolerance,
                                                       double quantum = 0);

/// Edges whose slope changed by more than the limit of the constraints; those with a vertex on a river or an outlet
/// chain are exempt, and flat ones. Complexity: O(T log T).
[[nodiscard]] std::uint64_t count_beyond_slope_limit(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                                     const RiverConstraints& constraints,
                                                     std::span<const double> height, double tolerance);

}  // namespace hydrotin
