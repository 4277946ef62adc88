#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/river_network.h"

/// Where rivers end, and how their water gets on from there.
///
/// A mouth is a river vertex without a river edge down. It is well placed at an outlet: on the rim, in a lake, at a
/// declared sink. Any other gets an *outlet chain*: the way to an outlet or to another river on which water has to
/// climb least. All mouths look for theirs at once, downhill first, always on from where the water stands lowest; a
/// river is an aim once all its water has a way out. So only the surroundings of the mouths and of their ways are
/// looked at: a part of a terrain will do, if it tells which of its vertices have all their triangles. Rows h_v >=
/// h_next along the chains belong into the linear program; then every river vertex has a way to an outlet that never
/// rises, and lifting moves none of them.
///
/// A lake counts as one vertex: if no river leaves it, it is an outlet; otherwise it has a way out where all rivers
/// that leave it have one. A mouth in a lake needs no chain.
///
/// Source   FINDINGS D5 (with the proof). Symbols  n = vertices, R = river edges.
/// Properties
///   (1) From every mouth that is not closed a chain, then rivers and chains, lead to an outlet; river edges and chains
///       together have no directed cycle.
///   (2) A chain is a way over which the highest vertex is as low as on any way that keeps to the rule.
///   (3) Ties by (x, y): no numbering matters.
///   (4) Of a part of a terrain: the chains of the whole terrain, or vertices around which the part must grow.
/// Threads  Pure.

namespace hydrotin {

enum class MouthKind : std::uint8_t {
  outlet,   ///< an outlet itself, or in a lake
  chained,  ///< has an outlet chain
  closed,   ///< its own river lies around it: no chain is possible, it has to be an outlet
};

struct RiverMouth {
  std::uint32_t vertex = 0;
  MouthKind kind = MouthKind::outlet;
  std::uint32_t length = 0;  ///< edges of its chain, up to the chain of another mouth
  double climb = 0;          ///< how much the highest vertex of the way lies above the mouth
};

struct OutletChains {
  std::vector<RiverMouth> mouth;  ///< ascending by (x, y)
  std::vector<RiverEdge>
      edge;  ///< of all chains, downstream, ascending by (x, y) of `from`; each vertex has one at most
  std::vector<std::uint32_t> incomplete;  ///< ascending; not empty: the rest is void, these need all their triangles
};

/// @param is_outlet  [n]
/// @param lake       [n] or empty: of `lake_numbers` after `close_lakes`; 0 = in none.
/// @param is_complete  [n] nonzero: all triangles of the vertex are there; or empty: of every vertex.
/// Complexity: O(n + T) plus O(log) for each vertex that a mouth looks at: those on its way, and in the pits along it.
[[nodiscard]] OutletChains find_outlet_chains(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                              std::span<const std::uint8_t> is_outlet,
                                              std::span<const std::uint32_t> lake,
                                              std::span<const std::uint8_t> is_complete = {});

/// [n] nonzero: on an edge that only one triangle has. Complexity: O(T log T).
[[nodiscard]] std::vector<std::uint8_t> rim_vertices(const RiverTerrain& terrain);

}  // namespace hydrotin
