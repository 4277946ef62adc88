#include "hydrotin/orders.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "clouds.h"
#include "hydrotin/useful_edges.h"
#include "oracle/definitions.h"

namespace hydrotin {
namespace {

// Every kind of degenerate set, small.
std::vector<oracle::Points> sets(std::uint64_t seed) {
  std::vector<oracle::Points> out;
  for (auto points : {testing::random_points(seed, 3 + seed % 12, 1 << 20), testing::random_points(seed, 14, 5),
                      testing::lattice_points(seed, 12, 10), testing::random_points(seed, 12, 1 << 30),
                      testing::collinear_points(seed, 6)}) {
    points = testing::distinct(std::move(points));
    testing::shuffle(seed, points);
    out.push_back(std::move(points));
  }
  return out;
}

TEST(Orders, Definition_OfTriangles) {
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (const auto& p : sets(seed))
      for (std::uint32_t a = 0; a < p.size(); ++a)
        for (std::uint32_t b = 0; b < p.size(); ++b)
          for (std::uint32_t c = b + 1; c < p.size(); ++c) {
            if (a == b || a == c) continue;
            const auto order = triangle_order(p, a, b, c);
            ASSERT_EQ(order.has_value(), oracle::side(p[a], p[b], p[c]) != 0);
            if (order) {
              const oracle::Triangle t =
                  oracle::triangle(static_cast<int>(a), static_cast<int>(b), static_cast<int>(c));
              ASSERT_EQ(static_cast<int>(*order), oracle::order_of(p, t));
            }
          }
}

// A circle through both ends with the fewest points inside may be moved until it touches a third point.
TEST(Orders, Definition_OfEdges) {
  for (std::uint64_t seed = 0; seed < 60; ++seed)
    for (const auto& p : sets(seed)) {
      const int n = static_cast<int>(p.size());
      const auto useful = oracle::useful_orders(p, n);
      for (int a = 0; a < n; ++a)
        for (int b = a + 1; b < n; ++b) {
          const auto i = static_cast<std::uint32_t>(a), j = static_cast<std::uint32_t>(b);
          int fewest = n, between = 0;
          for (int c = 0; c < n; ++c) {
            const LatticePoint u = p[i], v = p[j], w = p[static_cast<std::size_t>(c)];
            if (c != a && c != b) between += oracle::on_segment(u, v, w);
            if (oracle::side(u, v, w) != 0) fewest = std::min(fewest, oracle::order_of(p, oracle::triangle(a, b, c)));
          }
          if (fewest == n) fewest = between;  // all on one line
          ASSERT_EQ(static_cast<int>(edge_order(p, i, j)), fewest) << "seed " << seed << " n " << n;
          ASSERT_EQ(edge_order(p, j, i), edge_order(p, i, j));
          const auto order = useful_edge_order(p, i, j);
          const auto found = useful.find({a, b});
          ASSERT_EQ(order.has_value(), found != useful.end());
          if (!order) continue;
          EXPECT_EQ(static_cast<int>(*order), found->second);
          EXPECT_EQ(order, useful_edge_order(p, j, i));
          EXPECT_GE(*order, edge_order(p, i, j));
        }
    }
}

TEST(Orders, UsefulEdgesHaveTheOrdersOfSingleEdges) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    auto points = testing::distinct(testing::random_points(seed, 300, seed % 2 ? 30 : 1 << 20));
    const Triangulation owner = delaunay(points);
    const TriangulationView tri = owner.view();
    const UsefulEdges edges = useful_edges(tri, vertex_links(tri), 5);
    for (std::uint32_t e = 0; e < edges.size(); ++e)
      ASSERT_EQ(useful_edge_order(owner.position, edges.a(tri, e).value, edges.b[e].value), edges.useful_order(e));
    for (HalfedgeId h{0}; h.value < tri.origin.size(); ++h.value) {
      ASSERT_EQ(edge_order(owner.position, tri.origin[h].value, tri.target(h).value), 0U);
      ASSERT_EQ(useful_edge_order(owner.position, tri.origin[h].value, tri.target(h).value), 0U);
    }
  }
}

}  // namespace
}  // namespace hydrotin
