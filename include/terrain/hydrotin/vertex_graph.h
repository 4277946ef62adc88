#pragma once

#include <cstdint>
#include <span>
#include <vector>

/// The graph of a terrain: vertices and edges of a set of triangles, without their geometry.
///
/// Source   thesis, Section 6.1: "any terrain has an associated graph, G_T".
/// Symbols  n = vertices, T = triangles, E = edges.
/// Properties
///   (1) v is in the list of w exactly when w is in the list of v and some triangle has both.
///   (2) Each list is ascending and free of repeats; a vertex of no triangle has an empty list.
///   (3) A boundary edge is a directed edge of one triangle whose reverse is an edge of no triangle.
///   (4) The result does not depend on the order of the triangles, nor on which of its vertices a triangle starts with.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

/// A directed edge between two vertices, its triangle on the left.
struct DirectedEdge {
  std::uint32_t origin = 0;
  std::uint32_t target = 0;
  friend constexpr auto operator<=>(const DirectedEdge&, const DirectedEdge&) = default;
};

/// Adjacency as CSR. Neighbours of v: neighbor[begin[v] .. begin[v + 1]).
struct VertexGraph {
  std::vector<std::uint32_t> begin;     ///< [n + 1]
  std::vector<std::uint32_t> neighbor;  ///< [2E]
  std::vector<DirectedEdge> boundary;   ///< directed edges without twin, ascending: the rim of the set of triangles

  [[nodiscard]] std::uint32_t num_vertices() const { return static_cast<std::uint32_t>(begin.size() - 1); }
  [[nodiscard]] std::span<const std::uint32_t> neighbors(std::uint32_t v) const {
    return {neighbor.data() + begin[v], neighbor.data() + begin[v + 1]};
  }
};

/// Builds the graph of the edges of a set of triangles; the triangles may be any part of a triangulation.
///
/// @param num_vertices     n < 2^32 - 1.
/// @param triangle_vertex  [3T] vertex ids below n, three per triangle, all triangles in one sense of rotation (this
///                         matters to `boundary` only); 3T < 2^31.
/// Complexity: O(n + T) time; at its peak 8 bytes per corner and 8 per vertex beside the input.
/// Fails: never on data; std::bad_alloc. Preconditions are asserted.
[[nodiscard]] VertexGraph make_vertex_graph(std::uint32_t num_vertices, std::span<const std::uint32_t> triangle_vertex);

}  // namespace hydrotin
