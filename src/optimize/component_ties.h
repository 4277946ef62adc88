#pragma once

#include <cstdint>
#include <vector>

#include "polygon_graph.h"

/// Ways to tie the components inside a polygon to its boundary (T, Lemma 3.1, with rightmost in place of topmost).
///
/// The rightmost vertex u of a component has a Delaunay edge uv to a vertex on its right; any order-k triangulation
/// contains uv or, of the triangle at u through which uv would leave, the side to its rightmost vertex.

namespace hydrotin {

struct Tie {
  std::uint32_t edge, twin;  ///< the directed edges of the tie
};

/// Candidate ties per component (CSR), components by the (x, y) of u, the Delaunay tie of each first, then by (x, y).
struct ComponentTies {
  std::vector<std::uint32_t> begin{0};
  std::vector<Tie> tie;

  [[nodiscard]] std::uint32_t num_components() const { return static_cast<std::uint32_t>(begin.size() - 1); }
};

/// O((T + C) log). Empty if everything hangs on the boundary.
[[nodiscard]] ComponentTies find_component_ties(const PolygonProblem& problem, const PolygonGraph& graph);

}  // namespace hydrotin
