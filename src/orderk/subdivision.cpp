#include "hydrotin/subdivision.h"

#include <atomic>
#include <cassert>
#include <numeric>

#include "hydrotin/predicates.h"

namespace hydrotin {

namespace {

constexpr std::uint32_t kEdgeRange = 1U << 14, kTriangleRange = 1U << 15;

void add_crossings(const TriangulationView& tri, const UsefulEdges& edges, std::uint32_t begin, std::uint32_t end,
                   Crossings& out) {
  // Several edges cross the same half-edge, and all say the same of it.
  const auto mark = [&](HalfedgeId h) {
    std::atomic_ref<std::uint8_t>(out.crossed[h.value]).store(1, std::memory_order_relaxed);
  };
  for (std::uint32_t e = begin; e < end; ++e) {
    const VertexId b = edges.b[e];
    const LatticePoint at_a = tri.position[edges.a(tri, e)], at_b = tri.position[b];
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

// Sets of triangles; the smallest of each is its root.
class TriangleSets {
 public:
  explicit TriangleSets(std::uint32_t num_triangles) : root_(num_triangles) {}

  /// The triangles [begin, end), one by one.
  void separate(std::uint32_t begin, std::uint32_t end) {
    std::iota(root_.begin() + begin, root_.begin() + end, begin);
  }
  std::uint32_t find(std::uint32_t t) {
    while (root_[t] != t) t = root_[t] = root_[root_[t]];
    return t;
  }
  void join(std::uint32_t s, std::uint32_t t) {
    s = find(s);
    t = find(t);
    if (s < t) root_[t] = s;
    if (t < s) root_[s] = t;
  }

 private:
  std::vector<std::uint32_t> root_;
};

// Joins what crossed half-edges join: first inside ranges of triangles, which stand near each other, then across.
TriangleSets join_across(const TriangulationView& tri, std::span<const std::uint8_t> crossed,
                         const Executor& executor) {
  const std::uint32_t num_triangles = tri.num_triangles();
  TriangleSets sets(num_triangles);
  std::vector<std::vector<HalfedgeId>> between(num_triangles / kTriangleRange + 1);
  for_ranges(executor, num_triangles, kTriangleRange, [&](std::uint32_t begin, std::uint32_t end) {
    sets.separate(begin, end);
    for (HalfedgeId h{3 * begin}; h.value < 3 * end; ++h.value) {
      if (!crossed[h.value] || h > tri.twin[h]) continue;
      const std::uint32_t s = triangle_of(h).value, t = triangle_of(tri.twin[h]).value;
      if (t < end)
        sets.join(s, t);
      else
        between[begin / kTriangleRange].push_back(h);
    }
  });
  for (const auto& range : between)
    for (const HalfedgeId h : range) sets.join(triangle_of(h).value, triangle_of(tri.twin[h]).value);
  return sets;
}

}  // namespace

Crossings find_crossings(const TriangulationView& tri, const UsefulEdges& edges, const Executor& executor) {
  Crossings out;
  out.crossed.resize(tri.origin.size());
  out.exit.resize(edges.size());
  for_ranges(executor, edges.size(), kEdgeRange,
             [&](std::uint32_t begin, std::uint32_t end) { add_crossings(tri, edges, begin, end, out); });
  return out;
}

Subdivision subdivide(const TriangulationView& tri, std::span<const std::uint8_t> crossed, const Executor& executor) {
  const std::uint32_t num_triangles = tri.num_triangles();
  TriangleSets sets = join_across(tri, crossed, executor);
  Subdivision out;
  out.polygon.resize(num_triangles);
  std::vector<std::uint32_t> size;
  for (std::uint32_t t = 0; t < num_triangles; ++t) {
    const std::uint32_t r = sets.find(t);
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
