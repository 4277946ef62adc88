#include "hydrotin/order_k_triangles.h"

#include <algorithm>
#include <cassert>
#include <optional>

#include "hydrotin/predicates.h"

namespace hydrotin {

UsefulEdgeIndex::UsefulEdgeIndex(const TriangulationView& triangulation, const VertexLinks& links,
                                 const UsefulEdges& edges)
    : tri_(triangulation),
      links_(links),
      edges_(edges),
      begin_(triangulation.num_vertices()),
      count_(triangulation.num_vertices()) {
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const std::uint32_t v = edges.a[e].value;
    if (count_[v] == 0) begin_[v] = e;
    assert(begin_[v] + count_[v] == e && "the edges of a vertex stand together");
    ++count_[v];
  }
}

std::uint32_t UsefulEdgeIndex::find(VertexId p, VertexId q) const {
  if (tri_.position[q] < tri_.position[p]) std::swap(p, q);
  const std::uint32_t begin = begin_[p.value], end = begin + count_[p.value];
  for (std::uint32_t e = begin; e < end; ++e)
    if (edges_.b[e] == q) return e;
  return kNone;
}

std::uint32_t UsefulEdgeIndex::find_below(std::uint32_t limit, VertexId p, VertexId q) const {
  if (tri_.position[q] < tri_.position[p]) std::swap(p, q);
  const std::uint32_t begin = begin_[p.value], end = std::min(begin + count_[p.value], limit);
  for (std::uint32_t e = begin; e < end; ++e)
    if (edges_.b[e] == q) return e;
  return kNone;
}

bool UsefulEdgeIndex::is_delaunay(VertexId p, VertexId q) const {
  const auto link = links_.of(p);
  return std::find(link.begin(), link.end(), q) != link.end();
}

namespace {

// Enumerates the triangles on both sides of each edge.
class TriangleFinder {
 public:
  TriangleFinder(const TriangulationView& tri, const VertexLinks& links, const UsefulEdges& edges, int k)
      : tri_(tri), edges_(edges), index_(tri, links, edges), k_(static_cast<std::size_t>(k)) {}

  // Visits the edges that are `wanted`.
  template <class Wanted>
  OrderKTriangles run(Wanted wanted) {
    std::size_t num_wanted = 0;
    for (std::uint32_t e = 0; e < edges_.size(); ++e) num_wanted += wanted(e);
    // Two triangles an edge, on its first points, and a few more.
    const std::size_t usual = 2 * num_wanted + num_wanted / 4;
    found_.vertices.reserve(usual);
    found_.order.reserve(usual);
    found_.entry.reserve(usual);
    for (std::uint32_t e = 0; e < edges_.size(); ++e)
      if (wanted(e)) {
        visit(e, true);
        visit(e, false);
      }
    return std::move(found_);
  }

 private:
  [[nodiscard]] LatticePoint at(VertexId v) const { return tri_.position[v]; }

  // The order of the triangle of edge e and the point of rank `rank` on one side, if it is at most k.
  [[nodiscard]] std::optional<std::size_t> order_of(std::uint32_t e, bool right, std::size_t rank) const {
    const auto own = right ? edges_.right(e) : edges_.left(e);
    const auto opposite = right ? edges_.left(e) : edges_.right(e);
    const VertexId w = own[rank];
    // Counter-clockwise: a, b, w on the left; b, a, w on the right.
    const LatticePoint a = at(right ? edges_.b[e] : edges_.a[e]), b = at(right ? edges_.a[e] : edges_.b[e]);
    std::size_t order = rank;
    for (const VertexId p : opposite) {  // sorted: the farther from its side's first point, the earlier outside
      if (!in_circle(a, b, at(w), at(p))) break;
      if (++order > k_) return std::nullopt;
    }
    return order;
  }

  // Whether one of the points inside the circle on w's side lies in the triangle.
  [[nodiscard]] bool is_empty(std::uint32_t e, bool right, std::size_t rank) const {
    const auto own = right ? edges_.right(e) : edges_.left(e);
    const LatticePoint a = at(right ? edges_.b[e] : edges_.a[e]), b = at(right ? edges_.a[e] : edges_.b[e]);
    const LatticePoint w = at(own[rank]);
    for (std::size_t i = 0; i < rank; ++i) {
      const LatticePoint p = at(own[i]);
      if (orientation(b, w, p) >= 0 && orientation(w, a, p) >= 0) return false;
    }
    return true;
  }

  // Whether q is stored with an edge, if there is one.
  [[nodiscard]] bool is_met_from(std::uint32_t leg, VertexId q) const {
    if (leg == UsefulEdgeIndex::kNone) return false;
    const std::uint32_t begin = edges_.content_begin[leg], end = edges_.content_begin[leg + 1];
    for (std::uint32_t i = begin; i < end; ++i)
      if (edges_.content[i] == q) return true;
    return false;
  }

  // Whether an edge of lower number than e has met the triangle of e and w.
  [[nodiscard]] bool met_before(std::uint32_t e, VertexId w) const {
    const VertexId a = edges_.a[e], b = edges_.b[e];
    return is_met_from(index_.find_below(e, a, w), b) || is_met_from(index_.find_below(e, w, b), a);
  }

  [[nodiscard]] bool is_useful(VertexId p, VertexId q) const {
    return index_.find(p, q) != UsefulEdgeIndex::kNone || index_.is_delaunay(p, q);
  }

  void found(std::uint32_t e, bool right, VertexId w, std::size_t order) {
    const VertexId a = edges_.a[e], b = edges_.b[e];
    found_.vertices.push_back(right ? std::array{b, a, w} : std::array{a, b, w});
    found_.order.push_back(static_cast<std::uint8_t>(order));
    found_.entry.push_back(edges_.entry[e]);
  }

  void visit(std::uint32_t e, bool right) {
    const auto own = right ? edges_.right(e) : edges_.left(e);
    const auto opposite = right ? edges_.left(e) : edges_.right(e);
    // The legs to the first point of a side are useful, and its circle holds the points of the other side alone.
    if (!met_before(e, own[0])) found(e, right, own[0], opposite.size());
    const VertexId a = edges_.a[e], b = edges_.b[e];
    for (std::size_t rank = 1; rank < own.size(); ++rank) {
      const VertexId w = own[rank];
      if (!is_empty(e, right, rank) || !is_useful(a, w) || !is_useful(b, w) || met_before(e, w)) continue;
      if (const auto order = order_of(e, right, rank)) found(e, right, w, *order);
    }
  }

  const TriangulationView& tri_;
  const UsefulEdges& edges_;
  UsefulEdgeIndex index_;
  std::size_t k_;
  OrderKTriangles found_;
};

}  // namespace

OrderKTriangles order_k_triangles(const TriangulationView& triangulation, const VertexLinks& links,
                                  const UsefulEdges& edges, int k) {
  return TriangleFinder(triangulation, links, edges, k).run([](std::uint32_t) { return true; });
}

OrderKTriangles order_k_triangles(const TriangulationView& triangulation, const VertexLinks& links,
                                  const UsefulEdges& edges, int k, const Subdivision& subdivision,
                                  std::span<const std::uint8_t> wanted) {
  return TriangleFinder(triangulation, links, edges, k).run([&](std::uint32_t e) {
    return wanted[subdivision.polygon[triangle_of(edges.entry[e]).value]] != 0;
  });
}

}  // namespace hydrotin
