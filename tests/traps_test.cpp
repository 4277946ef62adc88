#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "clouds.h"
#include "hydrotin/orders.h"
#include "hydrotin/point_set.h"
#include "hydrotin/predicates.h"
#include "oracle/measures.h"
#include "order_k_scene.h"

// One test for each place where an obvious reading of the theory goes wrong. All of them search seeded sets for
// instances in which the trap is open, and count them, so that none passes for want of a case.

namespace hydrotin {
namespace {

using Scene = testing::OrderKScene;

// The sides of the cavity that a useful edge leaves, as vertices: a vertex may stand there twice.
std::vector<std::uint32_t> cavity_vertices(const Scene& scene, std::uint32_t e) {
  const TriangulationView tri = scene.tri();
  const LatticePoint a = tri.position[scene.edges.a(scene.tri(), e)], b = tri.position[scene.edges.b[e]];
  std::vector<std::uint32_t> out;
  HalfedgeId h = scene.edges.entry[e];
  out.push_back(tri.origin[h].value);
  out.push_back(tri.target(h).value);
  for (;;) {
    const HalfedgeId beyond = tri.twin[h];
    const VertexId apex = tri.apex(beyond);
    if (apex == scene.edges.b[e]) return out;
    out.push_back(apex.value);
    h = orientation(a, b, tri.position[apex]) > 0 ? next(beyond) : previous(beyond);
  }
}

TEST(Traps, CavityOfAUsefulEdgeMayBeOnlyWeaklySimple) {
  // Of a few hundred small sets some have an edge along which a vertex is met before and after another on its side.
  int twice = 0;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    const int k = 4 + static_cast<int>(seed % 4);
    const Scene scene(testing::distinct(testing::random_points(seed, 6 + seed % 6, seed % 2 ? 16 : 64)), k);
    const auto expected = oracle::useful_orders(scene.points, k);
    for (std::uint32_t e = 0; e < scene.edges.size(); ++e) {
      auto vertices = cavity_vertices(scene, e);
      std::sort(vertices.begin(), vertices.end());
      twice += std::adjacent_find(vertices.begin(), vertices.end()) != vertices.end();
      const int a = static_cast<int>(scene.edges.a(scene.tri(), e).value), b = static_cast<int>(scene.edges.b[e].value);
      EXPECT_EQ(expected.at(oracle::edge(a, b)), scene.edges.useful_order(e));
    }
    std::size_t beyond_delaunay = 0;
    for (const auto& [edge, order] : expected) beyond_delaunay += order > 0;
    EXPECT_EQ(beyond_delaunay, scene.edges.size());
  }
  EXPECT_GE(twice, 5);
}

TEST(Traps, PointsOnTheSegmentEndAnEdgeButNotTheSearch) {
  // Every lattice direction beyond the first point is blocked, others further out are not.
  const Scene small(testing::distinct(testing::lattice_points(1, 36, 10)), 5);
  const auto expected = oracle::useful_orders(small.points, 5);
  std::size_t beyond_delaunay = 0;
  for (const auto& [edge, order] : expected) beyond_delaunay += order > 0;
  EXPECT_GE(beyond_delaunay, 50U);
  EXPECT_EQ(beyond_delaunay, small.edges.size());
  for (std::uint32_t e = 0; e < small.edges.size(); ++e) {
    const int a = static_cast<int>(small.edges.a(small.tri(), e).value), b = static_cast<int>(small.edges.b[e].value);
    EXPECT_EQ(expected.at(oracle::edge(a, b)), small.edges.useful_order(e));
  }
  const Scene scene(testing::distinct(testing::lattice_points(1, 400, 10)), 5);
  int oblique = 0;
  for (std::uint32_t e = 0; e < scene.edges.size(); ++e) {
    const LatticePoint a = scene.tri().position[scene.edges.a(scene.tri(), e)],
                       b = scene.tri().position[scene.edges.b[e]];
    for (const LatticePoint p : scene.points) ASSERT_FALSE(oracle::on_segment(a, b, p));
    oblique += std::abs(a.x - b.x) > 10 || std::abs(a.y - b.y) > 10;
  }
  EXPECT_GT(oblique, 0);
}

TEST(Traps, SmallOrderDoesNotMakeATriangleEmpty) {
  int filled = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const Scene scene(testing::distinct(testing::random_points(seed, 12, 1 << 10)), 3);
    const auto n = static_cast<std::uint32_t>(scene.points.size());
    const auto empty = oracle::empty_triangles(scene.points);
    for (std::uint32_t a = 0; a < n; ++a)
      for (std::uint32_t b = a + 1; b < n; ++b)
        for (std::uint32_t c = b + 1; c < n; ++c) {
          const auto order = triangle_order(scene.points, a, b, c);
          filled += order && *order <= 3 &&
                    !empty.contains(oracle::triangle(static_cast<int>(a), static_cast<int>(b), static_cast<int>(c)));
        }
    for (const auto& v : scene.triangles.vertices)
      EXPECT_TRUE(empty.contains(
          oracle::triangle(static_cast<int>(v[0].value), static_cast<int>(v[1].value), static_cast<int>(v[2].value))));
  }
  EXPECT_GT(filled, 10);
}

TEST(Traps, AFixedEdgeMayHaveOnePolygonOnBothSides) {
  int slits = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Scene scene(testing::distinct(testing::random_points(seed, 400, 1 << 20)), 6);
    for (HalfedgeId h{0}; h.value < scene.tri().origin.size(); ++h.value) {
      const HalfedgeId twin = scene.tri().twin[h];
      if (twin.is_none() || scene.crossings.crossed[h.value]) continue;
      slits += scene.subdivision.polygon[triangle_of(h).value] == scene.subdivision.polygon[triangle_of(twin).value];
    }
    const auto z = testing::random_heights(seed, scene.points.size(), 1000);
    const auto result = triangulate(scene.points, z, 6, Objective::min_weight);
    EXPECT_TRUE(result.optimal);
    EXPECT_EQ(result.triangles.size(), scene.tri().num_triangles());
  }
  EXPECT_GT(slits, 10);
}

TEST(Traps, CompatibleUsefulEdgesNeedNotFitIntoOneTriangulation) {
  int traps = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const auto points = testing::distinct(testing::random_points(seed, 8, 1 << 10));
    const int k = 1 + static_cast<int>(seed % 3);
    const oracle::AllTriangulations all(points, k);
    if (all.all().empty()) continue;
    const auto useful = oracle::useful_orders(points, k);
    for (auto e = useful.begin(); e != useful.end(); ++e)
      for (auto f = std::next(e); f != useful.end(); ++f) {
        const auto at = [&](int i) { return points[static_cast<std::size_t>(i)]; };
        if (oracle::cross(at(e->first.first), at(e->first.second), at(f->first.first), at(f->first.second))) continue;
        traps += std::none_of(all.all().begin(), all.all().end(), [&](const oracle::Triangles& t) {
          const auto edges = oracle::edges_of(t);
          return edges.contains(e->first) && edges.contains(f->first);
        });
      }
    const auto z = testing::random_heights(seed, points.size(), 1000);
    oracle::Triangles found;
    for (const auto& t : triangulate(points, z, k, Objective::min_weight).triangles)
      found.insert(oracle::triangle(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])));
    EXPECT_NE(std::find(all.all().begin(), all.all().end(), found), all.all().end());
  }
  EXPECT_GT(traps, 0) << "pairs of useful edges that no order-k triangulation has together";
}

TEST(Traps, AHugePolygonNeedsNoDeepStack) {
  // At order 4 the tie rule joins the squares of a lattice to rows; one polygon at order 6.
  const auto points = testing::distinct(testing::lattice_points(3, 90'000, 10));
  const auto z = testing::random_heights(3, points.size(), 9);
  for (const int k : {4, 6, 8}) {
    const auto result = triangulate(points, z, k, Objective::local_minima);
    EXPECT_GE(result.max_polygon, k == 4 ? 200U : 100'000U);
    EXPECT_LE(result.value(), count_minima(points, z, triangulate(points, z, 0, Objective::delaunay).triangles));
  }
}

TEST(Traps, LargeCoordinatesAreNeverRounded) {
  // Cocircular and nearly cocircular points at the ends of 32 bits.
  const std::int32_t far = 2'000'000'000;
  std::vector<LatticePoint> points{{-far, -far}, {far, -far},   {far, far}, {-far, far},
                                   {0, far + 1}, {0, -far - 1}, {7, 11}};
  for (int k = 0; k <= 3; ++k) {
    const oracle::AllTriangulations all(points, k);
    const auto result = triangulate(points, std::vector<std::int32_t>(points.size(), 0), k, Objective::min_weight);
    oracle::Triangles found;
    for (const auto& t : result.triangles)
      found.insert(oracle::triangle(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])));
    EXPECT_NE(std::find(all.all().begin(), all.all().end(), found), all.all().end()) << k;
  }
}

TEST(Traps, CollinearPointsHaveNoTriangle) {
  const auto points = testing::distinct(testing::collinear_points(1, 50));
  const std::vector<std::int32_t> z(points.size(), 0);
  for (const std::string_view key : kObjectiveNames) {
    const auto result = triangulate(points, z, 3, *objective_named(key));
    EXPECT_TRUE(result.triangles.empty()) << key;
    EXPECT_FALSE(result.optimal);
  }
}

TEST(Traps, EqualValuesAreDecidedByPlaceNotByNumber) {
  // A lattice with equal heights: every triangulation of its squares has the same value.
  auto points = testing::distinct(testing::lattice_points(5, 100, 10));
  const std::vector<std::int32_t> z(points.size(), 0);
  const auto coordinates = [&] {
    std::set<std::array<LatticePoint, 3>> out;
    for (const auto& t : triangulate(points, z, 3, Objective::min_weight).triangles) {
      std::array<LatticePoint, 3> corners{points[t[0]], points[t[1]], points[t[2]]};
      std::sort(corners.begin(), corners.end());
      out.insert(corners);
    }
    return out;
  };
  const auto expected = coordinates();
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    testing::shuffle(seed, points);
    EXPECT_TRUE(coordinates() == expected);
  }
}

}  // namespace
}  // namespace hydrotin
