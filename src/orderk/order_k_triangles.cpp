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

OrderKTriangleFinder::OrderKTriangleFinder(const TriangulationView& triangulation, const VertexLinks& links,
                                           const UsefulEdges& edges, int k)
    : tri_(triangulation), edges_(edges), index_(tri_, links, edges), k_(static_cast<std::size_t>(k)) {}

// The order of the triangle of edge e and the point of rank `rank` on one side, if it is at most k.
std::optional<std::size_t> OrderKTriangleFinder::order_of(std::uint32_t e, bool right, std::size_t rank) const {
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
bool OrderKTriangleFinder::is_empty(std::uint32_t e, bool right, std::size_t rank) const {
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
bool OrderKTriangleFinder::is_met_from(std::uint32_t leg, VertexId q) const {
  if (leg == UsefulEdgeIndex::kNone) return false;
  const std::uint32_t begin = edges_.content_begin[leg], end = edges_.content_begin[leg + 1];
  for (std::uint32_t i = begin; i < end; ++i)
    if (edges_.content[i] == q) return true;
  return false;
}

// Whether an edge of lower number than e has met the triangle of e and w.
bool OrderKTriangleFinder::met_before(std::uint32_t e, VertexId w) const {
  const VertexId a = edges_.a[e], b = edges_.b[e];
  return is_met_from(index_.find_below(e, a, w), b) || is_met_from(index_.find_below(e, w, b), a);
}

bool OrderKTriangleFinder::is_useful(VertexId p, VertexId q) const {
  return index_.find(p, q) != UsefulEdgeIndex::kNone || index_.is_delaunay(p, q);
}

void OrderKTriangleFinder::add(std::uint32_t e, bool right, VertexId w, std::size_t order, OrderKTriangles& out) const {
  const VertexId a = edges_.a[e], b = edges_.b[e];
  out.vertices.push_back(right ? std::array{b, a, w} : std::array{a, b, w});
  out.order.push_back(static_cast<std::uint8_t>(order));
  out.entry.push_back(edges_.entry[e]);
}

void OrderKTriangleFinder::visit(std::uint32_t e, bool right, OrderKTriangles& out) const {
  const auto own = right ? edges_.right(e) : edges_.left(e);
  const auto opposite = right ? edges_.left(e) : edges_.right(e);
  // The legs to the first point of a side are useful, and its circle holds the points of the other side alone.
  if (!met_before(e, own[0])) add(e, right, own[0], opposite.size(), out);
  const VertexId a = edges_.a[e], b = edges_.b[e];
  for (std::size_t rank = 1; rank < own.size(); ++rank) {
    const VertexId w = own[rank];
    if (!is_empty(e, right, rank) || !is_useful(a, w) || !is_useful(b, w) || met_before(e, w)) continue;
    if (const auto order = order_of(e, right, rank)) add(e, right, w, *order, out);
  }
}

template <class Wanted>
OrderKTriangles OrderKTriangleFinder::find_wanted(std::uint32_t begin, std::uint32_t end, Wanted wanted) const {
  std::size_t num_wanted = 0;
  for (std::uint32_t e = begin; e < end; ++e) num_wanted += wanted(e);
  // Two triangles an edge, on its first points, and a few more.
  const std::size_t usual = 2 * num_wanted + num_wanted / 4;
  OrderKTriangles out;
  out.vertices.reserve(usual);
  out.order.reserve(usual);
  out.entry.reserve(usual);
  for (std::uint32_t e = begin; e < end; ++e) {
    if (!wanted(e)) continue;
    visit(e, true, out);
    visit(e, false, out);
  }
  return out;
}

OrderKTriangles OrderKTriangleFinder::find(std::uint32_t begin, std::uint32_t end) const {
  return find_wanted(begin, end, [](std::uint32_t) { return true; });
}

OrderKTriangles OrderKTriangleFinder::find(std::uint32_t begin, std::uint32_t end, const Subdivision& subdivision,
                                           std::span<const std::uint8_t> wanted) const {
  return find_wanted(begin, end, [&](std::uint32_t e) {
    return wanted[subdivision.polygon[triangle_of(edges_.entry[e]).value]] != 0;
  });
}

void OrderKTriangleFinder::find(std::span<const std::uint32_t> edges_of_polygon, OrderKTriangles& out) const {
  for (const std::uint32_t e : edges_of_polygon) {
    visit(e, true, out);
    visit(e, false, out);
  }
}

OrderKTriangles concatenate(std::vector<OrderKTriangles> parts) {
  OrderKTriangles out;
  std::size_t size = 0;
  for (const OrderKTriangles& part : parts) size += part.size();
  out.vertices.reserve(size);
  out.order.reserve(size);
  out.entry.reserve(size);
  for (OrderKTriangles& part : parts) {
    out.vertices.insert(out.vertices.end(), part.vertices.begin(), part.vertices.end());
    out.order.insert(out.order.end(), part.order.begin(), part.order.end());
    out.entry.insert(out.entry.end(), part.entry.begin(), part.entry.end());
    part = {};
  }
  return out;
}

OrderKTriangles order_k_triangles(const TriangulationView& triangulation, const VertexLinks& links,
                                  const UsefulEdges& edges, int k) {
  return OrderKTriangleFinder(triangulation, links, edges, k).find(0, edges.size());
}

}  // namespace hydrotin
