#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <vector>

#include "clouds.h"
#include "hydrotin/hilbert.h"
#include "hydrotin/point_set.h"
#include "hydrotin/polygon.h"
#include "hydrotin/predicates.h"
#include "oracle/definitions.h"

namespace hydrotin {
namespace {

using oracle::Edge;
using oracle::Triangle;
using oracle::Triangles;

double weight(const oracle::Points& p, const Triangles& triangles) {
  double sum = 0;
  for (const auto& [a, b] : oracle::edges_of(triangles)) {
    const LatticePoint u = p[static_cast<std::size_t>(a)], v = p[static_cast<std::size_t>(b)];
    sum += std::hypot(static_cast<double>(u.x) - v.x, static_cast<double>(u.y) - v.y);
  }
  return sum;
}

int minima(const oracle::Points& p, const std::vector<std::int32_t>& z, const Triangles& triangles) {
  std::set<int> saved;
  for (const auto& [a, b] : oracle::edges_of(triangles)) {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    saved.insert(std::tuple(z[i], p[i].x, p[i].y) < std::tuple(z[j], p[j].x, p[j].y) ? b : a);
  }
  return static_cast<int>(p.size() - saved.size());
}

Triangles as_set(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  Triangles out;
  for (const auto& t : triangles)
    EXPECT_TRUE(
        out.insert(oracle::triangle(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]))).second);
  return out;
}

std::vector<oracle::Points> small_clouds(std::uint64_t seed, std::size_t n) {
  std::vector<oracle::Points> out;
  for (auto cloud : {testing::random_points(seed, n, 1 << 20), testing::random_points(seed, n, 5),
                     testing::lattice_points(seed, n, 10), testing::random_points(seed, n, 1 << 30)}) {
    cloud = testing::distinct(std::move(cloud));
    testing::shuffle(seed, cloud);
    out.push_back(std::move(cloud));
  }
  return out;
}

TEST(Triangulate, Definition_EqualsTheBestOfAllOrderKTriangulations) {
  int instances = 0, missed = 0;
  for (std::uint64_t seed = 0; seed < 120; ++seed)
    for (const auto& points : small_clouds(seed, 4 + seed % 6))
      for (int k = 0; k <= 5; ++k) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " n " << points.size() << " k " << k);
        const oracle::AllTriangulations all(points, k);
        const auto z = testing::random_heights(seed, points.size(), seed % 2 ? 3 : 1000);
        if (all.all().empty()) {
          EXPECT_TRUE(triangulate(points, z, k, Objective::min_weight).triangles.empty());
          continue;
        }
        ++instances;
        double least_weight = 1e300;
        int least_minima = 1000;
        for (const auto& t : all.all()) {
          least_weight = std::min(least_weight, weight(points, t));
          least_minima = std::min(least_minima, minima(points, z, t));
        }
        const auto by_weight = triangulate(points, z, k, Objective::min_weight);
        EXPECT_NEAR(by_weight.value(), least_weight, 1e-9 * least_weight);
        EXPECT_NEAR(by_weight.value(), weight(points, as_set(by_weight.triangles)), 1e-9 * least_weight);
        EXPECT_TRUE(by_weight.optimal);
        const auto by_minima = triangulate(points, z, k, Objective::local_minima);
        EXPECT_EQ(by_minima.value(), minima(points, z, as_set(by_minima.triangles)));
        EXPECT_LE(by_minima.bound, least_minima);
        EXPECT_GE(by_minima.value(), least_minima);
        EXPECT_EQ(by_minima.optimal, by_minima.value() == by_minima.bound);
        missed += by_minima.value() > least_minima;
        for (const auto objective : {Objective::delaunay, Objective::min_weight, Objective::local_minima})
          EXPECT_NE(
              std::find(all.all().begin(), all.all().end(), as_set(triangulate(points, z, k, objective).triangles)),
              all.all().end());
      }
  std::printf("local minima above the least possible number in %d of %d instances\n", missed, instances);
  EXPECT_LE(missed * 50, instances);
}

// Klincsek's recursion over one polygon with components, written over all order-k triangulations: larger sets whose
// polygons have components inside.
TEST(Triangulate, ComponentsInsidePolygonsAreTied) {
  std::uint32_t with_components = 0;
  for (std::uint64_t seed = 0; seed < 400 && with_components < 60; ++seed) {
    // A ring around a few points: high orders leave the middle loose.
    auto points = testing::distinct(testing::random_points(seed, 9, 60));
    testing::shuffle(seed, points);
    for (int k = 3; k <= 6; ++k) {
      const auto z = testing::random_heights(seed, points.size(), 1000);
      const auto by_weight = triangulate(points, z, k, Objective::min_weight);
      if (by_weight.components == 0) continue;
      ++with_components;
      SCOPED_TRACE(::testing::Message() << "seed " << seed << " k " << k);
      const oracle::AllTriangulations all(points, k);
      double least = 1e300;
      for (const auto& t : all.all()) least = std::min(least, weight(points, t));
      EXPECT_NEAR(by_weight.value(), least, 1e-9 * least);
    }
  }
  EXPECT_GE(with_components, 30U);
}

using CoordinateTriangles = std::set<std::array<LatticePoint, 3>>;

CoordinateTriangles as_coordinates(const oracle::Points& p, const PointSetTriangulation& t) {
  CoordinateTriangles out;
  for (const auto& v : t.triangles) {
    std::array<LatticePoint, 3> key{p[v[0]], p[v[1]], p[v[2]]};
    std::sort(key.begin(), key.end());
    out.insert(key);
  }
  return out;
}

TEST(Triangulate, IndependentOfTheOrderOfPoints) {
  for (std::uint64_t seed = 0; seed < 8; ++seed)
    for (int k = 0; k <= 6; k += 2)
      for (const auto objective : {Objective::delaunay, Objective::min_weight, Objective::local_minima}) {
        auto points = testing::distinct(testing::random_points(seed, 600, seed % 2 ? 40 : 1 << 20));
        const auto heights = [](const oracle::Points& p) {
          std::vector<std::int32_t> z;
          for (const auto& q : p) z.push_back(static_cast<std::int32_t>((q.x * 7LL + q.y * 13LL) % 11));
          return z;
        };
        const auto expected = as_coordinates(points, triangulate(points, heights(points), k, objective));
        testing::shuffle(seed, points);
        EXPECT_TRUE(as_coordinates(points, triangulate(points, heights(points), k, objective)) == expected)
            << "seed " << seed << " k " << k << " " << name(objective);
      }
}

TEST(Triangulate, LocalMinimaComeCloseToTheBound) {
  for (int k = 1; k <= 5; ++k) {
    auto points = testing::distinct(testing::random_points(5, 5000, 1 << 20));
    const auto z = testing::random_heights(7, points.size(), 100000);
    const auto before = triangulate(points, z, k, Objective::delaunay);
    const auto after = triangulate(points, z, k, Objective::local_minima);
    std::printf("k %d: minima %u -> %.0f, bound %.0f, polygons %u, components %u, fallbacks %u\n", k,
                count_minima(points, z, before.triangles), after.value(), after.bound, after.polygons, after.components,
                after.fallbacks);
    EXPECT_LE(after.value(), 1.02 * after.bound);
    EXPECT_LT(after.value(), count_minima(points, z, before.triangles));
  }
}

TEST(Triangulate, TinySets) {
  const std::vector<std::int32_t> z{0, 0, 0, 0};
  for (const auto objective : {Objective::delaunay, Objective::min_weight, Objective::local_minima}) {
    EXPECT_TRUE(triangulate({}, {}, 2, objective).triangles.empty());
    const std::vector<LatticePoint> line{{0, 0}, {1, 1}, {2, 2}};
    EXPECT_TRUE(triangulate(line, std::span(z).first(3), 2, objective).triangles.empty());
    const std::vector<LatticePoint> three{{0, 0}, {1, 1}, {2, 1}};
    EXPECT_EQ(triangulate(three, std::span(z).first(3), 2, objective).triangles.size(), 1U);
  }
}

}  // namespace
}  // namespace hydrotin
