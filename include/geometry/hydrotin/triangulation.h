#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hydrotin/id.h"
#include "hydrotin/lattice.h"

/// Delaunay triangulation as a flat half-edge structure.
///
/// Triangle t owns the half-edges 3t, 3t+1, 3t+2 in counter-clockwise order; half-edge h runs from origin(h) to
/// origin(next(h)) and has its triangle on the left. Triangles are numbered by their vertex with the smallest id, so
/// that vertices in curve order give triangles in curve order.
///
/// Symbols  n = vertices, T = triangles.
/// Properties
///   (1) twin(twin(h)) = h; a half-edge without twin lies on the hull.
///   (2) The set of triangles depends on the set of points only, not on their order (tie rule of predicates.h).
///   (3) Points on a hull edge are vertices: consecutive collinear hull points are joined.
/// Threads  Views are safe to read concurrently.

namespace hydrotin {

[[nodiscard]] constexpr HalfedgeId next(HalfedgeId h) {
  return {h.value % 3 == 2 ? h.value - 2 : h.value + 1};
}
[[nodiscard]] constexpr HalfedgeId previous(HalfedgeId h) {
  return {h.value % 3 == 0 ? h.value + 2 : h.value - 1};
}
[[nodiscard]] constexpr TriangleId triangle_of(HalfedgeId h) {
  return {h.value / 3};
}
[[nodiscard]] constexpr HalfedgeId first_halfedge(TriangleId t) {
  return {t.value * 3};
}

/// Non-owning view of a triangulation.
struct TriangulationView {
  IdSpan<VertexId, const LatticePoint> position;  ///< [n] lattice units
  IdSpan<HalfedgeId, const VertexId> origin;      ///< [3T]
  IdSpan<HalfedgeId, const HalfedgeId> twin;      ///< [3T] none on the hull

  [[nodiscard]] std::uint32_t num_vertices() const { return static_cast<std::uint32_t>(position.size()); }
  [[nodiscard]] std::uint32_t num_triangles() const { return static_cast<std::uint32_t>(origin.size() / 3); }
  [[nodiscard]] VertexId target(HalfedgeId h) const { return origin[next(h)]; }
  [[nodiscard]] VertexId apex(HalfedgeId h) const { return origin[previous(h)]; }
};

/// Owner of the arrays of a triangulation.
struct Triangulation {
  std::vector<LatticePoint> position;
  std::vector<VertexId> origin;
  std::vector<HalfedgeId> twin;

  [[nodiscard]] TriangulationView view() const { return {position, origin, twin}; }
};

/// Neighbours of every vertex in counter-clockwise order (CSR).
/// The link of v is neighbor[begin[v] .. begin[v + 1]). Consecutive neighbours form a triangle with v; of a vertex
/// inside the hull the last and the first do so too, of a hull vertex (`on_hull`) they do not.
struct VertexLinks {
  std::vector<std::uint32_t> begin;   ///< [n + 1]
  std::vector<VertexId> neighbor;     ///< [2E]
  std::vector<HalfedgeId> spoke;      ///< [2E] the half-edge v -> neighbour; none where it lies outside the hull
  std::vector<std::uint8_t> on_hull;  ///< [n]

  [[nodiscard]] std::span<const VertexId> of(VertexId v) const {
    return std::span(neighbor).subspan(begin[v.value], begin[v.value + 1] - begin[v.value]);
  }
};

/// Incremental Delaunay triangulation. Points should come in an order in which neighbours are close (a space-filling
/// curve): each insertion starts at the one before, nothing is sorted.
class DelaunayBuilder {
 public:
  DelaunayBuilder();
  ~DelaunayBuilder();
  DelaunayBuilder(DelaunayBuilder&&) noexcept;
  DelaunayBuilder& operator=(DelaunayBuilder&&) noexcept;

  /// Adds points; they get the next free vertex ids. Precondition: all points of the triangulation are distinct.
  /// Complexity: expected O(1) a point in curve order. Memory: about 140 bytes a point.
  void insert(std::span<const LatticePoint> points);

  /// The triangulation of the points so far; without triangles if they are all collinear. O(n).
  [[nodiscard]] Triangulation extract();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Delaunay triangulation of points in curve order.
[[nodiscard]] Triangulation delaunay(std::span<const LatticePoint> points);

/// O(n + T).
[[nodiscard]] VertexLinks vertex_links(const TriangulationView& triangulation);

}  // namespace hydrotin
