#include "hydrotin/triangulation.h"

namespace hydrotin {
namespace {

// A half-edge leaving each vertex; of a hull vertex the most clockwise one, where the link has to start.
std::vector<HalfedgeId> first_spokes(const TriangulationView& tri) {
  std::vector<HalfedgeId> first(tri.num_vertices());
  const auto num_halfedges = static_cast<std::uint32_t>(tri.origin.size());
  for (HalfedgeId h{0}; h.value < num_halfedges; ++h.value) {
    HalfedgeId& spoke = first[tri.origin[h].value];
    if (spoke.is_none() || tri.twin[h].is_none()) spoke = h;
  }
  return first;
}

}  // namespace

VertexLinks vertex_links(const TriangulationView& tri) {
  VertexLinks links;
  const std::uint32_t n = tri.num_vertices();
  const auto first = first_spokes(tri);
  links.begin.resize(n + 1);
  links.on_hull.resize(n);
  links.neighbor.reserve(tri.origin.size() + n / 8 + 16);
  links.spoke.reserve(tri.origin.size() + n / 8 + 16);
  for (std::uint32_t v = 0; v < n; ++v) {
    links.begin[v] = static_cast<std::uint32_t>(links.neighbor.size());
    if (first[v].is_none()) continue;
    HalfedgeId h = first[v];
    do {
      links.neighbor.push_back(tri.target(h));
      links.spoke.push_back(h);
      const HalfedgeId incoming = previous(h);
      h = tri.twin[incoming];
      if (h.is_none()) {  // the other hull edge has no half-edge that leaves v
        links.neighbor.push_back(tri.origin[incoming]);
        links.spoke.push_back(HalfedgeId{});
        links.on_hull[v] = 1;
      }
    } while (!h.is_none() && h != first[v]);
  }
  links.begin[n] = static_cast<std::uint32_t>(links.neighbor.size());
  return links;
}

}  // namespace hydrotin
