#include "linear_program.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "clouds.h"
#include "hydrotin/measure.h"
#include "hydrotin/point_set.h"
#include "hydrotin/polygon_batch.h"
#include "order_k_scene.h"

// The linear program over triangles, looked at from inside: its bound is a certificate for every costs.

namespace hydrotin {
namespace {

// One polygon of a point set with components inside.
testing::OrderKScene scene_of(std::uint64_t seed, int k) {
  auto points = testing::distinct(testing::random_points(seed, 60, 1 << 12));
  auto height = testing::random_heights(seed, points.size(), 1000);
  return {std::move(points), k, std::move(height)};
}

TEST(LinearProgram, DualCertifiesAndAnswersAreTriangulations) {
  int solved = 0, branched = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const testing::OrderKScene scene = scene_of(seed, 6);
    const PolygonSource source{scene.owner.view(), scene.height,    scene.crossings,
                               scene.subdivision,  scene.triangles, scene.candidates};
    PolygonExtractor extractor(source);
    for (std::uint32_t f = 0; f < scene.subdivision.size(); ++f) {
      if (scene.subdivision.components[f] == 0) continue;
      const PolygonProblem& problem = extractor.extract(f);
      PolygonGraph graph;
      graph.build(problem);
      PolygonCosts costs;
      costs.num_slots = 1;
      testing::Random random(seed);
      double area = 0;
      for (std::uint32_t t = 0; t < graph.num_triangles(); ++t) {
        costs.cost.push_back(to_fixed(random.unit()));
        const auto& v = graph.triangle(t);
        if (t < problem.delaunay.size())
          area += twice_area(problem.position[v[0]], problem.position[v[1]], problem.position[v[2]]);
      }
      const auto size = static_cast<std::uint32_t>(problem.delaunay.size());
      const std::vector<std::uint8_t> blocked(graph.num_triangles(), 0);
      const LinearOutcome outcome = solve_linear_program(graph, costs, blocked, size, 200);
      ASSERT_EQ(outcome.triangle.size(), size);
      EXPECT_TRUE(outcome.proven);
      double value = 0, covered = 0;
      for (const std::uint32_t t : outcome.triangle) {
        value += from_fixed(costs.of(t, 0));
        const auto& v = graph.triangle(t);
        covered += twice_area(problem.position[v[0]], problem.position[v[1]], problem.position[v[2]]);
      }
      EXPECT_DOUBLE_EQ(covered, area);
      EXPECT_NEAR(value, outcome.first_bound, 1e-9 * size);
      double delaunay_value = 0;
      for (std::uint32_t t = 0; t < size; ++t) delaunay_value += from_fixed(costs.of(t, 0));
      EXPECT_LE(outcome.first_bound, delaunay_value + 1e-9);
      // Cut off after one program the bound still holds.
      EXPECT_LE(solve_linear_program(graph, costs, blocked, size, 1).first_bound, value + 1e-9 * size);
      ++solved;
      branched += outcome.programs > 1;
      // Without the triangles of the answer there may be no triangulation, but never a better one.
      std::vector<std::uint8_t> without(blocked);
      without[outcome.triangle.front()] = 1;
      const LinearOutcome other = solve_linear_program(graph, costs, without, size, 200);
      EXPECT_TRUE(other.proven);
      if (!other.triangle.empty()) {
        EXPECT_GE(other.first_bound, value - 1e-9 * size);
      }
    }
  }
  std::printf("%d polygons with components, %d branched on\n", solved, branched);
  EXPECT_GE(solved, 40);
}

}  // namespace
}  // namespace hydrotin
