#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "polygon_graph.h"

/// Ways to tie the components inside a polygon to its boundary (T, Lemma 3.1, with rightmost in place of topmost).
///
/// The rightmost vertex u of a component has a Delaunay edge uv to a vertex on its right; any order-k triangulation
/// contains uv or, of the triangle at u through which uv would leave, the side to its rightmost vertex. In a simple
/// polygon, where uv may not be possible, u is tied by each of its edges to the right: one of them is in every
/// triangulation.

namespace hydrotin {

struct Tie {
  std::uint32_t edge, twin;  ///< the directed edges of the tie
};

/// Candidate ties per component (CSR), components by the (x, y) of u, the Delaunay tie of each first, then by (x, y).
struct ComponentTies {
  std::vector<std::uint32_t> begin{0};
  std::vector<Tie> tie;
  std::vector<std::uint32_t> blocked_begin{0};  ///< [ties + 1]
  std::vector<std::uint32_t> blocked;           ///< triangles that a tie would cut, by tie

  [[nodiscard]] std::uint32_t num_components() const { return static_cast<std::uint32_t>(begin.size() - 1); }
  /// Ways to choose one tie per component, or `most` + 1 if there are more than `most`.
  [[nodiscard]] std::uint64_t num_ways(std::uint64_t most) const;
};

/// Of each component (CSR): the directed edges whose left side can be triangulated otherwise with another of its ties.
struct TieInfluence {
  std::vector<std::uint32_t> begin{0};
  std::vector<std::uint32_t> edge;

  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t component) const {
    return std::span(edge).subspan(begin[component], begin[component + 1] - begin[component]);
  }
};

/// O(T + C) for each component.
[[nodiscard]] TieInfluence influence_of(const ComponentTies& ties, const PolygonGraph& graph);

/// O((T + C) log) and O(T + C) for each tie. Empty if everything hangs on the boundary.
[[nodiscard]] ComponentTies find_component_ties(const PolygonProblem& problem, const PolygonGraph& graph);

}  // namespace hydrotin
