#include "certify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>

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

// The regions that some triangulation of loaded points rests on, and whether they are covered. A triangulation that
// leaves out the points inside `hole` says nothing about regions that meet it.
class Evidence {
 public:
  Evidence(Neighborhood& around, const LatticeBox& hole) : around_(around), hole_(hole) {}

  [[nodiscard]] bool covers(const Region& region, LatticePoint anchor) {
    if (!hole_.is_empty() && region.meets(hole_)) return true;
    return region.is_inside(around_.window()) || around_.covers(region, anchor);
  }

  [[nodiscard]] bool covers(const TriangulationView& tri, const DecidingCircle& circle) {
    const LatticePoint u = tri.position[circle.u], s = tri.position[circle.s];
    return covers(circle.p.is_none() ? half_plane_right_of(u, s) : disc_through(u, s, tri.position[circle.p]), u);
  }

 private:
  Neighborhood& around_;
  LatticeBox hole_;
};

// Marks the required vertices whose triangles all have covered discs; asks for what the others miss.
std::vector<std::uint8_t> certain_vertices(const TriangulationView& tri, std::vector<std::uint8_t> required,
                                           Evidence& evidence) {
  std::vector<VertexId> doubtful;
  for (TriangleId t{0}; t.value < tri.num_triangles(); ++t.value) {
    const auto v = corners(tri, t);
    const auto anchor = std::find_if(v.begin(), v.end(), [&](VertexId p) { return required[p.value] != 0; });
    if (anchor == v.end()) continue;
    const Region disc = disc_through(tri.position[v[0]], tri.position[v[1]], tri.position[v[2]]);
    if (evidence.covers(disc, tri.position[*anchor])) continue;
    doubtful.insert(doubtful.end(), v.begin(), v.end());
  }
  for (const VertexId v : doubtful) required[v.value] = 0;
  return required;
}

// What was grown of some vertices, and the circles that this rests on beyond the window.
struct Growth {
  GrownEdges grown;
  std::vector<std::uint32_t> beyond_end;  // of each vertex
  std::vector<DecidingCircle> beyond;
};

Growth grow(PencilGrowth& growth, std::span<const VertexId> vertices) {
  Growth out;
  for (const VertexId u : vertices) {
    growth.grow(u, out.grown, out.beyond);
    out.beyond_end.push_back(static_cast<std::uint32_t>(out.beyond.size()));
  }
  return out;
}

// Grows the useful edges of all certain vertices that are not decided yet; those that rest on what is not covered stay
// undecided.
void grow_edges(const CertifiedTile& tile, const std::vector<std::uint8_t>& certain, int k, const LatticeBox& window,
                Evidence& evidence, std::vector<std::uint8_t>& decided, std::vector<GrownEdges>& grown,
                const Executor& executor) {
  const TriangulationView tri = tile.triangulation.view();
  decided.resize(tri.num_vertices());
  if (k == 0) return;
  std::vector<VertexId> open;
  for (VertexId u{0}; u.value < tri.num_vertices(); ++u.value)
    if (certain[u.value] && !decided[u.value]) open.push_back(u);
  std::vector<Growth> parts((open.size() + kGrowthRange - 1) / kGrowthRange);
  Pool<PencilGrowth> growths([&] { return std::make_unique<PencilGrowth>(tri, tile.links, k, window); });
  for_ranges(executor, static_cast<std::uint32_t>(open.size()), kGrowthRange,
             [&](std::uint32_t begin, std::uint32_t end) {
               parts[begin / kGrowthRange] = grow(*growths.lend(), std::span(open).subspan(begin, end - begin));
             });
  for (Growth& part : parts) {
    std::vector<std::uint8_t> is_covered(part.grown.vertex.size(), 1);
    std::uint32_t circle = 0;
    for (std::size_t i = 0; i < is_covered.size(); ++i) {
      for (; circle < part.beyond_end[i]; ++circle)
        if (!evidence.covers(tri, part.beyond[circle])) is_covered[i] = 0;
      if (is_covered[i]) decided[part.grown.vertex[i].value] = 1;
    }
    part.grown.keep(is_covered);
    grown.push_back(std::move(part.grown));
  }
}

// One look at a triangulation of `num_own` own points and others: asks for the points that are missing.
void examine(CertifiedTile& tile, DelaunayBuilder& builder, std::uint32_t num_own, int k, const LatticeBox& hole,
             Neighborhood& around, std::vector<std::uint8_t>& decided, std::vector<GrownEdges>& grown,
             const Executor& executor) {
  tile.triangulation = builder.extract();
  const TriangulationView tri = tile.triangulation.view();
  tile.owned = owned_triangles(tri, num_own);
  tile.links = vertex_links(tri);
  Evidence evidence(around, hole);
  const auto certain = certain_vertices(tri, required_vertices(tri, tile.owned, num_own, k), evidence);
  grow_edges(tile, certain, k, around.window(), evidence, decided, grown, executor);
}

// Finds most of the points that will be missed from a ring along the border alone, at a fraction of the price.
void scout(Neighborhood& around, int k, const Executor& executor) {
  constexpr std::uint32_t kWorthwhile = 50'000;
  constexpr std::int64_t kRingSpacings = 24;
  if (around.num_own() < kWorthwhile) return;
  const LatticeBox own = around.own_box();
  const double area = (static_cast<double>(own.max.x) - own.min.x) * (static_cast<double>(own.max.y) - own.min.y);
  const auto margin = static_cast<std::int64_t>(std::sqrt(area / around.num_own())) * kRingSpacings + 1;
  const auto inner = [&](std::int32_t low, std::int32_t high) {
    return std::pair{std::int64_t{low} + margin, std::int64_t{high} - margin};
  };
  const auto [x0, x1] = inner(own.min.x, own.max.x);
  const auto [y0, y1] = inner(own.min.y, own.max.y);
  if (x0 >= x1 || y0 >= y1) return;
  const LatticeBox hole{{static_cast<std::int32_t>(x0), static_cast<std::int32_t>(y0)},
                        {static_cast<std::int32_t>(x1), static_cast<std::int32_t>(y1)}};
  std::vector<LatticePoint> ring;
  for (std::uint32_t i = 0; i < around.num_own(); ++i)
    if (!hole.contains(around.position()[i])) ring.push_back(around.position()[i]);
  const auto num_ring = static_cast<std::uint32_t>(ring.size());
  DelaunayBuilder builder;
  builder.insert(ring);
  std::size_t inserted = around.num_own();
  do {
    builder.insert(std::span(around.position()).subspan(inserted));
    inserted = around.position().size();
    CertifiedTile look;
    std::vector<std::uint8_t> decided;
    std::vector<GrownEdges> grown;
    examine(look, builder, num_ring, k, hole, around, decided, grown, executor);
  } while (around.fetch());
}

}  // namespace

CertifiedTile certify(Neighborhood& around, int k, const Executor& executor) {
  CertifiedTile out;
  if (around.num_own() == 0) return out;
  scout(around, k, executor);
  DelaunayBuilder builder;
  std::size_t inserted = 0;
  std::vector<std::uint8_t> decided;
  std::vector<GrownEdges> grown;
  do {
    ++out.rounds;
    builder.insert(std::span(around.position()).subspan(inserted));
    inserted = around.position().size();
    examine(out, builder, around.num_own(), k, LatticeBox{}, around, decided, grown, executor);
    // Every doubt has asked for points; without new ones nothing is in doubt.
  } while (around.fetch());
  out.edges = assemble(out.triangulation.view(), out.links, std::move(grown), executor);
  if (out.rounds > 1) locate_entries(out.triangulation.view(), out.links, out.edges);
  return out;
}

}  // namespace hydrotin
