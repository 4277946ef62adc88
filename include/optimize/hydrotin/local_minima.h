#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/subdivision.h"

/// Which polygon is to save which vertex from being a local minimum.
///
/// A vertex is a minimum if none of its neighbours is lower, heights compared by (z, x, y). A vertex without a lower
/// neighbour over any useful edge is a minimum in every order-k triangulation: their number is a lower bound. One with
/// a lower neighbour over a fixed edge never is one. Every other vertex is assigned to the polygon that holds the
/// useful edge to its lowest useful neighbour, so that polygons can be solved independently and in any order.
///
/// Source   thesis, Section 3.2.2 for one polygon; NP-hard for point sets (de Kok et al. 2007), hence the assignment.
/// Properties
///   (1) The assignment of a vertex depends on its useful edges and heights only: it is the same in every tile.
/// Threads  Pure functions.

namespace hydrotin {

enum class MinimumFate : std::uint8_t {
  never,    ///< a fixed edge leads down
  always,   ///< no useful edge leads down
  assigned  ///< up to the polygon of `where`
};

struct MinimaAssignment {
  std::vector<MinimumFate> fate;  ///< [n]
  std::vector<TriangleId> where;  ///< [n] a Delaunay triangle at the vertex, in the polygon that is to save it; or none
};

/// @param height   [n] z lattice
/// Complexity: O(n + T + E).
[[nodiscard]] MinimaAssignment assign_minima(const TriangulationView& triangulation, const VertexLinks& links,
                                             const UsefulEdges& edges, const Crossings& crossings,
                                             std::span<const std::int32_t> height, const Executor& executor = serially);

}  // namespace hydrotin
