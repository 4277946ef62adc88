#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/point_set.h"

/// The best order-k triangulation of a simple polygon, with points and edges inside.
///
/// The order of a triangle is the number of given points in its circumcircle, as everywhere; the polygon's sides do not
/// hide any (T3, introduction). So for small k there may be no triangulation at all. A triangle may be used if it lies
/// inside, holds no point, has order at most k and crosses no side and no edge inside; its edges need not be useful for
/// the point set, because what is outside the polygon need not be triangulated.
///
/// Source   thesis, Theorems 3.1 to 3.5. Vertices of a triangle of order k are at most k + 1 Delaunay edges apart, over
///          points inside its circle: candidates are looked for there.
/// Symbols  m = vertices of the boundary, n = points.
/// Threads  Pure function.

namespace hydrotin {

struct SimplePolygon {
  std::span<const LatticePoint> position;  ///< [n] distinct; the first m are the boundary, in either direction
  std::span<const std::int32_t> height;    ///< [n] z lattice
  std::uint32_t boundary = 0;              ///< m
  std::span<const std::array<std::uint32_t, 2>> edges{};  ///< edges inside that must be there
};

struct SimplePolygonTriangulation {
  PointSetTriangulation best;        ///< without triangles if there is none of this order
  std::uint32_t smallest_order = 0;  ///< then: the smallest order for which there is one
  bool found = false;
};

/// @param options  order: any from 0 on
/// Errors: Error (input) if the boundary crosses or touches itself, points or edges inside lie on or outside of it, or
/// edges cross.
/// Complexity: O(candidates) after O(n * points within k + 1 Delaunay edges squared).
[[nodiscard]] SimplePolygonTriangulation triangulate_polygon(const SimplePolygon& polygon,
                                                             const PointSetOptions& options,
                                                             const ReferenceSet& reference = {});

}  // namespace hydrotin
