#include "hydrotin/point_set.h"

#include <algorithm>
#include <cmath>

#include "hydrotin/polygon_batch.h"

namespace hydrotin {
namespace {

double total_length(const TriangulationView& tri, std::span<const std::array<std::uint32_t, 3>> triangles) {
  double inner = 0, hull = 0;
  const auto length = [&](std::uint32_t a, std::uint32_t b) {
    const LatticePoint p = tri.position[VertexId{a}], q = tri.position[VertexId{b}];
    return std::sqrt(std::pow(static_cast<double>(p.x) - q.x, 2) + std::pow(static_cast<double>(p.y) - q.y, 2));
  };
  for (const auto& t : triangles) inner += length(t[0], t[1]) + length(t[1], t[2]) + length(t[2], t[0]);
  for (HalfedgeId h{0}; h.value < tri.origin.size(); ++h.value)
    if (tri.twin[h].is_none()) hull += length(tri.origin[h].value, tri.target(h).value);
  return (inner + hull) / 2;
}

}  // namespace

std::uint32_t count_minima(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                           std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::vector<std::uint8_t> has_lower(position.size());
  for (const auto& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      has_lower[is_lower(height[a], position[a], height[b], position[b]) ? b : a] = 1;
    }
  return static_cast<std::uint32_t>(std::count(has_lower.begin(), has_lower.end(), std::uint8_t{0}));
}

PointSetTriangulation triangulate(std::span<const LatticePoint> position, std::span<const std::int32_t> height, int k,
                                  Objective objective) {
  PointSetTriangulation out;
  const Triangulation owner = delaunay(position);
  const TriangulationView tri = owner.view();
  if (tri.num_triangles() == 0) return out;
  const VertexLinks links = vertex_links(tri);
  const UsefulEdges edges = useful_edges(tri, links, k);
  const OrderKTriangles triangles = order_k_triangles(tri, links, edges, k);
  const Crossings crossings = find_crossings(tri, edges);
  const Subdivision subdivision = subdivide(tri, crossings.crossed);
  const PolygonCandidates candidates = candidates_by_polygon(subdivision, triangles);
  MinimaAssignment assignment;
  if (objective == Objective::local_minima) assignment = assign_minima(tri, links, edges, crossings, height);

  const PolygonSource source{tri,
                             height,
                             crossings,
                             subdivision,
                             triangles,
                             candidates,
                             objective == Objective::local_minima ? &assignment : nullptr};
  PolygonExtractor extractor(source);
  PolygonSolver solver(objective);
  out.triangles.reserve(tri.num_triangles());
  out.polygons = subdivision.size();
  for (std::uint32_t f = 0; f < subdivision.size(); ++f) {
    const std::size_t first = out.triangles.size();
    const PolygonResult result = solver.solve(extractor.extract(f), out.triangles);
    for (std::size_t t = first; t < out.triangles.size(); ++t)
      for (auto& v : out.triangles[t]) v = extractor.vertices()[v].value;
    out.max_order = std::max(out.max_order, result.max_order);
    out.fallbacks += !result.optimal && result.ways > 1;
    out.max_polygon = std::max(out.max_polygon, subdivision.begin[f + 1] - subdivision.begin[f]);
    out.components += subdivision.components[f];
    out.max_components = std::max(out.max_components, subdivision.components[f]);
  }
  switch (objective) {
    case Objective::delaunay:
      out.optimal = true;
      break;
    case Objective::min_weight:
      out.value = total_length(tri, out.triangles);
      out.optimal = out.fallbacks == 0;
      out.bound = out.optimal ? out.value : 0;
      break;
    case Objective::local_minima:
      out.value = count_minima(position, height, out.triangles);
      out.bound = static_cast<double>(std::count(assignment.fate.begin(), assignment.fate.end(), MinimumFate::always));
      out.optimal = out.value == out.bound;
      break;
  }
  return out;
}

}  // namespace hydrotin
