#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hydrotin/subdivision.h"
#include "hydrotin/useful_edges.h"

/// Order-k triangles with three useful edges: all that an order-k triangulation can be made of.
///
/// Source   thesis, Lemmas 2.3 to 2.5. The order of triangle (a, b, w) with w among the points that edge ab stores is
/// the
///          rank of w in its list plus the points of the opposite list that the circle through w still holds; by
///          Lemma 2.4 every non-Delaunay triangle is met from at least one of its edges.
/// Symbols  C = triangles found, E = useful edges, T = Delaunay triangles.
/// Properties
///   (1) Every triangle found is empty (no vertex inside or on its boundary), has order 1..k and three useful edges.
///   (2) Together with the Delaunay triangles these are all such triangles.
///   (3) Each triangle appears once.
/// Threads  Pure functions.

namespace hydrotin {

/// Useful edges by smaller end: rows of an edge list in which the edges of one vertex are consecutive.
class UsefulEdgeIndex {
 public:
  /// O(n + E). Precondition: the edges of each vertex `a` stand together.
  UsefulEdgeIndex(const TriangulationView& triangulation, const VertexLinks& links, const UsefulEdges& edges);

  /// The number of the non-Delaunay useful edge between p and q, or none (all bits set).
  [[nodiscard]] std::uint32_t find(VertexId p, VertexId q) const;
  /// The same, of the edges with a number below `limit` only.
  [[nodiscard]] std::uint32_t find_below(std::uint32_t limit, VertexId p, VertexId q) const;
  [[nodiscard]] bool is_delaunay(VertexId p, VertexId q) const;

  static constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);

 private:
  const TriangulationView& tri_;
  const VertexLinks& links_;
  const UsefulEdges& edges_;
  std::vector<std::uint32_t> begin_;  // [n] first edge of a vertex
  std::vector<std::uint16_t> count_;  // [n]
};

struct OrderKTriangles {
  std::vector<std::array<VertexId, 3>> vertices;  ///< [C] counter-clockwise
  std::vector<std::uint8_t> order;                ///< [C] 1..k
  std::vector<HalfedgeId> entry;                  ///< [C] a half-edge crossed by one of its edges

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(vertices.size()); }
  void clear() {
    vertices.clear();
    order.clear();
    entry.clear();
  }
};

/// Finds the non-Delaunay order-k triangles met from ranges of edges, concurrently if asked so.
class OrderKTriangleFinder {
 public:
  /// O(n + E).
  OrderKTriangleFinder(const TriangulationView& triangulation, const VertexLinks& links, const UsefulEdges& edges,
                       int k);

  /// Those met first from the edges [begin, end). O(E k (k + degree)).
  [[nodiscard]] OrderKTriangles find(std::uint32_t begin, std::uint32_t end) const;
  /// Appends those of one polygon of the subdivision, given the numbers of all its edges, ascending.
  void find(std::span<const std::uint32_t> edges_of_polygon, OrderKTriangles& out) const;
  /// Those of a range of edges inside some polygons of the subdivision only: those with a 1 in `wanted` [F].
  [[nodiscard]] OrderKTriangles find(std::uint32_t begin, std::uint32_t end, const Subdivision& subdivision,
                                     std::span<const std::uint8_t> wanted) const;

 private:
  template <class Wanted>
  [[nodiscard]] OrderKTriangles find_wanted(std::uint32_t begin, std::uint32_t end, Wanted wanted) const;
  void visit(std::uint32_t e, bool right, OrderKTriangles& out) const;
  [[nodiscard]] bool is_empty(std::uint32_t e, bool right, std::size_t rank) const;
  [[nodiscard]] std::optional<std::size_t> order_of(std::uint32_t e, bool right, std::size_t rank) const;
  [[nodiscard]] bool met_before(std::uint32_t e, VertexId w) const;
  [[nodiscard]] bool is_met_from(std::uint32_t leg, VertexId q) const;
  [[nodiscard]] bool is_useful(VertexId p, VertexId q) const;
  void add(std::uint32_t e, bool right, VertexId w, std::size_t order, OrderKTriangles& out) const;
  [[nodiscard]] LatticePoint at(VertexId v) const { return tri_.position[v]; }

  TriangulationView tri_;
  const UsefulEdges& edges_;
  UsefulEdgeIndex index_;
  std::size_t k_;
};

/// Puts what was found in consecutive ranges of edges together; `parts` are freed on the way. O(C).
[[nodiscard]] OrderKTriangles concatenate(std::vector<OrderKTriangles> parts);

/// The non-Delaunay order-k triangles met from all edges. O(E k (k + degree)).
[[nodiscard]] OrderKTriangles order_k_triangles(const TriangulationView& triangulation, const VertexLinks& links,
                                                const UsefulEdges& edges, int k);

}  // namespace hydrotin
