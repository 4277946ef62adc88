#include "order_tables.h"

#include <fmt/format.h>

#include <algorithm>

#include "hydrotin/error.h"
#include "hydrotin/order_k_triangles.h"
#include "hydrotin/subdivision.h"
#include "hydrotin/triangulation.h"
#include "hydrotin/useful_edges.h"

namespace hydrotin::app {
namespace {

std::array<std::uint32_t, 3> rows_of(const SmallPoints& points, VertexId a, VertexId b, VertexId c) {
  std::array<std::uint32_t, 3> rows{points.row[a.value], points.row[b.value], points.row[c.value]};
  std::sort(rows.begin(), rows.end());
  return rows;
}

std::array<std::uint32_t, 2> rows_of(const SmallPoints& points, VertexId a, VertexId b) {
  const auto [low, high] = std::minmax({points.row[a.value], points.row[b.value]});
  return {low, high};
}

void add_delaunay(const SmallPoints& points, const TriangulationView& view, OrderTables& tables) {
  for (std::uint32_t t = 0; t < view.num_triangles(); ++t) {
    const HalfedgeId h = first_halfedge({t});
    tables.delaunay.push_back(rows_of(points, view.origin[h], view.target(h), view.apex(h)));
    tables.triangles.emplace_back(tables.delaunay.back(), 0);
  }
}

/// Each edge once: the half-edge without twin, or the smaller of the two.
template <class Visit>
void each_edge(const TriangulationView& view, Visit&& visit) {
  for (std::uint32_t h = 0; h < view.origin.size(); ++h)
    if (const HalfedgeId twin = view.twin[{h}]; twin.is_none() || h < twin.value) visit(HalfedgeId{h});
}

}  // namespace

void require_order(int order) {
  if (order < 0 || order > kMaxOrder)
    throw Error(ErrorKind::config, fmt::format("--order: {} is not possible (allowed: 0 to {})", order, kMaxOrder));
}

OrderTables order_tables(const SmallPoints& points, int k) {
  OrderTables tables;
  const Triangulation triangulation = delaunay(points.position);
  const TriangulationView view = triangulation.view();
  if (view.num_triangles() == 0) return tables;
  const VertexLinks links = vertex_links(view);
  const UsefulEdges edges = useful_edges(view, links, k);
  const Crossings crossings = find_crossings(view, edges);
  add_delaunay(points, view, tables);
  each_edge(view, [&](HalfedgeId h) {
    const auto rows = rows_of(points, view.origin[h], view.target(h));
    tables.useful.push_back({rows[0], rows[1], 0});
    if (crossings.crossed[h.value] == 0) tables.fixed.push_back(rows);
  });
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const auto rows = rows_of(points, edges.a(view, e), edges.b[e]);
    tables.useful.push_back({rows[0], rows[1], edges.useful_order(e)});
  }
  const OrderKTriangles others = order_k_triangles(view, edges);
  for (std::uint32_t t = 0; t < others.size(); ++t) {
    const auto& [a, b, c] = others.vertices[t];
    tables.triangles.emplace_back(rows_of(points, a, b, c), others.order[t]);
  }
  const Subdivision subdivision = subdivide(view, crossings.crossed);
  for (std::uint32_t f = 0; f < subdivision.size(); ++f)
    tables.polygons.emplace_back(static_cast<std::uint32_t>(subdivision.triangles_of(f).size()),
                                 subdivision.components[f]);
  for (auto* list : {&tables.delaunay, &tables.useful}) std::sort(list->begin(), list->end());
  std::sort(tables.triangles.begin(), tables.triangles.end());
  std::sort(tables.fixed.begin(), tables.fixed.end());
  std::sort(tables.polygons.begin(), tables.polygons.end());
  return tables;
}

}  // namespace hydrotin::app
