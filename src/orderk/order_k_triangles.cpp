#include "hydrotin/order_k_triangles.h"

#include <algorithm>

namespace hydrotin {
namespace {

constexpr std::uint32_t kEdgeRange = 1U << 14;

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

}  // namespace

// Whether the edge pq, if there is one and its number is below a limit, knows r.
bool OrderKTriangleFinder::is_met_below(std::uint32_t limit, VertexId p, VertexId q, VertexId r) const {
  if (tri_.position[q] < tri_.position[p]) std::swap(p, q);
  const std::uint32_t begin = edges_.begin[p.value], end = std::min(limit, edges_.begin[p.value + 1]);
  for (std::uint32_t e = begin; e < end; ++e) {
    if (edges_.b[e] != q) continue;
    if (edges_.left[e] == r || edges_.right[e] == r) return true;
    for (const Apex& apex : edges_.apexes(e))
      if (apex.point == r) return true;
    return false;
  }
  return false;
}

void OrderKTriangleFinder::visit(std::uint32_t e, OrderKTriangles& out) const {
  const VertexId a = edges_.a(tri_, e), b = edges_.b[e];
  const auto add = [&](VertexId w, bool right, std::uint8_t order) {
    if (is_met_below(e, a, w, b) || is_met_below(e, w, b, a)) return;
    out.vertices.push_back(right ? std::array{b, a, w} : std::array{a, b, w});
    out.order.push_back(order);
    out.entry.push_back(edges_.entry[e]);
  };
  // The legs to s1 and s2 are useful, and the circles hold the points of the other side alone.
  add(edges_.right[e], true, edges_.num_left[e]);
  add(edges_.left[e], false, edges_.num_right[e]);
  for (const Apex& apex : edges_.apexes(e)) add(apex.point, apex.is_right, apex.order);
}

OrderKTriangles order_k_triangles(const TriangulationView& triangulation, const UsefulEdges& edges,
                                  const Executor& executor) {
  const OrderKTriangleFinder finder(triangulation, edges);
  std::vector<OrderKTriangles> parts(edges.size() / kEdgeRange + 1);
  for_ranges(executor, edges.size(), kEdgeRange, [&](std::uint32_t begin, std::uint32_t end) {
    OrderKTriangles& part = parts[begin / kEdgeRange];
    for (std::uint32_t e = begin; e < end; ++e) finder.visit(e, part);
  });
  return concatenate(std::move(parts));
}

}  // namespace hydrotin
