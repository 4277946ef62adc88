#pragma once

#include <cstdint>
#include <span>

#include "hydrotin/point_set.h"

/// Fewer local minima by the hull heuristic, for comparison.
///
/// Local minima of the Delaunay triangulation are visited from the lowest up. For each, useful edges to a lower vertex
/// are tried, those of smaller order first: the hull of the edge (the Delaunay triangles that it crosses) is
/// triangulated anew on both sides of it, if no hull before shares a triangle with it, all new triangles have order at
/// most k and the number of minima falls.
///
/// Source   de Kok, van Kreveld and Loeffler, "Generating realistic terrains with higher-order Delaunay
///          triangulations", 2007; hulls: Gudmundsson, Hammar and van Kreveld 2002. (The flip heuristic of the same
///          paper is ComponentMethod::flips.)
/// Properties
///   (1) Never more minima than the Delaunay triangulation. (2) Every triangle has order at most k.
/// Complexity: expected O(n k^2). Threads: pure.

namespace hydrotin {

/// @param position  [n] distinct points  @param height  [n] z lattice
[[nodiscard]] PointSetTriangulation hull_heuristic(std::span<const LatticePoint> position,
                                                   std::span<const std::int32_t> height, int k);

}  // namespace hydrotin
