#pragma once

#include <cstdint>
#include <vector>

#include "polygon_graph.h"

/// Ways to tie the components inside a polygon to its boundary (T, Lemma 3.1).
///
/// Topmost there is last here, in a sweep across the polygon. The last vertex u of a component has a Delaunay edge uv
/// to a later one; any order-k triangulation contains uv or, of the triangle at u through which uv would leave, a side
/// from u to a later vertex. In a simple polygon, where uv may not be possible, u is tied by each of its edges to later
/// vertices: one of them is in every triangulation. Ties to the outer boundary are preferred.

namespace hydrotin {

struct Tie {
  std::uint32_t edge, twin;  ///< the directed edges of the tie
};

/// Candidate ties per component (CSR), components in the order of u, the Delaunay tie of each first, then by (x, y).
struct ComponentTies {
  std::vector<std::uint32_t> begin{0};
  std::vector<Tie> tie;
  std::vector<std::uint32_t> blocked_begin{0};  ///< [ties + 1]
  std::vector<std::uint32_t> blocked;           ///< triangles that a tie would cut, by tie
  std::vector<std::uint32_t> component;         ///< [n] of the vertices; kNoEdge: on the outer boundary

  [[nodiscard]] std::uint32_t num_components() const { return static_cast<std::uint32_t>(begin.size() - 1); }
  [[nodiscard]] std::uint32_t num_ties(std::uint32_t component_number) const {
    return begin[component_number + 1] - begin[component_number];
  }
  /// Ways to choose one tie per component, or `most` + 1 if there are more than `most`.
  [[nodiscard]] std::uint64_t num_ways(std::uint64_t most) const;
};

/// O(T + C log C) and, for each tie, O(triangles near components that lie at its place along the polygon). Empty if
/// everything hangs on the boundary.
[[nodiscard]] ComponentTies find_component_ties(const PolygonProblem& problem, const PolygonGraph& graph);

}  // namespace hydrotin
