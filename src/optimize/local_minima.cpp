#include "hydrotin/local_minima.h"

#include "hydrotin/polygon.h"

namespace hydrotin {

MinimaAssigner::MinimaAssigner(const TriangulationView& triangulation, const VertexLinks& links,
                               const UsefulEdges& edges, const Crossings& crossings,
                               std::span<const std::int32_t> height)
    : tri_(triangulation), links_(links), edges_(edges), crossings_(crossings), height_(height) {
  const std::uint32_t n = tri_.num_vertices();
  out_.fate.assign(n, MinimumFate::always);
  out_.where.resize(n);
  lowest_.resize(n);
}

bool MinimaAssigner::lower(VertexId p, VertexId q) const {
  return is_lower(height_[p.value], tri_.position[p], height_[q.value], tri_.position[q]);
}

void MinimaAssigner::offer(VertexId v, VertexId w, HalfedgeId h) {
  if (out_.fate[v.value] == MinimumFate::never || !lower(w, v)) return;
  out_.fate[v.value] = MinimumFate::assigned;
  VertexId& best = lowest_[v.value];
  if (!best.is_none() && !lower(w, best)) return;
  best = w;
  out_.where[v.value] = triangle_of(h);
}

void MinimaAssigner::look_at_delaunay(VertexId begin, VertexId end) {
  for (VertexId v = begin; v < end; ++v.value)
    for (std::uint32_t i = links_.begin[v.value]; i < links_.begin[v.value + 1]; ++i) {
      const VertexId w = links_.neighbor[i];
      const HalfedgeId spoke = links_.spoke[i];
      const bool fixed = spoke.is_none() || !crossings_.crossed[spoke.value];
      if (!fixed) {
        offer(v, w, spoke);
      } else if (lower(w, v)) {
        out_.fate[v.value] = MinimumFate::never;
        out_.where[v.value] = TriangleId{};
        break;
      }
    }
}

MinimaAssignment MinimaAssigner::finish() {
  for (std::uint32_t e = 0; e < edges_.size(); ++e) {
    offer(edges_.a[e], edges_.b[e], edges_.entry[e]);
    offer(edges_.b[e], edges_.a[e], crossings_.exit[e]);
  }
  lowest_ = {};
  return std::move(out_);
}

MinimaAssignment assign_minima(const TriangulationView& tri, const VertexLinks& links, const UsefulEdges& edges,
                               const Crossings& crossings, std::span<const std::int32_t> height) {
  MinimaAssigner assigner(tri, links, edges, crossings, height);
  assigner.look_at_delaunay(VertexId{0}, VertexId{tri.num_vertices()});
  return assigner.finish();
}

}  // namespace hydrotin
