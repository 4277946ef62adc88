#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/river_embedding.h"
#include "hydrotin/river_network.h"

/// Rivers embedded by moving river vertices only, in strongly polynomial time.
///
/// Going downstream, C_v(h) is the least change of all river vertices above and at v when v ends at height h. It is
/// convex and piecewise linear; C_v(h) = |h - h0_v| + sum over the edges uv of C_u(H_uv(h)), where H_uv clamps the best
/// height of u to what flow and both valleys leave at h. C_v may have exponentially many breaks, so it is never written
/// down. Its minimum is found by walking up the river with an interval that holds it: the breaks of one level are
/// candidates in the coordinate of v, a binary search by slopes shrinks the interval until no break of the level is
/// inside, and then every edge of the level is one linear piece. (The thesis numbers the breaks instead; this way needs
/// no numbers and merges rivers as they come.)
///
/// Source   thesis, Section 7.3, Theorem 7.2; confluences, strict declines and side slopes are included.
/// Numbers  Coordinates and heights are taken as the rationals that doubles are; all arithmetic is in rationals of any
///          size (integers of exponential size occur in the thesis's bound, too). Nothing is rounded but the result.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

enum class BurningFault : std::uint8_t {
  none,
  not_a_forest,      ///< a vertex with two river edges down, or an undirected cycle
  river_at_wingtip,  ///< a triangle at a river edge has a third river vertex
  infeasible,        ///< no heights of river vertices satisfy the rows of the edges above this one
};

struct Burning {
  BurningFault fault = BurningFault::none;
  std::uint32_t edge = 0;         ///< index of the edge in question where there is a fault
  std::vector<double> height;     ///< [n]
  double objective = 0;           ///< sum |h - h0|, rounded once from the exact sum
  std::uint64_t evaluations = 0;  ///< of slopes of some C_v
};

/// What the edges must satisfy.
struct BurningRows {
  std::span<const double> decline;  ///< [R] least drop of each edge; 0 = weak flow
  double side_slope = 0;            ///< of the wingtips; 0 = weak valleys
  std::size_t num_chains = 0;       ///< the last edges are of outlet chains: water must not climb, that is all
  double quantum = 0;  ///< the rows hold with the margins of the linear program, so also for multiples of it
};

/// @param rivers   edges of the terrain without fault (`check_network`), those of chains last.
/// Complexity: O(R^3) operations on numbers, O(R^2) evaluations at most; far fewer where rivers are nearly right.
/// Fails: never on data; std::bad_alloc.
[[nodiscard]] Burning burn_rivers(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                  const BurningRows& rows);

/// The same as an answer to the constraints of an embedding: flow, valley, decline, side slope and outlet chains, with
/// the vertices of rivers and chains moving only. Heights that moved are multiples of the quantum if there is one.
struct BurnedEmbedding {
  BurningFault fault = BurningFault::none;
  RiverEdge edge;  ///< in question where there is a fault
  Embedding embedding;
};

/// Preconditions: flow and valley are asked for; no lakes, preserved edges, contiguity, directions or largest change.
/// The result is optimal among all heights of these vertices; `incomplete` as `embed_rivers` has it.
[[nodiscard]] BurnedEmbedding embed_by_burning(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                               const EmbeddingOptions& options);

/// The least drops [R] of a decline that is a fraction of each network's average slope.
[[nodiscard]] std::vector<double> fractional_declines(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                                      double fraction);

}  // namespace hydrotin
