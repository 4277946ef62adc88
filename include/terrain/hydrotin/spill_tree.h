#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "hydrotin/vertex_graph.h"

/// Lifting a terrain that is cut into parts: each part reduced to its rim, and the global pass over the reduced parts.
///
/// For lifting, a part is known to the others by one number for each pair of its terminals (rim vertices, and one
/// terminal that stands for all outlets): the least height that a path inside the part must climb to between them. A
/// minimax spanning forest of the terminals, at most |rim| edges, holds all these numbers. The union of the forests of
/// all parts has the same minimax heights as the whole terrain, because a path of the whole falls into pieces between
/// rim vertices, each inside one part. So: reduce each part, `drain` all of them together, `lift_from` each part with
/// its rim's levels.
///
/// Source   thesis, Section 6.1 (saddles of the contour tree, of which the forest keeps those that the rim can see).
/// Symbols  n, E = vertices, edges of a part; R = its rim vertices.
/// Properties
///   (1) Minimax heights between terminals in the forest are those in the part.
///   (2) The forest has at most R edges.
///   (3) Levels of rim vertices from `drain` are those of `lift` on the whole terrain, for every way of cutting it; so
///       are the levels of all vertices from `lift_catchments` and from `lift_from`.
/// Ties     The forest is not unique under ties and depends on the numbering of the part; the levels are and do not.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

/// The terminal of all outlets in `SpillEdge::b`.
inline constexpr std::uint32_t kOutlet = std::numeric_limits<std::uint32_t>::max();

/// Water at one end reaches the other when it stands at `height`.
struct SpillEdge {
  std::uint32_t a = 0;      ///< index into SpillTree::rim
  std::uint32_t b = 0;      ///< another, or kOutlet
  std::int32_t height = 0;  ///< at least the heights of both ends
  friend constexpr auto operator<=>(const SpillEdge&, const SpillEdge&) = default;
};

/// One part reduced to its rim.
struct SpillTree {
  std::vector<std::uint64_t> rim;  ///< [R] global ids, ascending
  std::vector<SpillEdge> edge;     ///< at most R, by ascending height
};

/// Where water of each vertex of a part first reaches a terminal if all terminals are sinks. Not unique under ties.
struct Catchments {
  std::vector<std::int32_t>
      level;  ///< [n] least height to climb to on the way to a terminal, kNoLevel if there is none
  std::vector<std::uint32_t> terminal;  ///< [n] that terminal: index into SpillTree::rim, or kOutlet (also if none)
};

/// Reduces one part of a terrain to its rim.
///
/// @param height     [n], each below kNoLevel.
/// @param global_id  [n] distinct ids by which parts recognise each other's vertices.
/// @param is_rim     [n] nonzero where another part may have the vertex as well. Too many flags cost memory only.
/// @param is_outlet  [n] nonzero where water may leave; the same in all parts of a vertex.
/// @param catchments if not null, receives the catchments behind the tree, for `lift_catchments`.
/// Complexity: a flood (see `lift`) plus O(E); 8 bytes per vertex and at most 16 per edge between catchments of
/// different terminals. Fails: never on data; std::bad_alloc. Preconditions are asserted.
[[nodiscard]] SpillTree reduce_to_rim(const VertexGraph& graph, std::span<const std::int32_t> height,
                                      std::span<const std::uint64_t> global_id, std::span<const std::uint8_t> is_rim,
                                      std::span<const std::uint8_t> is_outlet, Catchments* catchments = nullptr);

/// Final levels of all rim vertices.
struct RimLevels {
  std::vector<std::uint64_t> vertex;  ///< global ids, ascending, distinct
  std::vector<std::int32_t> level;    ///< kNoLevel where no outlet can be reached

  /// Levels of some of the vertices, in their order; one search each, fast for ascending ids.
  [[nodiscard]] std::vector<std::int32_t> of(std::span<const std::uint64_t> ids) const;
};

/// The global pass: levels of the rim vertices of all parts.
///
/// @param parts  all of them; `SpillTree`s read from files must have been checked (`is_valid`).
/// Complexity: O(V + E) radix sorts and unions over V rim entries and E edges of all trees; about 20 bytes per entry
/// and 24 per edge beside the input. Fails: never on valid trees; std::bad_alloc.
[[nodiscard]] RimLevels drain(std::span<const SpillTree> parts);

/// Final levels of one part from its catchments and the final levels of its rim: max(level, rim level of the terminal).
///
/// @param rim_level  [R] in the order of SpillTree::rim.
/// @return           [n] levels, as from `lift` on the whole terrain.
/// Complexity: O(n).
[[nodiscard]] std::vector<std::int32_t> lift_catchments(const Catchments& catchments,
                                                        std::span<const std::int32_t> rim_level);

/// Whether a tree keeps its own promises: ids ascending, ends within range, at most one edge per rim vertex.
[[nodiscard]] bool is_valid(const SpillTree& tree);

}  // namespace hydrotin
