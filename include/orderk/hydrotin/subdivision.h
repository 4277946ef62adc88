#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/useful_edges.h"

/// The fixed-edge subdivision.
///
/// An edge is *fixed* if every order-k Delaunay triangulation contains it: a Delaunay edge that no useful edge crosses.
/// Fixed edges cut the hull into polygons that can be triangulated independently. A polygon may have *components*
/// inside: isolated vertices or trees and cycles of fixed edges that hang nowhere on its boundary.
///
/// Source   thesis, Section 3.4; components by Euler's formula: inner non-fixed edges - triangles + 1.
/// Symbols  T = Delaunay triangles, F = polygons.
/// Properties
///   (1) k = 0: every edge is fixed, every polygon is a triangle.
///   (2) Fixed for k + 1 implies fixed for k.
///   (3) Both half-edges of an edge agree; hull edges are fixed.
/// Threads  Pure functions.

namespace hydrotin {

/// What useful edges cross.
struct Crossings {
  std::vector<std::uint8_t> crossed;  ///< [3T] 1: a useful edge crosses the half-edge; 0: fixed
  std::vector<HalfedgeId> exit;       ///< [E] the half-edge opposite b that the edge crosses last
};

/// Walks along each edge from its entry. O(T + crossings).
[[nodiscard]] Crossings find_crossings(const TriangulationView& triangulation, const UsefulEdges& edges,
                                       const Executor& executor = serially);

/// Polygons as lists of Delaunay triangles (CSR), numbered by their smallest triangle, triangles ascending.
struct Subdivision {
  std::vector<std::uint32_t> polygon;     ///< [T] polygon of a triangle
  std::vector<std::uint32_t> begin;       ///< [F + 1]
  std::vector<TriangleId> triangle;       ///< [T]
  std::vector<std::uint32_t> components;  ///< [F]

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(components.size()); }
  [[nodiscard]] std::span<const TriangleId> triangles_of(std::uint32_t f) const {
    return std::span(triangle).subspan(begin[f], begin[f + 1] - begin[f]);
  }
};

/// Joins triangles across crossed half-edges. O(T alpha(T)).
[[nodiscard]] Subdivision subdivide(const TriangulationView& triangulation, std::span<const std::uint8_t> crossed,
                                    const Executor& executor = serially);

}  // namespace hydrotin
