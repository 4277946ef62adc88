#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "clouds.h"
#include "hydrotin/pencil_growth.h"
#include "oracle/definitions.h"

// Useful edges against Lemma 2.1 taken literally: for every pair of points, all other points are looked at.

namespace hydrotin {
namespace {

using oracle::Points;

__extension__ using Int128 = __int128;

// Twice the area of abc; coordinates below 2^31.
Int128 area(LatticePoint a, LatticePoint b, LatticePoint c) {
  return (Int128{b.x} - a.x) * (Int128{c.y} - a.y) - (Int128{b.y} - a.y) * (Int128{c.x} - a.x);
}

// Whether d lies inside the circle through a, b, c, which turn left; points at most 2^30 apart. Ties go to the oracle.
bool inside(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d) {
  const auto square = [&](LatticePoint p) {
    return (Int128{p.x} - d.x) * (Int128{p.x} - d.x) + (Int128{p.y} - d.y) * (Int128{p.y} - d.y);
  };
  const Int128 det = square(a) * area(d, b, c) + square(b) * area(d, c, a) + square(c) * area(d, a, b);
  return det != 0 ? det > 0 : oracle::in_disc(a, b, c, d);
}

// The edge from u to v (u before v in (x, y)): points inside C(u, v, s1), and inside C(u, v, s2).
struct Lemma {
  std::uint32_t s1 = 0, s2 = 0;  // of the edge
  std::set<std::uint32_t> right, left;

  [[nodiscard]] int order() const { return static_cast<int>(std::max(right.size(), left.size())); }
};

// Nothing if a point lies on the edge or one side is empty (then the edge lies on the hull).
std::optional<Lemma> lemma_2_1(const Points& p, std::uint32_t u, std::uint32_t v) {
  std::optional<std::uint32_t> s1, s2;
  for (std::uint32_t i = 0; i < p.size(); ++i) {
    if (i == u || i == v) continue;
    const Int128 turn = area(p[u], p[v], p[i]);
    if (turn == 0 && oracle::on_segment(p[u], p[v], p[i])) return std::nullopt;
    if (turn > 0 && (!s1 || inside(p[u], p[v], p[*s1], p[i]))) s1 = i;
    if (turn < 0 && (!s2 || inside(p[v], p[u], p[*s2], p[i]))) s2 = i;
  }
  if (!s1 || !s2) return std::nullopt;
  Lemma out{*s1, *s2, {}, {}};
  for (std::uint32_t i = 0; i < p.size(); ++i) {
    if (i == u || i == v) continue;
    if (i != *s1 && inside(p[u], p[v], p[*s1], p[i])) out.right.insert(i);
    if (i != *s2 && inside(p[v], p[u], p[*s2], p[i])) out.left.insert(i);
  }
  return out;
}

// What is stored with an edge; apexes with their orders.
struct Found {
  int order = 0;
  std::size_t num_right = 0, num_left = 0;
  std::uint32_t s1 = 0, s2 = 0;
  std::map<std::uint32_t, int> right, left;
  friend bool operator==(const Found&, const Found&) = default;
};

using Edges = std::map<std::pair<std::uint32_t, std::uint32_t>, Found>;

Edges ids_of(const TriangulationView& tri, const UsefulEdges& edges) {
  Edges out;
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const VertexId a = edges.a(tri, e);
    Found found{edges.useful_order(e),
                edges.num_right[e],
                edges.num_left[e],
                edges.left[e].value,
                edges.right[e].value,
                {},
                {}};
    for (const Apex& apex : edges.apexes(e))
      EXPECT_TRUE((apex.is_right ? found.right : found.left).insert({apex.point.value, apex.order}).second);
    EXPECT_TRUE(out.insert({{a.value, edges.b[e].value}, found}).second);
  }
  return out;
}

// The apexes among the points of one side: empty triangles of order at most k with useful edges, without the first
// point hit.
std::map<std::uint32_t, int> apexes(const Points& p, std::uint32_t u, std::uint32_t v, std::uint32_t first,
                                    const std::set<std::uint32_t>& side, int k) {
  std::map<std::uint32_t, int> out;
  for (const std::uint32_t w : side) {
    if (w == first) continue;
    const auto [a, b] = area(p[u], p[v], p[w]) > 0 ? std::pair{u, v} : std::pair{v, u};
    int order = 0;
    bool empty = true;
    for (std::uint32_t i = 0; i < p.size(); ++i) {
      if (i == u || i == v || i == w) continue;
      order += inside(p[a], p[b], p[w], p[i]);
      empty = empty && !(area(p[a], p[b], p[i]) >= 0 && area(p[b], p[w], p[i]) >= 0 && area(p[w], p[a], p[i]) >= 0);
    }
    if (!empty || order > k) continue;
    const auto is_useful = [&](std::uint32_t from, std::uint32_t to) {
      const auto leg = p[from] < p[to] ? lemma_2_1(p, from, to) : lemma_2_1(p, to, from);
      if (leg) return leg->order() <= k;
      return std::none_of(p.begin(), p.end(), [&](LatticePoint q) {  // an edge of the hull
        return q != p[from] && q != p[to] && oracle::on_segment(p[from], p[to], q);
      });
    };
    if (!is_useful(u, w) || !is_useful(v, w)) continue;
    out[w] = order;
  }
  return out;
}

// Compares all edges with an end in `ends`, for k = 1..8.
void compare(const Points& points, const std::vector<std::uint32_t>& ends) {
  constexpr int kMost = 8;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Lemma> literal;
  for (const std::uint32_t end : ends)
    for (std::uint32_t other = 0; other < points.size(); ++other) {
      if (other == end) continue;
      const auto [u, v] = points[end] < points[other] ? std::pair{end, other} : std::pair{other, end};
      const auto lemma = lemma_2_1(points, u, v);
      // An empty circle through u and v: a Delaunay edge.
      if (!lemma || lemma->right.empty() || lemma->left.empty() || lemma->order() > kMost) continue;
      literal[{u, v}] = *lemma;
    }
  const Triangulation owner = delaunay(points);
  const TriangulationView tri = owner.view();
  if (tri.num_triangles() == 0) return;
  const VertexLinks links = vertex_links(tri);
  const std::set<std::uint32_t> wanted(ends.begin(), ends.end());
  for (int k = 1; k <= kMost; ++k) {
    Edges expected, found = ids_of(tri, useful_edges(tri, links, k));
    for (const auto& [edge, lemma] : literal) {
      if (lemma.order() > k) continue;
      const auto [u, v] = edge;
      expected[edge] = {lemma.order(),
                        lemma.right.size(),
                        lemma.left.size(),
                        lemma.s1,
                        lemma.s2,
                        apexes(points, u, v, lemma.s2, lemma.right, k),
                        apexes(points, u, v, lemma.s1, lemma.left, k)};
    }
    std::erase_if(found, [&](const auto& edge) {
      return !wanted.contains(edge.first.first) && !wanted.contains(edge.first.second);
    });
    EXPECT_EQ(found, expected) << "k " << k;
  }
}

void compare_all(const Points& points) {
  std::vector<std::uint32_t> ends(points.size());
  for (std::uint32_t i = 0; i < ends.size(); ++i) ends[i] = i;
  compare(points, ends);
}

Points moved(Points points, std::int32_t factor, LatticePoint shift) {
  for (LatticePoint& p : points) p = {p.x * factor + shift.x, p.y * factor + shift.y};
  return points;
}

TEST(Lemma21, EqualsUsefulEdgesOnAllKindsOfClouds) {
  for (std::uint64_t seed = 0; seed < 6; ++seed)
    for (const auto kind : {testing::CloudKind::uniform, testing::CloudKind::lattice, testing::CloudKind::jittered,
                            testing::CloudKind::scanlines, testing::CloudKind::clustered, testing::CloudKind::voided}) {
      SCOPED_TRACE(::testing::Message() << testing::name_of(kind) << " seed " << seed);
      auto points = testing::distinct(testing::make_cloud(kind, seed, 40 + 5 * seed, seed % 2 ? 12 : 300));
      testing::shuffle(seed, points);
      compare_all(points);
    }
}

TEST(Lemma21, EqualsUsefulEdgesWhereEveryPointIsCocircularWithOthers) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(seed);
    auto points = testing::distinct(testing::random_points(seed, 50, 8));
    testing::shuffle(seed, points);
    compare_all(points);
  }
}

// The same clouds at the coordinates of a national grid, and stretched until no product is exact in double.
TEST(Lemma21, EqualsUsefulEdgesAtAnyPlaceAndScale) {
  for (std::uint64_t seed = 0; seed < 4; ++seed)
    for (const auto kind : {testing::CloudKind::uniform, testing::CloudKind::lattice, testing::CloudKind::scanlines}) {
      SCOPED_TRACE(::testing::Message() << testing::name_of(kind) << " seed " << seed);
      auto points = testing::distinct(testing::make_cloud(kind, seed, 40, 30));
      testing::shuffle(seed, points);
      compare_all(moved(points, 1, {65'000'000, 520'000'000}));
      for (const std::int32_t factor : {100'000, 150'001, 1'000'000})
        compare_all(moved(points, factor, {-500'000'000, -400'000'000}));
    }
}

// One far point among near ones: the extents of single vectors decide which arithmetic is used.
TEST(Lemma21, EqualsUsefulEdgesWithFarPoints) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    auto points = testing::random_points(seed, 45, 20);
    points.push_back({1 << 25, 3});
    points.push_back({(1 << 25) - 1, 12});
    points.push_back({7, 400'000'000});
    points.push_back({-300'000'000, -300'000'000});
    points = testing::distinct(std::move(points));
    testing::shuffle(seed, points);
    compare_all(points);
  }
}

// A point in the middle of a ring is the neighbour of all points of the ring.
Points hub_and_rings(std::uint64_t seed, std::size_t n, std::int32_t radius) {
  testing::Random random(seed);
  Points points{{0, 0}};
  while (points.size() < n) {
    const double t = 8 * random.unit() - 4, d = 1 + t * t;  // the circle by its rational parameter
    const double r = radius * (random.below(50) == 0 ? 1.5 : 1.0);
    points.push_back({static_cast<std::int32_t>(std::lround(r * (1 - t * t) / d)),
                      static_cast<std::int32_t>(std::lround(r * 2 * t / d))});
  }
  points = testing::distinct(std::move(points));
  testing::shuffle(seed, points);
  return points;
}

TEST(Lemma21, EqualsUsefulEdgesAtAHub) {
  for (const std::int32_t radius : {10'000'000, 50'000'000}) {
    SCOPED_TRACE(radius);
    const Points points = hub_and_rings(1, 2600, radius);
    const auto hub =
        static_cast<std::uint32_t>(std::find(points.begin(), points.end(), LatticePoint{0, 0}) - points.begin());
    const Triangulation owner = delaunay(points);
    EXPECT_GT(vertex_links(owner.view()).of(VertexId{hub}).size(), 2000U);
    compare(points, {hub, 700});
  }
}

// Parts of any size, and of vertices in any order, give the same edges.
TEST(UsefulEdges, AreTheSameForEveryWayOfCutting) {
  const auto points = testing::distinct(testing::make_cloud(testing::CloudKind::scanlines, 3, 700, 40));
  const Triangulation owner = delaunay(points);
  const TriangulationView tri = owner.view();
  const VertexLinks links = vertex_links(tri);
  const UsefulEdges whole = useful_edges(tri, links, 3);
  std::vector<std::uint32_t> mixed(tri.num_vertices());
  std::iota(mixed.begin(), mixed.end(), 0U);
  for (const std::uint32_t range : {1U, 7U, 100U, 699U, 5000U}) {
    PencilGrowth growth(tri, links, 3, kWholePlane);
    std::vector<DecidingCircle> beyond;
    std::vector<GrownEdges> parts;
    for (std::uint32_t begin = 0; begin < mixed.size(); begin += range) {
      // Every vertex is grown twice, and kept once.
      GrownEdges& part = parts.emplace_back();
      std::vector<std::uint8_t> wanted;
      for (std::uint32_t i = begin; i < std::min<std::size_t>(begin + range, mixed.size()); ++i)
        for (int time = 0; time < 2; ++time) {
          growth.grow(VertexId{mixed[i]}, part, beyond);
          wanted.push_back(time == static_cast<int>(i % 2));
        }
      part.keep(wanted);
    }
    const UsefulEdges edges = assemble(tri, links, std::move(parts));
    EXPECT_EQ(edges.begin, whole.begin);
    EXPECT_EQ(edges.b, whole.b);
    EXPECT_EQ(edges.left, whole.left);
    EXPECT_EQ(edges.right, whole.right);
    EXPECT_EQ(edges.num_left, whole.num_left);
    EXPECT_EQ(edges.num_right, whole.num_right);
    EXPECT_EQ(edges.entry, whole.entry);
    EXPECT_EQ(edges.apex, whole.apex);
    testing::shuffle(range, mixed);
  }
}

}  // namespace
}  // namespace hydrotin
