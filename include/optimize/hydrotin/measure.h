#pragma once

#include "hydrotin/lattice.h"
#include "hydrotin/objective.h"

/// The measures of one triangle, and of two triangles at an edge.
///
/// Every measure is computed from integers that do not depend on which corner comes first, so that equal triangles have
/// equal values to the last bit, in every tile.
///
/// Units    lattice units of x and y for lengths, their squares for areas; degrees for angles; z lattice units for
///          heights.
/// Source   thesis, Sections 3.1 and 3.2.3.
/// Threads  Pure functions.

namespace hydrotin {

[[nodiscard]] double edge_length(LatticePoint a, LatticePoint b);

/// Twice the area. Exact below 2^53.
[[nodiscard]] double twice_area(LatticePoint a, LatticePoint b, LatticePoint c);

/// Radius of the inscribed circle.
[[nodiscard]] double inradius(LatticePoint a, LatticePoint b, LatticePoint c);

/// What a bottleneck objective compares: the smaller, the better the triangle. Precondition: a measure of shape, i.e.
/// kind bottleneck but neither min_max_error nor min_max_order; a, b, c counter-clockwise.
[[nodiscard]] double triangle_score(Objective objective, LatticePoint a, LatticePoint b, LatticePoint c);

/// The measure that a score stands for: a length, an angle or an area.
[[nodiscard]] double measure_of_score(Objective objective, double score);

/// What one unit of an objective's value is in the unit of the coordinates: a length, an area, a height or 1.
[[nodiscard]] double unit_of(Objective objective, const Lattice& lattice);

/// A vertex of the surface.
struct SurfacePoint {
  LatticePoint position;
  std::int32_t height = 0;  ///< z lattice units
};

/// What a quadrilateral objective compares at the edge ab, with c on its left and d on its right; smaller is better.
/// @param z_per_xy  z lattice unit in x and y lattice units
/// min_max_area_ratio: the larger area over the smaller; min_max_normal_angle: degrees; max_convex_edges: -1 for an
/// edge that is higher than the plane through the other three vertices allows on both sides, else 0 (exact).
[[nodiscard]] double quadrilateral_score(Objective objective, const SurfacePoint& a, const SurfacePoint& b,
                                         const SurfacePoint& c, const SurfacePoint& d, double z_per_xy);

}  // namespace hydrotin
