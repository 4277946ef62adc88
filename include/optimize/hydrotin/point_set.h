#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/objective.h"

/// The best order-k triangulation of a whole point set in memory.
///
/// Source   thesis, Section 3.4: fixed edges cut the problem into polygons, each solved by Theorem 3.1, 3.3 or 3.5.
/// Properties
///   (1) Every triangle has order at most k.
///   (2) delaunay and min-weight are optimal if no polygon fell back; local-minima is optimal if value = bound.
///   (3) The set of triangles depends on the points only, not on their order.
/// Threads  Pure function.

namespace hydrotin {

struct PointSetTriangulation {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into the input, counter-clockwise
  double value = 0;  ///< of the objective: total edge length [lattice units], number of minima; 0 for delaunay
  double bound = 0;  ///< no order-k triangulation has less
  bool optimal = false;
  std::uint32_t max_order = 0;  ///< of the triangles
  std::uint32_t polygons = 0, max_polygon = 0, components = 0, max_components = 0, fallbacks = 0;
};

/// @param position  [n] distinct points, best along a space-filling curve
/// @param height    [n] z lattice
/// @param k         0..kMaxOrder
/// Complexity: expected O(n k^2) beside the Delaunay triangulation. Without triangles if all points are collinear.
[[nodiscard]] PointSetTriangulation triangulate(std::span<const LatticePoint> position,
                                                std::span<const std::int32_t> height, int k, Objective objective);

/// Vertices without a lower neighbour, by (z, x, y). O(n + T).
[[nodiscard]] std::uint32_t count_minima(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                                         std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace hydrotin
