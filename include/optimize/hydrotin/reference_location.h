#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/triangulation.h"
#include "hydrotin/vertical_error.h"

/// Which Delaunay triangle owns which reference point.
///
/// Source   visibility walk (Devillers, Pion and Teillaud 2002), from each point to the next along the Hilbert curve.
/// Symbols  T = triangles, R = reference points.
/// Threads  Pure function.

namespace hydrotin {

struct ReferenceLocation {
  std::vector<ReferencePoint> point;  ///< owned ones, by triangle
  std::vector<std::uint32_t> begin;   ///< [T + 1] those of triangle t are point[begin[t] .. begin[t + 1])
  std::uint64_t outside = 0;          ///< outside the hull: they decide nothing
  std::uint64_t at_vertices = 0;      ///< at a vertex: their distance is what it is
  std::uint64_t beyond_limit = 0;     ///< of those at vertices: farther from it than the limit
  TriangleError vertex_error;         ///< of those at vertices

  [[nodiscard]] std::span<const ReferencePoint> of(std::uint32_t triangle) const {
    return std::span(point).subspan(begin[triangle], begin[triangle + 1] - begin[triangle]);
  }
};

/// @param height     [n] of the vertices, z lattice
/// @param position   [R] @param reference_height [R]
/// @param limit      may be null
/// Complexity: expected O(R log R + sqrt(T)).
[[nodiscard]] ReferenceLocation locate_reference(const TriangulationView& triangulation,
                                                 std::span<const std::int32_t> height,
                                                 std::span<const LatticePoint> position,
                                                 std::span<const std::int32_t> reference_height,
                                                 const ErrorLimit* limit = nullptr);

}  // namespace hydrotin
