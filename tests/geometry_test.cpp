#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "clouds.h"
#include "hydrotin/hilbert.h"
#include "hydrotin/predicates.h"
#include "hydrotin/triangulation.h"
#include "oracle/definitions.h"

namespace hydrotin {
namespace {

using oracle::Big;
using testing::Random;
using Triple = std::array<LatticePoint, 3>;

Triple sorted(Triple t) {
  std::sort(t.begin(), t.end());
  return t;
}

std::set<Triple> triangles_of(const TriangulationView& tri) {
  std::set<Triple> out;
  for (TriangleId t{0}; t.value < tri.num_triangles(); ++t.value) {
    const HalfedgeId h = first_halfedge(t);
    const LatticePoint a = tri.position[tri.origin[h]], b = tri.position[tri.target(h)], c = tri.position[tri.apex(h)];
    EXPECT_GT(orientation(a, b, c), 0);
    EXPECT_TRUE(out.insert(sorted({a, b, c})).second);
  }
  return out;
}

std::set<Triple> triangles_by_definition(const std::vector<LatticePoint>& p) {
  std::set<Triple> out;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = i + 1; j < p.size(); ++j)
      for (std::size_t k = j + 1; k < p.size(); ++k) {
        LatticePoint a = p[i], b = p[j], c = p[k];
        const auto twice_area = (Big{b.x} - a.x) * (Big{c.y} - a.y) - (Big{b.y} - a.y) * (Big{c.x} - a.x);
        if (twice_area == 0) continue;
        if (twice_area < 0) std::swap(b, c);
        const bool empty = std::none_of(p.begin(), p.end(), [&](LatticePoint q) {
          return q != a && q != b && q != c && oracle::in_disc(a, b, c, q);
        });
        if (empty) out.insert(sorted({a, b, c}));
      }
  return out;
}

void expect_consistent(const TriangulationView& tri) {
  for (HalfedgeId h{0}; h.value < tri.origin.size(); ++h.value) {
    const HalfedgeId twin = tri.twin[h];
    if (twin.is_none()) continue;
    EXPECT_EQ(tri.twin[twin], h);
    EXPECT_EQ(tri.origin[twin], tri.target(h));
  }
}

TEST(Predicates, Definition_InCircleEqualsThePerturbedDeterminant) {
  Random random(1);
  int ties = 0;
  for (int i = 0; i < 12000; ++i) {
    const std::int32_t extent = i % 3 == 0 ? 4 : i % 3 == 1 ? 1 << 20 : (1 << 30);
    const std::int32_t shift = i % 2 == 0 ? 0 : -1000000000;
    std::array<LatticePoint, 4> p;
    for (auto& q : p) q = {shift + random.between(0, extent), shift + random.between(0, extent)};
    if (std::set<LatticePoint>(p.begin(), p.end()).size() < 4 || orientation(p[0], p[1], p[2]) == 0) continue;
    if (orientation(p[0], p[1], p[2]) < 0) std::swap(p[0], p[1]);
    ties += in_circle_sign(p[0], p[1], p[2], p[3]) == 0;
    EXPECT_EQ(in_circle(p[0], p[1], p[2], p[3]), oracle::in_disc(p[0], p[1], p[2], p[3])) << i;
    EXPECT_EQ(in_circle(p[0], p[1], p[2], p[3]), in_circle(p[1], p[2], p[0], p[3])) << i;
  }
  EXPECT_GT(ties, 100);
}

TEST(Predicates, ExactAtTheEndsOfTheLattice) {
  constexpr std::int32_t lo = std::numeric_limits<std::int32_t>::min(), hi = std::numeric_limits<std::int32_t>::max();
  EXPECT_EQ(orientation({lo, lo}, {hi, hi}, {0, 1}), 1);
  EXPECT_EQ(orientation({lo, lo}, {hi, hi}, {1, 0}), -1);
  EXPECT_EQ(orientation({lo, lo}, {hi, hi}, {7, 7}), 0);
  EXPECT_EQ(in_circle_sign({lo, lo}, {hi, lo}, {hi, hi}, {lo, hi}), 0);
  EXPECT_EQ(in_circle_sign({lo, lo}, {hi, lo}, {hi, hi}, {lo + 1, hi}), 1);
  EXPECT_EQ(in_circle_sign({lo + 1, lo}, {hi, lo}, {hi, hi}, {lo, hi}), -1);
}

TEST(Delaunay, Definition_EqualsAllTrianglesWithEmptyPerturbedCircle) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    const std::size_t n = 3 + seed % 14;
    for (auto points : {testing::random_points(seed, n, 1 << 20), testing::random_points(seed, n, 5),
                        testing::jittered_lattice_points(seed, n, 10, 0)}) {
      points = testing::distinct(points);
      testing::shuffle(seed, points);
      const Triangulation tri = delaunay(points);
      expect_consistent(tri.view());
      EXPECT_EQ(triangles_of(tri.view()), triangles_by_definition(points));
    }
  }
}

TEST(Delaunay, IndependentOfInsertionOrder) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    auto points = testing::distinct(testing::random_points(seed, 3000, 60));
    const auto expected = triangles_of(delaunay(points).view());
    testing::shuffle(seed, points);
    DelaunayBuilder builder;
    builder.insert(std::span(points).first(100));
    builder.insert(std::span(points).subspan(100));
    EXPECT_EQ(triangles_of(builder.extract().view()), expected);
  }
}

TEST(Delaunay, TinyAndCollinearSetsHaveNoTriangles) {
  EXPECT_EQ(delaunay({}).origin.size(), 0U);
  EXPECT_EQ(delaunay(std::vector<LatticePoint>{{1, 2}}).origin.size(), 0U);
  EXPECT_EQ(delaunay(std::vector<LatticePoint>{{1, 2}, {3, 4}}).origin.size(), 0U);
  EXPECT_EQ(delaunay(std::vector<LatticePoint>{{1, 2}, {3, 4}, {5, 6}, {-1, 0}}).origin.size(), 0U);
}

TEST(VertexLinks, AreCounterClockwiseAndComplete) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const auto points = testing::distinct(testing::random_points(seed, 200, seed % 2 ? 20 : 100000));
    const Triangulation owner = delaunay(points);
    const TriangulationView tri = owner.view();
    const VertexLinks links = vertex_links(tri);
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges, hull;
    for (HalfedgeId h{0}; h.value < tri.origin.size(); ++h.value) {
      edges.insert({tri.origin[h].value, tri.target(h).value});
      edges.insert({tri.target(h).value, tri.origin[h].value});
      if (tri.twin[h].is_none()) hull.insert({tri.origin[h].value, tri.target(h).value});
    }
    EXPECT_EQ(links.neighbor.size(), edges.size());
    std::size_t hull_vertices = 0;
    for (VertexId v{0}; v.value < tri.num_vertices(); ++v.value) {
      const auto link = links.of(v);
      for (const VertexId w : link) EXPECT_TRUE(edges.contains({v.value, w.value}));
      for (std::size_t i = 0; i + 1 < link.size(); ++i)
        EXPECT_GT(orientation(points[v.value], points[link[i].value], points[link[i + 1].value]), 0);
      hull_vertices += links.on_hull[v.value];
      if (links.on_hull[v.value]) {
        EXPECT_TRUE(hull.contains({v.value, link.front().value}));
        EXPECT_TRUE(hull.contains({link.back().value, v.value}));
      } else {
        EXPECT_GT(orientation(points[v.value], points[link.back().value], points[link.front().value]), 0);
      }
    }
    EXPECT_EQ(hull_vertices, hull.size());
  }
}

TEST(HilbertKey, VisitsEveryCellOfABlockAndStepsToANeighbour) {
  for (const LatticePoint corner : {LatticePoint{0, 0}, {-64, 0}, {1 << 20, -(1 << 20)}, {-64, -64}}) {
    std::vector<std::pair<std::uint64_t, LatticePoint>> cells;
    for (std::int32_t x = 0; x < 64; ++x)
      for (std::int32_t y = 0; y < 64; ++y) {
        const LatticePoint p{corner.x + x, corner.y + y};
        cells.push_back({hilbert_key(p), p});
      }
    std::sort(cells.begin(), cells.end());
    for (std::size_t i = 0; i + 1 < cells.size(); ++i) {
      EXPECT_EQ(cells[i].first + 1, cells[i + 1].first);
      EXPECT_EQ(
          std::abs(cells[i].second.x - cells[i + 1].second.x) + std::abs(cells[i].second.y - cells[i + 1].second.y), 1);
    }
  }
}

}  // namespace
}  // namespace hydrotin
