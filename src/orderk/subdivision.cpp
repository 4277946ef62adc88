#include "hydrotin/subdivision.h"

#include <atomic>
#include <cassert>
#include <numeric>

#include "hydrotin/predicates.h"

namespace hydrotin {

Crossings no_crossings(const TriangulationView& tri, const UsefulEdges& edges) {
  Crossings out;
  out.crossed.resize(tri.origin.size());
  out.exit.resize(edges.size());
  return out;
}

Crossings find_crossings(const TriangulationView& tri, const UsefulEdges& edges) {
  Crossings out = no_crossings(tri, edges);
  add_crossings(tri, edges, 0, edges.size(), out);
  return out;
}

void add_crossings(const TriangulationView& tri, const UsefulEdges& edges, std::uint32_t begin, std::uint32_t end,
                   Crossings& out) {
  // Several edges cross the same half-edge, and all say the same of it.
  const auto mark = [&](HalfedgeId h) {
    std::atomic_ref<std::uint8_t>(out.crossed[h.value]).store(1, std::memory_order_relaxed);
  };
  for (std::uint32_t e = begin; e < end; ++e) {
    const VertexId b = edges.b[e];
    const LatticePoint at_a = tri.position[edges.a[e]], at_b = tri.position[b];
    HalfedgeId h = edges.entry[e];
    for (;;) {
      const HalfedgeId twin = tri.twin[h];
      assert(!twin.is_none() && "a useful edge never leaves the hull");
      mark(h);
      mark(twin);
      const VertexId apex = tri.apex(twin);
      if (apex == b) {
        out.exit[e] = twin;
        break;
      }
      // An admissible edge has no vertex on it, so the apex lies strictly to one side.
      const bool apex_is_left = orientation(at_a, at_b, tri.position[apex]) > 0;
      const bool origin_is_left = orientation(at_a, at_b, tri.position[tri.origin[twin]]) > 0;
      h = apex_is_left == origin_is_left ? next(twin) : previous(twin);
    }
  }
}

Subdivision subdivide(const TriangulationView& tri, std::span<const std::uint8_t> crossed) {
  const std::uint32_t num_triangles = tri.num_triangles();
  std::vector<std::uint32_t> root(num_triangles);
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](std::uint32_t t) {
    while (root[t] != t) t = root[t] = root[root[t]];
    return t;
  };
  for (HalfedgeId h{0}; h.value < tri.origin.size(); ++h.value) {
    if (!crossed[h.value] || h > tri.twin[h]) continue;
    const std::uint32_t s = find(triangle_of(h).value), t = find(triangle_of(tri.twin[h]).value);
    if (s < t) root[t] = s;  // the smallest triangle stays the root
    if (t < s) root[s] = t;
  }

  Subdivision out;
  out.polygon.resize(num_triangles);
  std::vector<std::uint32_t> size;
  for (std::uint32_t t = 0; t < num_triangles; ++t) {
    const std::uint32_t r = find(t);
    if (r == t) {
      out.polygon[t] = static_cast<std::uint32_t>(size.size());
      size.push_back(1);
    } else {
      out.polygon[t] = out.polygon[r];
      ++size[out.polygon[t]];
    }
  }
  out.begin.resize(size.size() + 1);
  std::partial_sum(size.begin(), size.end(), out.begin.begin() + 1);
  out.triangle.resize(num_triangles);
  std::vector<std::uint32_t> at(out.begin.begin(), out.begin.end() - 1);
  std::vector<std::uint32_t> crossed_sides(size.size());
  for (std::uint32_t t = 0; t < num_triangles; ++t) {
    out.triangle[at[out.polygon[t]]++] = TriangleId{t};
    for (std::uint32_t i = 0; i < 3; ++i) crossed_sides[out.polygon[t]] += crossed[3 * t + i];
  }
  out.components.resize(size.size());
  for (std::size_t f = 0; f < size.size(); ++f) out.components[f] = crossed_sides[f] / 2 + 1 - size[f];
  return out;
}

}  // namespace hydrotin
