#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hydrotin/subdivision.h"
#include "hydrotin/useful_edges.h"

/// Order-k triangles with three useful edges: all that an order-k triangulation can be made of.
///
/// Source   thesis, Lemmas 2.3 to 2.5. By Lemma 2.4 every non-Delaunay triangle is met from at least one of its edges:
///          that edge knows the third corner as s1, s2 or apex.
/// Symbols  C = triangles found, E = useful edges, T = Delaunay triangles.
/// Properties
///   (1) Every triangle found is empty (no vertex inside or on its boundary), has order 1..k and three useful edges.
///   (2) Together with the Delaunay triangles these are all such triangles.
///   (3) Each triangle appears once.
/// Threads  Pure functions.

namespace hydrotin {

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

/// Finds the non-Delaunay order-k triangles met from single edges.
class OrderKTriangleFinder {
 public:
  /// O(1). Both are referred to.
  OrderKTriangleFinder(const TriangulationView& triangulation, const UsefulEdges& edges)
      : tri_(triangulation), edges_(edges) {}

  /// Appends those met from edge e that no edge of a lower number meets. O(edges of its corners).
  void visit(std::uint32_t e, OrderKTriangles& out) const;

 private:
  [[nodiscard]] bool is_met_below(std::uint32_t limit, VertexId p, VertexId q, VertexId r) const;

  TriangulationView tri_;
  const UsefulEdges& edges_;
};

/// The non-Delaunay order-k triangles met from all edges, in the order of the edges. O(E) of these.
[[nodiscard]] OrderKTriangles order_k_triangles(const TriangulationView& triangulation, const UsefulEdges& edges,
                                                const Executor& executor = serially);

}  // namespace hydrotin
