#include "certify.h"

#include <algorithm>
#include <array>

namespace hydrotin {
namespace {

std::array<VertexId, 3> corners(const TriangulationView& tri, TriangleId t) {
  const HalfedgeId h = first_halfedge(t);
  return {tri.origin[h], tri.target(h), tri.apex(h)};
}

std::vector<std::uint8_t> owned_triangles(const TriangulationView& tri, std::uint32_t num_own) {
  std::vector<std::uint8_t> owned(tri.num_triangles());
  for (TriangleId t{0}; t.value < tri.num_triangles(); ++t.value) {
    const auto v = corners(tri, t);
    const VertexId first = *std::min_element(v.begin(), v.end(),
                                             [&](VertexId a, VertexId b) { return tri.position[a] < tri.position[b]; });
    owned[t.value] = first.value < num_own;
  }
  return owned;
}

// Vertices whose triangles and useful edges have to be certain: those of all triangles within `depth` steps of a
// triangle that shares a vertex with an owned one. At order 0 the own vertices.
std::vector<std::uint8_t> required_vertices(const TriangulationView& tri, const std::vector<std::uint8_t>& owned,
                                            std::uint32_t num_own, int k) {
  std::vector<std::uint8_t> required(tri.num_vertices());
  std::fill_n(required.begin(), num_own, std::uint8_t{1});
  if (k == 0) return required;
  for (TriangleId t{0}; t.value < tri.num_triangles(); ++t.value)
    if (owned[t.value])
      for (const VertexId v : corners(tri, t)) required[v.value] = 1;
  std::vector<std::uint8_t> reached(tri.num_triangles());
  for (TriangleId t{0}; t.value < tri.num_triangles(); ++t.value)
    for (const VertexId v : corners(tri, t)) reached[t.value] |= required[v.value];
  std::vector<TriangleId> front, following;
  for (TriangleId t{0}; t.value < tri.num_triangles(); ++t.value)
    if (reached[t.value]) front.push_back(t);
  for (int depth = 0; depth < 2 * k; ++depth) {
    following.clear();
    for (const TriangleId t : front) {
      for (const VertexId v : corners(tri, t)) required[v.value] = 1;
      for (HalfedgeId h = first_halfedge(t); triangle_of(h) == t; ++h.value) {
        const HalfedgeId twin = tri.twin[h];
        if (twin.is_none() || reached[triangle_of(twin).value]) continue;
        reached[triangle_of(twin).value] = 1;
        following.push_back(triangle_of(twin));
      }
    }
    front.swap(following);
  }
  return required;
}

// Marks the required vertices whose triangles all have covered discs; asks for what the others miss.
std::vector<std::uint8_t> certain_vertices(const TriangulationView& tri, std::vector<std::uint8_t> required,
                                           Neighborhood& around) {
  std::vector<VertexId> doubtful;
  for (TriangleId t{0}; t.value < tri.num_triangles(); ++t.value) {
    const auto v = corners(tri, t);
    const auto anchor = std::find_if(v.begin(), v.end(), [&](VertexId p) { return required[p.value] != 0; });
    if (anchor == v.end()) continue;
    const Region disc = disc_through(tri.position[v[0]], tri.position[v[1]], tri.position[v[2]]);
    if (disc.is_inside(around.window()) || around.covers(disc, tri.position[*anchor])) continue;
    doubtful.insert(doubtful.end(), v.begin(), v.end());
  }
  for (const VertexId v : doubtful) required[v.value] = 0;
  return required;
}

bool is_covered(const TriangulationView& tri, const DecidingCircle& circle, Neighborhood& around) {
  const LatticePoint u = tri.position[circle.u], s = tri.position[circle.s];
  return around.covers(circle.p.is_none() ? half_plane_right_of(u, s) : disc_through(u, s, tri.position[circle.p]), u);
}

}  // namespace

CertifiedTile certify(Neighborhood& around, int k) {
  CertifiedTile out;
  if (around.num_own() == 0) return out;
  DelaunayBuilder builder;
  std::size_t inserted = 0;
  std::vector<std::uint8_t> decided;
  std::vector<DecidingCircle> beyond;
  for (;;) {
    ++out.rounds;
    builder.insert(std::span(around.position()).subspan(inserted));
    inserted = around.position().size();
    out.triangulation = builder.extract();
    const TriangulationView tri = out.triangulation.view();
    out.owned = owned_triangles(tri, around.num_own());
    out.links = vertex_links(tri);
    const auto certain = certain_vertices(tri, required_vertices(tri, out.owned, around.num_own(), k), around);
    decided.resize(tri.num_vertices());
    if (k > 0) {
      PencilGrowth growth(tri, out.links, k, around.window());
      for (VertexId u{0}; u.value < tri.num_vertices(); ++u.value) {
        if (!certain[u.value] || decided[u.value]) continue;
        const std::uint32_t before = out.edges.size();
        beyond.clear();
        growth.grow(u, out.edges, beyond);
        bool covered = true;
        for (const DecidingCircle& circle : beyond) covered = is_covered(tri, circle, around) && covered;
        if (covered)
          decided[u.value] = 1;
        else
          out.edges.truncate(before);
      }
    }
    // Every doubt has asked for points; without new ones nothing is in doubt.
    if (!around.fetch()) break;
  }
  if (out.rounds > 1) locate_entries(out.triangulation.view(), out.links, out.edges);
  return out;
}

}  // namespace hydrotin
