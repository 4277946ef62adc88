#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "clouds.h"
#include "hydrotin/hilbert.h"
#include "hydrotin/order_k_triangles.h"
#include "hydrotin/predicates.h"
#include "hydrotin/subdivision.h"
#include "hydrotin/useful_edges.h"
#include "oracle/definitions.h"

namespace hydrotin {
namespace {

using oracle::Edge;
using oracle::Triangle;
using testing::Random;

struct Analysis {
  std::map<Edge, int> useful;  // Delaunay edges with order 0
  std::map<Triangle, int> triangles;
  std::set<Edge> fixed;
  std::size_t polygons = 0, components = 0;
};

Edge edge(VertexId a, VertexId b) {
  return oracle::edge(static_cast<int>(a.value), static_cast<int>(b.value));
}

Analysis analyse(const oracle::Points& points, int k) {
  const Triangulation owner = delaunay(points);
  const TriangulationView tri = owner.view();
  const VertexLinks links = vertex_links(tri);
  const UsefulEdges edges = useful_edges(tri, links, k);
  const OrderKTriangles triangles = order_k_triangles(tri, edges);
  const auto crossed = find_crossings(tri, edges).crossed;
  const Subdivision subdivision = subdivide(tri, crossed);
  Analysis out;
  for (HalfedgeId h{0}; h.value < tri.origin.size(); ++h.value) {
    out.useful[edge(tri.origin[h], tri.target(h))] = 0;
    if (!crossed[h.value]) out.fixed.insert(edge(tri.origin[h], tri.target(h)));
    if (h.value % 3 == 0)
      out.triangles[oracle::triangle(static_cast<int>(tri.origin[h].value), static_cast<int>(tri.target(h).value),
                                     static_cast<int>(tri.apex(h).value))] = 0;
  }
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const VertexId a = edges.a(tri, e);
    EXPECT_LT(points[a.value], points[edges.b[e].value]);
    EXPECT_EQ(edges.find(a, edges.b[e]), e);
    EXPECT_TRUE(out.useful.insert({edge(a, edges.b[e]), edges.useful_order(e)}).second);
  }
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& v = triangles.vertices[t];
    EXPECT_GT(orientation(points[v[0].value], points[v[1].value], points[v[2].value]), 0);
    const Triangle key =
        oracle::triangle(static_cast<int>(v[0].value), static_cast<int>(v[1].value), static_cast<int>(v[2].value));
    EXPECT_TRUE(out.triangles.insert({key, triangles.order[t]}).second);
  }
  out.polygons = subdivision.size();
  for (const auto c : subdivision.components) out.components += c;
  return out;
}

std::vector<oracle::Points> small_clouds(std::uint64_t seed, std::size_t n) {
  std::vector<oracle::Points> out;
  for (auto cloud : {testing::random_points(seed, n, 1 << 20), testing::random_points(seed, n, 4),
                     testing::random_points(seed, n, 7), testing::lattice_points(seed, n, 10),
                     testing::random_points(seed, n, 1 << 30)}) {
    cloud = testing::distinct(std::move(cloud));
    testing::shuffle(seed, cloud);
    out.push_back(std::move(cloud));
  }
  return out;
}

TEST(OrderK, Definition_EqualsTheSetOfAllOrderKTriangulations) {
  for (std::uint64_t seed = 0; seed < 60; ++seed)
    for (const auto& points : small_clouds(seed, 4 + seed % 5))
      for (int k = 0; k <= 4; ++k) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " n " << points.size() << " k " << k);
        const oracle::AllTriangulations all(points, k);
        if (all.all().empty()) continue;  // collinear
        std::set<Edge> useful, fixed = oracle::edges_of(all.all().front());
        std::set<Triangle> triangles;
        for (const auto& triangulation : all.all()) {
          const auto edges = oracle::edges_of(triangulation);
          useful.insert(edges.begin(), edges.end());
          std::set<Edge> both;
          std::set_intersection(fixed.begin(), fixed.end(), edges.begin(), edges.end(),
                                std::inserter(both, both.end()));
          fixed = both;
          triangles.insert(triangulation.begin(), triangulation.end());
        }
        const Analysis found = analyse(points, k);
        std::set<Edge> found_useful;
        for (const auto& [e, order] : found.useful) found_useful.insert(e);
        EXPECT_EQ(found_useful, useful);
        EXPECT_EQ(found.fixed, fixed);
        for (const Triangle& t : triangles) EXPECT_TRUE(found.triangles.contains(t));
      }
}

TEST(OrderK, Definition_OrdersOfEdgesAndTriangles) {
  for (std::uint64_t seed = 0; seed < 12; ++seed)
    for (const auto& points : small_clouds(seed, 14 + seed))
      for (const int k : {1, 2, 3, 5, 8}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " n " << points.size() << " k " << k);
        const Analysis found = analyse(points, k);
        if (found.triangles.empty()) continue;
        EXPECT_EQ(found.useful, oracle::useful_orders(points, k));
        std::map<Triangle, int> expected;
        for (const auto& [t, order] : oracle::empty_triangles(points))
          if (order <= k && found.useful.contains({t[0], t[1]}) && found.useful.contains({t[0], t[2]}) &&
              found.useful.contains({t[1], t[2]}))
            expected[t] = order;
        EXPECT_EQ(found.triangles, expected);
        for (const Edge& e : found.fixed)
          for (const auto& [f, order] : found.useful) {
            const auto at = [&](int i) { return points[static_cast<std::size_t>(i)]; };
            EXPECT_FALSE(oracle::cross(at(e.first), at(e.second), at(f.first), at(f.second)));
          }
      }
}

TEST(OrderK, UsefulOfOrderKImpliesUsefulOfOrderKPlusOne) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const auto points = testing::distinct(testing::random_points(seed, 400, seed % 2 ? 30 : 100000));
    std::map<Edge, int> before;
    std::set<Edge> fixed_before;
    for (int k = 0; k <= 8; ++k) {
      const Analysis now = analyse(points, k);
      for (const auto& [e, order] : before) {
        ASSERT_TRUE(now.useful.contains(e));
        EXPECT_EQ(now.useful.at(e), order);
      }
      for (const Edge& e : now.fixed) EXPECT_TRUE(k == 0 || fixed_before.contains(e));
      before = now.useful;
      fixed_before = now.fixed;
    }
  }
}

// Flood over vertices that are joined by fixed edges or share the hull: what is not reached is a component.
std::size_t components_by_flood(const oracle::Points& points, const Analysis& a) {
  std::vector<int> root(points.size());
  for (std::size_t i = 0; i < root.size(); ++i) root[i] = static_cast<int>(i);
  const auto find = [&](int i) {
    while (root[static_cast<std::size_t>(i)] != i) i = root[static_cast<std::size_t>(i)];
    return i;
  };
  for (const auto& [u, v] : a.fixed) root[static_cast<std::size_t>(find(u))] = find(v);
  std::set<int> roots;
  for (int i = 0; i < static_cast<int>(points.size()); ++i) roots.insert(find(i));
  return roots.size() - 1;
}

TEST(Subdivision, ComponentsEqualTheFloodOverFixedEdges) {
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    for (const int k : {0, 1, 3, 5, 7, 9}) {
      SCOPED_TRACE(::testing::Message() << seed << " " << k);
      const auto points = testing::distinct(testing::random_points(seed, 300, seed % 3 == 0 ? 20 : 100000));
      const Analysis a = analyse(points, k);
      EXPECT_EQ(a.components, components_by_flood(points, a));
      EXPECT_EQ(a.polygons == a.triangles.size(), k == 0);
    }
}

TEST(OrderK, IndependentOfVertexNumbersAndPosition) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    auto points = testing::distinct(testing::random_points(seed, 500, 40));
    const auto edges_as_points = [](const oracle::Points& p, const Analysis& a, LatticePoint shift) {
      std::map<std::pair<LatticePoint, LatticePoint>, int> out;
      for (const auto& [e, order] : a.useful) {
        LatticePoint u = p[static_cast<std::size_t>(e.first)], v = p[static_cast<std::size_t>(e.second)];
        u = {u.x - shift.x, u.y - shift.y};
        v = {v.x - shift.x, v.y - shift.y};
        out[std::minmax(u, v)] = order;
      }
      return out;
    };
    const auto expected = edges_as_points(points, analyse(points, 4), {0, 0});
    testing::shuffle(seed, points);
    EXPECT_EQ(edges_as_points(points, analyse(points, 4), {0, 0}), expected);
    const LatticePoint shift{-2000000000, 1999999000};
    for (auto& p : points) p = {p.x + shift.x, p.y + shift.y};
    EXPECT_EQ(edges_as_points(points, analyse(points, 4), shift), expected);
  }
}

}  // namespace
}  // namespace hydrotin
