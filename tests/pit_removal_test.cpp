#include "hydrotin/pit_removal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "grid_terrain.h"
#include "hydrotin/lake_bound.h"
#include "hydrotin/lifting.h"
#include "oracle/removal_oracle.h"
#include "pit_sample.h"

namespace hydrotin {
namespace {

using testing::cost_of;
using testing::GridTerrain;
using testing::kMeasures;
using testing::kMethods;
using testing::make_grid;
using testing::make_outlet_terrain;
using testing::OutletTerrain;
using testing::Random;
using testing::renumber;
using testing::Renumbered;
using testing::Sample;
using testing::sample_of;

TEST(PitRemoval, Figure6_9_LiftingCosts14BreachingElevenBothNine) {
  // 1 next to 5 and 10, 10 next to 3, 3 next to the lowest.
  const Sample s = sample_of({1, 5, 10, 3, 0}, {{0, 1}, {0, 2}, {1, 2}, {2, 3}, {3, 4}}, {4});
  EXPECT_EQ(s.remove(RemovalMethod::lift).cost, 14);
  EXPECT_EQ(s.remove(RemovalMethod::breach).cost, 11);
  EXPECT_TRUE(s.remove(RemovalMethod::breach).is_optimal);
  EXPECT_EQ(s.remove(RemovalMethod::greedy_breach).cost, 11);
  const Removal both = s.remove(RemovalMethod::least_change);
  EXPECT_EQ(both.cost, 9);
  EXPECT_TRUE(both.is_optimal);
}

// Figure 6.6: each of m pits has a way out of its own of cost 10; all share one of cost 11.
TEST(PitRemoval, Figure6_6_TheStarIsBreachedThroughItsCenter) {
  for (const std::uint32_t m : {2u, 3u, 10u, 40u}) {
    std::vector<std::int32_t> height{11, -1};
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges{{0, 1}};
    std::vector<std::uint32_t> outlets{1};
    for (std::uint32_t i = 0; i < m; ++i) {
      const auto pit = static_cast<std::uint32_t>(height.size());
      height.insert(height.end(), {0, 10, -1});
      edges.insert(edges.end(), {{pit, 0}, {pit, pit + 1}, {pit + 1, pit + 2}});
      outlets.push_back(pit + 2);
    }
    const Sample s = sample_of(height, edges, outlets);
    EXPECT_EQ(s.remove(RemovalMethod::greedy_breach).cost, 11) << m;
    EXPECT_EQ(s.remove(RemovalMethod::lift).cost, 10 * m);
    EXPECT_LE(s.remove(RemovalMethod::least_change).cost, 10 * m);
  }
}

// Figure 6.5 for K4: a connected vertex cover of it has three vertices.
TEST(PitRemoval, Figure6_5_TheGadgetOfK4CostsThree) {
  std::vector<std::int32_t> height(4, 1);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::uint32_t a = 0; a < 4; ++a)
    for (std::uint32_t b = a + 1; b < 4; ++b) {
      const auto middle = static_cast<std::uint32_t>(height.size());
      height.push_back(middle == 4 ? -1 : 0);
      edges.insert(edges.end(), {{a, middle}, {b, middle}});
    }
  const Sample small = sample_of(height, edges, {4});
  EXPECT_EQ(oracle::least_costs(small.around, small.height, small.is_outlet, small.weight).lowering[0], 3);
  // Vertices of infinite height on all edges that triangulate the faces.
  for (std::uint32_t a = 4; a < 10; ++a)
    for (std::uint32_t b = a + 1; b < 10; ++b) {
      const auto middle = static_cast<std::uint32_t>(height.size());
      height.push_back(1000000);
      edges.insert(edges.end(), {{a, middle}, {b, middle}});
    }
  const Sample s = sample_of(height, edges, {4});
  EXPECT_EQ(s.remove(RemovalMethod::greedy_breach).cost, 3);
  EXPECT_EQ(s.remove(RemovalMethod::breach).cost, 3);
  EXPECT_EQ(s.remove(RemovalMethod::least_change).cost, 3);
}

Sample tiny_sample(std::uint64_t seed) {
  Random random(seed);
  GridTerrain grid = make_grid(seed, 3, 2 + random.below(2), 10, random.below(2) == 0 ? 0 : 3);
  grid.height = testing::random_heights(seed, grid.num_vertices(), grid.num_vertices() > 6 ? 4 : 6);
  std::vector<std::uint8_t> is_outlet(grid.num_vertices(), 0);
  const std::int32_t lowest = *std::min_element(grid.height.begin(), grid.height.end());
  switch (random.below(3)) {
    case 0:
      is_outlet[lowest_vertex(grid.height, grid.position)] = 1;
      break;
    case 1:  // several global minima
      for (std::uint32_t v = 0; v < is_outlet.size(); ++v) is_outlet[v] = grid.height[v] == lowest;
      break;
    default:
      is_outlet[random.below(grid.num_vertices())] = 1;
      break;
  }
  return sample_of(grid, is_outlet);
}

TEST(PitRemoval, NeverBeatsTheBestOfAllAndBoundsHold) {
  std::size_t num_pitted = 0, num_joint_optima = 0, num_breach_optima = 0, num_proven = 0, num_met_by_lakes = 0;
  std::size_t num_breaches_proven = 0, num_breaches = 0;
  for (std::uint64_t seed = 0; seed < 250; ++seed) {
    SCOPED_TRACE(seed);
    const Sample s = tiny_sample(seed);
    const auto best = oracle::least_costs(s.around, s.height, s.is_outlet, s.weight);
    if (best.joint[0] == 0) continue;
    ++num_pitted;
    for (std::size_t i = 0; i < 4; ++i) {
      SCOPED_TRACE(i);
      const Removal both = s.remove(RemovalMethod::least_change, kMeasures[i], true);
      EXPECT_GE(both.cost, best.joint[i]);
      EXPECT_LE(both.bound, best.joint[i]);
      const std::int64_t of_lakes = sum_of_lake_bounds(s.view(kMeasures[i]), both.components.level, kMeasures[i]);
      EXPECT_LE(of_lakes, kBoundShares * best.joint[i]);
      EXPECT_EQ(of_lakes > 0, kMeasures[i] != ChangeMeasure::max);
      num_met_by_lakes += of_lakes == kBoundShares * best.joint[i];
      EXPECT_GT(both.bound, 0);
      EXPECT_EQ(both.is_optimal, both.cost == both.bound);
      if (kMeasures[i] == ChangeMeasure::max) {
        EXPECT_EQ(both.cost, best.joint[i]);
        EXPECT_TRUE(both.is_optimal);
      }
      num_joint_optima += both.cost == best.joint[i];
      num_proven += both.is_optimal;
      for (const RemovalMethod method : {RemovalMethod::breach, RemovalMethod::greedy_breach}) {
        const Removal breach = s.remove(method, kMeasures[i]);
        EXPECT_GE(breach.cost, both.cost);
        EXPECT_EQ(breach.num_unbreached == 0, best.lowering[i] != std::numeric_limits<std::int64_t>::max());
        if (breach.num_unbreached > 0) continue;
        EXPECT_GE(breach.cost, best.lowering[i]);
        EXPECT_LE(breach.bound, best.lowering[i]);
        num_breach_optima += breach.cost == best.lowering[i];
        ++num_breaches;
        num_breaches_proven += breach.is_optimal;
        if (breach.num_pits == 1) {
          EXPECT_EQ(breach.cost, best.lowering[i]);  // Theorem 6.2
        }
        if (kMeasures[i] == ChangeMeasure::max && method == RemovalMethod::breach) {
          EXPECT_EQ(breach.cost, best.lowering[i]);  // Section 6.2.5: merging is optimal
        }
      }
    }
  }
  EXPECT_GT(num_pitted, 120u);
  EXPECT_GT(num_met_by_lakes, num_pitted);
  RecordProperty("pitted", static_cast<int>(num_pitted));
  RecordProperty("joint_optima_of_4", static_cast<int>(num_joint_optima));
  RecordProperty("proven", static_cast<int>(num_proven));
  EXPECT_GT(num_joint_optima, 4 * num_pitted * 9 / 10);
  EXPECT_GT(num_proven, 4 * num_pitted * 9 / 10);
  EXPECT_GT(num_breaches_proven, num_breaches * 9 / 10);
}

TEST(PitRemoval, Algorithm6_1_IsWithin2LnMOfTheOptimum) {
  std::size_t num_several = 0, num_optima = 0, num_all = 0;
  for (std::uint64_t seed = 1000; seed < 1500; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    GridTerrain grid = make_grid(seed, 3, 3, 10, 0);
    grid.height = testing::random_heights(seed, 9, 4);
    std::vector<std::uint8_t> is_outlet(9, 0);
    is_outlet[lowest_vertex(grid.height, grid.position)] = 1;
    const Sample s = sample_of(grid, is_outlet);
    const auto best = oracle::least_costs(s.around, s.height, s.is_outlet, s.weight);
    if (best.lowering[0] == 0) continue;
    const ChangeMeasure measure = kMeasures[random.below(2) == 0 ? 0 : 2 + random.below(2)];
    const std::int64_t least = best.lowering[static_cast<std::size_t>(measure)];
    const Removal greedy = s.remove(RemovalMethod::greedy_breach, measure);
    const double m = static_cast<double>(greedy.num_pits) + 1;
    EXPECT_EQ(greedy.num_unguaranteed, 0u);
    EXPECT_LE(static_cast<double>(greedy.cost), std::max(1.0, 2 * std::log(m)) * static_cast<double>(least));
    num_several += greedy.num_pits > 1;
    num_optima += greedy.cost == least;
    ++num_all;
  }
  EXPECT_GT(num_several, 60u);
  RecordProperty("instances", static_cast<int>(num_all));
  RecordProperty("optimal", static_cast<int>(num_optima));
}

TEST(PitRemoval, LeavesNoPitAndKeepsItsPromises) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = make_outlet_terrain(seed);
    const Sample s = sample_of(t.grid, t.is_outlet);
    const auto level = lift(s.graph, s.height, s.is_outlet);
    for (const ChangeMeasure measure : kMeasures) {
      std::int64_t lift_cost = 0, breach_cost = 0;
      for (const RemovalMethod method : kMethods) {
        SCOPED_TRACE(static_cast<int>(method) * 10 + static_cast<int>(measure));
        const Removal r = s.remove(method, measure);
        for (std::size_t v = 0; v < level.size(); ++v) {
          if (level[v] == kNoLevel || s.is_outlet[v]) {
            EXPECT_EQ(r.height[v], s.height[v]);
            continue;
          }
          EXPECT_LE(r.height[v], level[v]);
          if (method == RemovalMethod::lift) {
            EXPECT_EQ(r.height[v], level[v]);
          }
          if (method != RemovalMethod::least_change && method != RemovalMethod::lift && r.num_unbreached == 0) {
            EXPECT_LE(r.height[v], s.height[v]);
          }
        }
        for (const auto& pit : oracle::pits(s.around, r.height, s.position, s.is_outlet))
          EXPECT_EQ(level[pit.vertex], kNoLevel);
        EXPECT_EQ(r.cost, cost_of(s, r.height, measure));
        EXPECT_LE(r.bound, r.cost);
        if (method == RemovalMethod::lift) lift_cost = r.cost;
        if (method == RemovalMethod::breach) breach_cost = r.cost;
        if (method == RemovalMethod::least_change) {
          EXPECT_LE(r.cost, std::min(lift_cost, breach_cost));
        }
        Sample again = s;
        again.height = r.height;
        EXPECT_EQ(again.remove(method, measure).height, r.height) << "idempotent";
      }
    }
  }
}

TEST(PitRemoval, DoesNotDependOnTheNumbering) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    OutletTerrain t = make_outlet_terrain(seed);
    if (seed >= 50) {  // larger
      t.grid = make_grid(seed, 40, 40, 100, 30);
      t.grid.height = testing::relief_heights(seed, t.grid.position, 1500, 100, seed % 2 == 0 ? 30 : 3);
      t.is_outlet = testing::hull_flags(t.grid);
    }
    const Renumbered moved = renumber(t.grid, t.is_outlet, seed);
    const std::vector<std::uint32_t>& to = moved.number;
    const Sample a = sample_of(t.grid, t.is_outlet), b = sample_of(moved.grid, moved.is_outlet);
    for (const ChangeMeasure measure : kMeasures)
      for (const RemovalMethod method : kMethods) {
        if (method == RemovalMethod::greedy_breach && seed >= 50) continue;
        const Removal p = a.remove(method, measure), q = b.remove(method, measure);
        EXPECT_EQ(p.bound, q.bound);
        for (std::uint32_t v = 0; v < to.size(); ++v)
          ASSERT_EQ(p.height[v], q.height[to[v]]) << static_cast<int>(method) << static_cast<int>(measure);
      }
  }
}

// The problem of a component, cut out of its surroundings, is all that its solution depends on.
TEST(PitRemoval, ComponentsCanBeSolvedInAnyOrder) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = make_outlet_terrain(seed);
    const Sample s = sample_of(t.grid, t.is_outlet);
    const auto terrain = s.view(ChangeMeasure::total);
    const PitComponents c = find_pit_components(terrain, MemberReach::paths, ChangeMeasure::total, {});
    std::vector<std::uint32_t> number(s.height.size(), kNoVertexNumber);
    DrainageProblem problem;
    // Mixes methods between components: any surfaces that drain and lie at or below the level do.
    Random random(seed);
    std::vector<std::int32_t> x = s.height;
    for (std::size_t i = 0; i < c.size(); ++i) {
      make_problem(terrain, c, i, number, problem);
      const auto level = lift(problem, problem.height);
      auto surface = random.below(2) == 0 ? level : lift(problem, problem.breached);
      for (std::uint32_t j = 0; j < problem.size(); ++j) {
        EXPECT_EQ(level[j], c.level[c.member[c.begin[i] + j]]);
        EXPECT_EQ(level[j], problem.level[j]);
        if (j > 0) {
          EXPECT_LT(s.position[c.member[c.begin[i] + j - 1]], s.position[c.member[c.begin[i] + j]]);
        }
        x[c.member[c.begin[i] + j]] = surface[j];
      }
      EXPECT_TRUE(drains(problem, surface));
    }
    EXPECT_TRUE(std::ranges::all_of(number, [](std::uint32_t n) { return n == kNoVertexNumber; }));
    for (const auto& pit : oracle::pits(s.around, x, s.position, s.is_outlet)) EXPECT_EQ(c.level[pit.vertex], kNoLevel);
  }
}

TEST(PitRemoval, BreachOfOnePitEqualsTheShortestPathByDefinition) {
  std::size_t num_paths = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = make_outlet_terrain(seed);
    const Sample s = sample_of(t.grid, t.is_outlet);
    const auto level = lift(s.graph, s.height, s.is_outlet);
    for (const auto& pit : oracle::pits(s.around, s.height, s.position, s.is_outlet)) {
      for (const ChangeMeasure measure : kMeasures) {
        const std::int32_t h = pit.height;
        const auto terrain = s.view(measure);
        const std::int32_t max_depth = seed % 3 == 0 ? 2 : std::numeric_limits<std::int32_t>::max();
        // Bellman-Ford over (bottleneck, sum): for `max` first the least bottleneck, then the sum within it.
        const auto shortest = [&](std::int64_t depth_limit, bool bottleneck) {
          constexpr std::int64_t kFar = std::int64_t{1} << 50;
          std::vector<std::int64_t> d(s.height.size(), kFar);
          d[pit.vertex] = 0;
          for (bool changed = true; changed;) {
            changed = false;
            for (std::uint32_t v = 0; v < d.size(); ++v)
              for (const std::uint32_t w : s.around[v]) {
                const std::int64_t depth = std::max<std::int64_t>(0, std::int64_t{s.height[w]} - h);
                if (depth > depth_limit || (depth > 0 && s.is_outlet[w]) || d[v] == kFar) continue;
                if (d[v] != kFar && v != pit.vertex && s.height[v] < h) continue;
                std::int64_t cost = d[v];
                if (bottleneck)
                  cost = std::max(cost, depth);
                else if (measure == ChangeMeasure::count)
                  cost += depth > 0;
                else
                  cost += depth * (measure == ChangeMeasure::volume ? s.weight[w] : 1);
                if (cost < d[w]) d[w] = cost, changed = true;
              }
          }
          std::int64_t best = kFar;
          for (std::uint32_t v = 0; v < d.size(); ++v)
            if (s.height[v] < h || (s.height[v] == h && s.is_outlet[v])) best = std::min(best, d[v]);
          return best == kFar ? -1 : best;
        };
        std::int64_t expected = shortest(max_depth, measure == ChangeMeasure::max);
        const BreachPath path = breach_one(terrain, level, pit.vertex, measure, {max_depth});
        EXPECT_EQ(path.vertex.empty(), expected < 0);
        EXPECT_EQ(path.pit, pit.vertex);
        if (expected < 0 || path.vertex.empty()) continue;
        ++num_paths;
        EXPECT_EQ(path.cost, expected);
        double length = 0;
        std::int64_t sum = 0;
        std::int32_t deepest = 0;
        std::vector<std::int32_t> x = s.height;
        for (std::size_t i = 0; i < path.vertex.size(); ++i) {
          const std::uint32_t v = path.vertex[i];
          const std::int32_t depth = std::max(0, s.height[v] - h);
          sum += measure == ChangeMeasure::count ? (depth > 0)
                                                 : depth * (measure == ChangeMeasure::volume ? s.weight[v] : 1);
          deepest = std::max(deepest, depth);
          x[v] = std::min(x[v], h);
          if (i == 0) continue;
          EXPECT_TRUE(s.around[v].contains(path.vertex[i - 1]));
          length += std::hypot(s.position[v].x - s.position[path.vertex[i - 1]].x,
                               s.position[v].y - s.position[path.vertex[i - 1]].y);
        }
        EXPECT_EQ(path.max_depth, deepest);
        EXPECT_NEAR(path.length, length, 1e-9);
        if (measure == ChangeMeasure::max) {
          EXPECT_EQ(deepest, expected);
          EXPECT_EQ(sum, shortest(expected, false));
        }
        for (const auto& left : oracle::pits(s.around, x, s.position, s.is_outlet)) EXPECT_NE(left.vertex, pit.vertex);
        const double too_short = path.length * 0.99;
        EXPECT_TRUE(breach_one(terrain, level, pit.vertex, measure, {max_depth, too_short}).vertex.empty() ||
                    path.length == 0);
      }
    }
  }
  EXPECT_GT(num_paths, 1000u);
}

// River vertices that must not move, and bounds on all others: a later step's way of using the problems.
TEST(PitRemoval, BoundsAreKept) {
  std::size_t num_bound = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = make_outlet_terrain(seed);
    const Sample s = sample_of(t.grid, t.is_outlet);
    const auto level = lift(s.graph, s.height, s.is_outlet);
    Random random(seed);
    std::vector<std::int32_t> lower, upper;
    for (std::size_t v = 0; v < level.size(); ++v) {
      const std::int32_t top = level[v] == kNoLevel ? s.height[v] : level[v];
      const bool is_fixed = top == s.height[v] && random.below(3) == 0;
      lower.push_back(is_fixed ? s.height[v] : s.height[v] - static_cast<std::int32_t>(random.below(4)));
      upper.push_back(is_fixed ? s.height[v] : top + static_cast<std::int32_t>(random.below(3)));
    }
    auto terrain = s.view(ChangeMeasure::total);
    terrain.lower = lower;
    terrain.upper = upper;
    for (const RemovalMethod method : kMethods) {
      RemovalOptions options;
      options.method = method;
      options.with_bound = true;
      const Removal r = remove_pits(terrain, options);
      EXPECT_LE(r.bound, r.cost);
      for (std::size_t v = 0; v < level.size(); ++v) {
        EXPECT_GE(r.height[v], lower[v]);
        EXPECT_LE(r.height[v], upper[v]);
        num_bound += r.height[v] != s.height[v] && r.height[v] == lower[v];
      }
      for (const auto& pit : oracle::pits(s.around, r.height, s.position, s.is_outlet))
        EXPECT_EQ(level[pit.vertex], kNoLevel);
    }
  }
  EXPECT_GT(num_bound, 100u);
}

TEST(PitRemoval, FlatTerrainPlateausAndSeveralMinima) {
  for (const RemovalMethod method : kMethods) {
    SCOPED_TRACE(static_cast<int>(method));
    GridTerrain grid = make_grid(2, 9, 9, 10, 0);
    std::vector<std::uint8_t> corner(81, 0);
    corner[grid.at[0]] = 1;
    const Sample flat = sample_of(grid, corner);
    EXPECT_EQ(flat.remove(method).height, flat.height);
    // A plateau as a pit inside a plateau as a sill; a low corner as outlet.
    grid.height.assign(81, 9);
    for (const std::size_t i : {30, 31, 39, 40}) grid.height[grid.at[i]] = 4;
    grid.height[grid.at[0]] = 0;
    const Sample s = sample_of(grid, corner);
    const Removal r = s.remove(method);
    EXPECT_TRUE(oracle::pits(s.around, r.height, s.position, s.is_outlet).empty());
    EXPECT_EQ(r.num_pits, 1u);
    if (method == RemovalMethod::lift) {
      EXPECT_EQ(r.cost, 20);
    }
    if (method == RemovalMethod::least_change) {
      EXPECT_LE(r.cost, 15);
    }
    // Two global minima, one of them an outlet: the other drains to it.
    grid.height.assign(81, 5);
    grid.height[grid.at[0]] = grid.height[grid.at[80]] = 2;
    const Sample two = sample_of(grid, corner);
    EXPECT_TRUE(oracle::pits(two.around, two.remove(method).height, two.position, two.is_outlet).empty());
  }
}

}  // namespace
}  // namespace hydrotin
