#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>
#include <vector>

#include "clouds.h"
#include "hydrotin/measure.h"
#include "hydrotin/polygon_batch.h"
#include "hydrotin/synthetic.h"
#include "order_k_scene.h"

// Components inside polygons: the dynamic program over chains of ties against the linear program, which knows nothing
// of ties, polygon by polygon; with wishes at random, so that many stand where ties end.

namespace hydrotin {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

struct Solved {
  PolygonResult result;
  Triangles triangles;
};

Solved solve(const PolygonProblem& problem, const Objectives& objectives, ComponentMethod method) {
  PolygonOptions options{.objectives = objectives, .method = method};
  options.budget.max_branches = 400;
  PolygonSolver solver(options);
  Solved out;
  out.result = solver.solve(problem, out.triangles);
  return out;
}

double weight(const PolygonProblem& problem, const Triangles& triangles) {
  double sum = 0;
  for (const auto& v : triangles)
    for (std::size_t i = 0; i < 3; ++i) sum += edge_length(problem.position[v[i]], problem.position[v[(i + 1) % 3]]);
  return sum;
}

// Vertices that wish for a lower neighbour and have one over an inner edge, by wish; from the definition.
std::array<int, 3> served_by_wish(const PolygonProblem& problem, const Triangles& triangles) {
  std::set<std::array<std::uint32_t, 2>> sides;
  for (std::size_t t = 0; t < problem.delaunay.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      if (problem.fixed[t] >> i & 1U) {
        const std::uint32_t a = problem.delaunay[t][i], b = problem.delaunay[t][(i + 1) % 3];
        sides.insert({std::min(a, b), std::max(a, b)});
      }
  std::vector<bool> served(problem.position.size(), false);
  for (const auto& v : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = v[i], b = v[(i + 1) % 3];
      if (sides.contains({std::min(a, b), std::max(a, b)})) continue;
      served[is_lower(problem.height[a], problem.position[a], problem.height[b], problem.position[b]) ? b : a] = true;
    }
  std::array<int, 3> out{};
  for (std::size_t v = 0; v < served.size(); ++v) out[problem.wants_lower[v]] += served[v];
  out[0] = 0;
  return out;
}

// Every side of the polygon stands at one triangle, every other edge at one on either side, and the areas add up.
bool is_triangulation(const PolygonProblem& problem, const Triangles& triangles) {
  std::set<std::array<std::uint32_t, 2>> expected, met;
  double area = 0, covered = 0;
  const auto area_of = [&](const std::array<std::uint32_t, 3>& v) {
    return twice_area(problem.position[v[0]], problem.position[v[1]], problem.position[v[2]]);
  };
  for (std::size_t t = 0; t < problem.delaunay.size(); ++t) {
    area += area_of(problem.delaunay[t]);
    for (std::size_t i = 0; i < 3; ++i)
      if (problem.fixed[t] >> i & 1U) expected.insert({problem.delaunay[t][i], problem.delaunay[t][(i + 1) % 3]});
  }
  for (const auto& v : triangles) {
    covered += area_of(v);
    for (std::size_t i = 0; i < 3; ++i)
      if (!met.insert({v[i], v[(i + 1) % 3]}).second) return false;
  }
  for (const auto& side : expected)
    if (met.erase(side) == 0) return false;
  for (const auto& [a, b] : met)
    if (!met.contains({b, a})) return false;
  return covered == area && triangles.size() == problem.delaunay.size();
}

double least_angle(const PolygonProblem& problem, const Triangles& triangles) {
  double worst = -1e300;
  for (const auto& v : triangles)
    worst = std::max(worst, triangle_score(Objective::max_min_angle, problem.position[v[0]], problem.position[v[1]],
                                           problem.position[v[2]]));
  return worst;
}

struct Tally {
  int polygons = 0, components = 0, most = 0, own = 0, undecided = 0;
};

void compare(const PolygonProblem& problem, Tally& tally) {
  const auto served = [&](const Objectives& objectives) {
    const Solved ties = solve(problem, objectives, ComponentMethod::ties);
    const Solved linear = solve(problem, objectives, ComponentMethod::linear_program);
    ASSERT_TRUE(is_triangulation(problem, ties.triangles));
    ASSERT_TRUE(is_triangulation(problem, linear.triangles));
    ASSERT_FALSE(linear.result.fell_back);
    EXPECT_FALSE(ties.result.fell_back);
    const auto by_ties = served_by_wish(problem, ties.triangles), by_linear = served_by_wish(problem, linear.triangles);
    EXPECT_EQ(by_ties[2], static_cast<int>(ties.result.served));
    tally.own += by_ties[2];
    tally.undecided += !ties.result.optimal || !linear.result.optimal;
    if (ties.result.optimal) {
      EXPECT_GE(by_ties[2], by_linear[2]);
    }
    if (!ties.result.optimal || !linear.result.optimal) return;
    EXPECT_EQ(by_ties[2], by_linear[2]);
    // The linear program leaves off where it serves as many of 2, if local minima are all that counts.
    EXPECT_GE(by_ties[1], by_linear[1]);
    if (objectives.size() == 1) return;
    EXPECT_EQ(by_ties[1], by_linear[1]);
    EXPECT_NEAR(weight(problem, ties.triangles), weight(problem, linear.triangles),
                1e-9 * weight(problem, linear.triangles));
  };
  served({Objective::local_minima});
  served({Objective::local_minima, Objective::min_weight});
  const Solved ties = solve(problem, {Objective::min_weight}, ComponentMethod::ties);
  const Solved linear = solve(problem, {Objective::min_weight}, ComponentMethod::linear_program);
  EXPECT_NEAR(weight(problem, ties.triangles), weight(problem, linear.triangles),
              1e-9 * weight(problem, linear.triangles));
  EXPECT_EQ(
      least_angle(problem, solve(problem, {Objective::max_min_angle}, ComponentMethod::ties).triangles),
      least_angle(problem, solve(problem, {Objective::max_min_angle}, ComponentMethod::linear_program).triangles));
  ++tally.polygons;
  tally.components += static_cast<int>(problem.components);
  tally.most = std::max(tally.most, static_cast<int>(problem.components));
}

void compare_all(std::vector<LatticePoint> points, int k, std::uint64_t seed, std::uint32_t most_triangles,
                 Tally& tally) {
  points = testing::distinct(std::move(points));
  testing::shuffle(seed, points);
  auto height = testing::random_heights(seed, points.size(), 1000);
  const testing::OrderKScene scene(std::move(points), k, std::move(height));
  const PolygonSource source{scene.owner.view(), scene.height,    scene.crossings,
                             scene.subdivision,  scene.triangles, scene.candidates};
  PolygonExtractor extractor(source);
  testing::Random random(seed);
  for (std::uint32_t f = 0; f < scene.subdivision.size(); ++f) {
    if (scene.subdivision.components[f] == 0 || scene.subdivision.triangles_of(f).size() > most_triangles) continue;
    SCOPED_TRACE(::testing::Message() << "seed " << seed << " k " << k << " polygon " << f);
    PolygonProblem problem = extractor.extract(f);
    std::vector<std::uint8_t> wishes(problem.position.size());
    for (std::uint8_t& wish : wishes) wish = static_cast<std::uint8_t>(random.below(3));
    problem.wants_lower = wishes;
    compare(problem, tally);
  }
}

void expect(const Tally& tally, int polygons, int most) {
  std::printf("%d polygons, %d components, at most %d in one, %d vertices served, %d undecided\n", tally.polygons,
              tally.components, tally.most, tally.own, tally.undecided);
  EXPECT_GE(tally.polygons, polygons);
  EXPECT_GE(tally.most, most);
  EXPECT_LE(tally.undecided, tally.polygons / 20);
  EXPECT_GT(tally.own, tally.polygons);
}

TEST(TieWays, EqualTheLinearProgramOnRandomPoints) {
  Tally tally;
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    for (const int k : {4, 6, 7}) compare_all(testing::random_points(seed, 80, 1 << 12), k, seed, 120, tally);
  expect(tally, 100, 5);
}

TEST(TieWays, EqualTheLinearProgramOnLattices) {
  Tally tally;
  for (std::uint64_t seed = 0; seed < 40; ++seed)
    for (const int k : {4, 6}) {
      compare_all(testing::jittered_lattice_points(seed, 64, 12, 3), k, seed, 60, tally);
      compare_all(testing::lattice_points(seed, 42, 10), k, seed, 60, tally);
    }
  expect(tally, 60, 4);
}

// Where swaths overlap, points of one lie between the lines of the other, in a row: many components one beside the
// other.
TEST(TieWays, EqualTheLinearProgramOnScanLines) {
  SyntheticOptions options;
  options.kind = SyntheticKind::scanline;
  options.num_points = 90'000;
  const SyntheticTerrain terrain(options);
  LatticeBox box = terrain.box();
  box.max = {box.min.x + 28'500, box.min.y + 4'500};
  box.min.x += 21'500;
  std::vector<LatticePoint> points;
  terrain.points_in(box, [&](std::span<const SyntheticPoint> batch) {
    for (const SyntheticPoint& p : batch) points.push_back({p.x - box.min.x, p.y - box.min.y});
  });
  Tally tally;
  compare_all(points, 4, 1, 400, tally);
  expect(tally, 8, 8);
}

}  // namespace
}  // namespace hydrotin
