#include "hydrotin/local_minima.h"

#include "hydrotin/polygon.h"

namespace hydrotin {

MinimaAssignment assign_minima(const TriangulationView& tri, const VertexLinks& links, const UsefulEdges& edges,
                               const Crossings& crossings, std::span<const std::int32_t> height) {
  const std::uint32_t n = tri.num_vertices();
  MinimaAssignment out;
  out.fate.assign(n, MinimumFate::always);
  out.where.resize(n);
  std::vector<VertexId> lowest(n);
  const auto lower = [&](VertexId p, VertexId q) {
    return is_lower(height[p.value], tri.position[p], height[q.value], tri.position[q]);
  };
  const auto offer = [&](VertexId v, VertexId w, HalfedgeId h) {
    if (out.fate[v.value] == MinimumFate::never || !lower(w, v)) return;
    out.fate[v.value] = MinimumFate::assigned;
    VertexId& best = lowest[v.value];
    if (!best.is_none() && !lower(w, best)) return;
    best = w;
    out.where[v.value] = triangle_of(h);
  };
  for (VertexId v{0}; v.value < n; ++v.value)
    for (std::uint32_t i = links.begin[v.value]; i < links.begin[v.value + 1]; ++i) {
      const VertexId w = links.neighbor[i];
      const HalfedgeId spoke = links.spoke[i];
      const bool fixed = spoke.is_none() || !crossings.crossed[spoke.value];
      if (!fixed) {
        offer(v, w, spoke);
      } else if (lower(w, v)) {
        out.fate[v.value] = MinimumFate::never;
        out.where[v.value] = TriangleId{};
        break;
      }
    }
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    offer(edges.a[e], edges.b[e], edges.entry[e]);
    offer(edges.b[e], edges.a[e], crossings.exit[e]);
  }
  return out;
}

}  // namespace hydrotin
