#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/polygon.h"

/// The best order-k triangulation of a whole point set in memory.
///
/// Source   thesis, Section 3.4: fixed edges cut the problem into polygons, each solved by Theorems 3.1 to 3.5.
///          What couples polygons is decided like this. local-minima: each vertex is assigned to one polygon
///          (local_minima.h); one that gets no lower neighbour there is offered to the others around it, which take it
///          if none of their own suffers. Quadrilaterals: after a round in which edges between polygons do not count,
///          polygons are solved again in (x, y) order with their surroundings given, as long as something improves.
///          Degrees: edges outside the polygon count as they are in every triangulation.
/// Properties
///   (1) Every triangle has order at most k.
///   (2) A decomposable objective is optimal if no polygon fell back; others if the value meets the bound.
///   (3) The set of triangles depends on the points only, not on their order.
/// Threads  Pure function.

namespace hydrotin {

struct PointSetOptions {
  int order = 2;  ///< 0..kMaxOrder
  PolygonOptions polygon{};
};

/// Points that are not vertices, against which vertical errors are measured.
struct ReferenceSet {
  std::span<const LatticePoint> position{};  ///< [R]
  std::span<const std::int32_t> height{};    ///< [R] z lattice
};

struct PointSetTriangulation {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into the input, counter-clockwise
  std::vector<double> values;   ///< of each objective, as `evaluate` and TriangleError have them; 0 for delaunay
  double bound = 0;             ///< no order-k triangulation is better in the first objective
  bool optimal = false;         ///< for the first objective
  std::uint32_t max_order = 0;  ///< of the triangles
  std::uint32_t polygons = 0, max_polygon = 0, components = 0, max_components = 0, fallbacks = 0;
  std::uint32_t limit_missed = 0;       ///< polygons that cannot keep the limit on errors
  TriangleError error{};                ///< of the reference points inside the hull
  std::uint64_t reference_outside = 0;  ///< reference points outside the hull
  std::uint64_t reference_at_vertices = 0, vertices_beyond_limit = 0;  ///< at vertices; of these beyond the limit

  [[nodiscard]] double value() const { return values.empty() ? 0 : values.front(); }
};

/// @param position  [n] distinct points, best along a space-filling curve
/// @param height    [n] z lattice
/// Complexity: expected O(n k^2) beside the Delaunay triangulation. Without triangles if all points are collinear.
[[nodiscard]] PointSetTriangulation triangulate(std::span<const LatticePoint> position,
                                                std::span<const std::int32_t> height, const PointSetOptions& options,
                                                const ReferenceSet& reference = {});

/// One objective, all else as it is by default.
[[nodiscard]] PointSetTriangulation triangulate(std::span<const LatticePoint> position,
                                                std::span<const std::int32_t> height, int k, Objective objective);

/// Vertices without a lower neighbour, by (z, x, y). O(n + T).
[[nodiscard]] std::uint32_t count_minima(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                                         std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace hydrotin
