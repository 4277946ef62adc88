#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/vertex_graph.h"

/// The augmented contour tree of a terrain: how its contours appear, join, split and vanish as the height rises.
///
/// Its nodes are all vertices. Two vertices are joined by an arc if one contour (a connected piece of a level set)
/// leaves the lower and sweeps without meeting another vertex until it reaches the upper. Vertices of equal height are
/// told apart by the total order (z, x, y), as if the terrain were tilted by an infinitesimal amount, so plateaus need
/// no special care and the tree is unique.
///
/// Source   thesis, Section 6.1 ("the variation of the contour tree used by van Kreveld et al."); made by merging the
///          join tree (pieces of the parts below a level) and the split tree (above it): Carr, Snoeyink and Axen,
///          "Computing contour trees in all dimensions", 2003.
/// Symbols  n = vertices, E = edges, T = triangles.
/// Properties
///   (1) Between two vertices next to each other in the total order, the arcs that pass are the contours there.
///   (2) An arc leaves a vertex downwards for each piece of its lower link, upwards for each of its upper link that are
///       different contours: minima have none below, maxima none above, saddles two or more on one side.
///   (3) A piece of terrain with n vertices gives a tree of n - 1 arcs.
///   (4) The set of arcs does not depend on the numbering of vertices.
/// Units    heights are integers on the z lattice.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

inline constexpr std::uint32_t kNoVertex = 0xffffffffu;

/// The vertices ascending by (z, x, y).
///
/// @param height, position  [n]; positions are distinct.
/// Complexity: O(n), plus O(t log t) for each height with t vertices.
[[nodiscard]] std::vector<std::uint32_t> ascending_vertices(std::span<const std::int32_t> height,
                                                            std::span<const LatticePoint> position);

/// The join tree: how the pieces of the terrain below a rising level join.
///
/// @param ascending  [n] all vertices, lowest first.
/// @return           [n] for each vertex v the first vertex above it whose piece of the terrain at or below it contains
///                   v; kNoVertex for the highest of each piece of the terrain.
/// Complexity: O(E log n) at worst by union-find with path halving, linear in practice.
[[nodiscard]] std::vector<std::uint32_t> join_tree(const VertexGraph& graph, std::span<const std::uint32_t> ascending);

/// The split tree: the same from above; `join_tree` of the terrain upside down.
[[nodiscard]] std::vector<std::uint32_t> split_tree(const VertexGraph& graph, std::span<const std::uint32_t> ascending);

/// Arc i of the contour tree joins vertex i and `other[i]`; kNoVertex for one vertex of each piece of the terrain.
struct ContourTree {
  std::vector<std::uint32_t> other;      ///< [n]
  std::vector<std::uint32_t> ascending;  ///< [n] all vertices, lowest first
};

/// The contour tree of a whole terrain.
///
/// @param height, position  [n]; positions are distinct.
/// @return  nothing if no contour tree exists: where a piece of the terrain surrounds a hole, contours may part and
///          meet again. (Fill holes with triangles first. Some terrains with holes have a tree, and then get it.)
/// Complexity: O(n log n + E log n) time; at its peak 37 bytes per vertex beside the input.
/// Fails: never on data; std::bad_alloc. Preconditions are asserted.
[[nodiscard]] std::optional<ContourTree> contour_tree(const VertexGraph& graph, std::span<const std::int32_t> height,
                                                      std::span<const LatticePoint> position);

/// Numbers of arcs at each vertex.
struct ContourDegrees {
  std::vector<std::uint32_t> below;  ///< [n] 0: minimum; 2 or more: a join of contours
  std::vector<std::uint32_t> above;  ///< [n] 0: maximum; 2 or more: a split
};

[[nodiscard]] ContourDegrees contour_degrees(const ContourTree& tree);

}  // namespace hydrotin
