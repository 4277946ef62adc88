// Pit removal within the limits that runs set: length and depth of breaches, work of searches, sizes of groups.

#include <gtest/gtest.h>

#include <algorithm>

#include "grid_terrain.h"
#include "hydrotin/lake_bound.h"
#include "hydrotin/pit_removal.h"
#include "oracle/removal_oracle.h"
#include "pit_sample.h"

namespace hydrotin {
namespace {

using testing::cost_of;
using testing::GridTerrain;
using testing::kMeasures;
using testing::kMethods;
using testing::make_grid;
using testing::renumber;
using testing::Renumbered;
using testing::Sample;
using testing::sample_of;

TEST(PitRemovalWithin, LimitsOfBreaching) {
  GridTerrain grid = make_grid(2, 30, 30, 100, 30);
  grid.height = testing::relief_heights(2, grid.position, 1500, 2000, 200);
  const Sample s = sample_of(grid, testing::hull_flags(grid));
  const auto terrain = s.view(ChangeMeasure::total);
  for (const std::int32_t depth : {0, 50, 200}) {
    RemovalOptions options;
    options.method = RemovalMethod::breach;
    options.limits = {depth, 400};
    const Removal r = remove_pits(terrain, options);
    EXPECT_GT(r.num_unbreached, 0u);
    EXPECT_TRUE(oracle::pits(s.around, r.height, s.position, s.is_outlet).empty());
    for (std::size_t v = 0; v < r.height.size(); ++v) EXPECT_GE(r.height[v], s.height[v] - depth);
    if (depth == 0) {
      EXPECT_EQ(r.height, r.components.level);
    }
  }
}

// A lake that lies below all that its search can reach, with a lower outlet beyond a ridge: its rim is opened down to
// the outlets behind it.
TEST(PitRemovalWithin, LimitedSearchesOpenTheRimOfDeepLakes) {
  GridTerrain grid = make_grid(1, 40, 20, 100, 0);
  grid.height.assign(grid.num_vertices(), 0);
  for (std::uint32_t y = 0; y < 20; ++y)
    for (std::uint32_t x = 0; x < 40; ++x) {
      const bool on_hull = x == 0 || y == 0 || y == 19, on_rim = x == 1 || x == 19 || y == 1 || y == 18;
      std::int32_t& z = grid.height[y * 40 + x];
      z = x > 20 ? 100 : x == 20 ? 1200 : on_hull ? 800 : on_rim ? 900 : static_cast<std::int32_t>((7 * x + 3 * y) % 5);
    }
  const Sample s = sample_of(grid, testing::hull_flags(grid));
  for (const ChangeMeasure measure : {ChangeMeasure::total, ChangeMeasure::volume}) {
    RemovalOptions options;
    options.measure = measure;
    options.limits.max_visits = 20;
    options.method = RemovalMethod::lift;
    const std::int64_t lifted = remove_pits(s.view(measure), options).cost;
    options.method = RemovalMethod::least_change;
    const Removal opened = remove_pits(s.view(measure), options);
    EXPECT_LT(static_cast<double>(opened.cost), 0.9 * static_cast<double>(lifted));
    EXPECT_TRUE(oracle::has_no_pit(s.around, opened.height, s.is_outlet));
  }
}

// A lake whose bottom lies below all outlets, so that no breach empties it. Two gorges lead away from its saddle: the
// steeper one to a high outlet, the other to the lowest. Deepening that one to its outlet and raising the lake as far
// is a surface that drains: limited searches find none dearer.
TEST(PitRemovalWithin, LimitedSearchesDeepenTheWayOutOfLakesBelowAllOutlets) {
  GridTerrain grid = make_grid(1, 40, 24, 100, 20);
  grid.height.assign(grid.num_vertices(), 2000);
  std::int64_t lifted = 0, deepened = 0;  // displacements
  for (std::uint32_t y = 3; y < 21; ++y)
    for (std::uint32_t x = 3; x < 21; ++x) {
      const auto depth = static_cast<std::int32_t>((7 * x + 3 * y) % 5);
      grid.height[grid.at[y * 40 + x]] = 5 - depth;
      lifted += 995 + depth, deepened += 481 + depth;
    }
  for (std::uint32_t x = 21; x < 40; ++x) {
    const std::int32_t z = x == 21 ? 1000 : static_cast<std::int32_t>(1383 - 23 * x);
    grid.height[grid.at[12 * 40 + x]] = z;
    deepened += z - 486;
  }
  for (std::uint32_t y = 0; y < 12; ++y) grid.height[grid.at[y * 40 + 22]] = static_cast<std::int32_t>(700 + 10 * y);
  const Sample s = sample_of(grid, testing::hull_flags(grid));
  RemovalOptions options;
  options.limits.max_visits = 20;
  options.method = RemovalMethod::lift;
  EXPECT_GE(remove_pits(s.view(ChangeMeasure::total), options).cost, lifted);
  for (const RemovalMethod method : {RemovalMethod::breach, RemovalMethod::least_change}) {
    options.method = method;
    const Removal removal = remove_pits(s.view(ChangeMeasure::total), options);
    EXPECT_LE(removal.cost, deepened);
    EXPECT_TRUE(oracle::has_no_pit(s.around, removal.height, s.is_outlet));
  }
}

// Deep lakes with searches that end early: still no pit, still the same in every numbering, still never above lifting.
TEST(PitRemovalWithin, LimitedSearchesKeepThePromises) {
  std::uint64_t num_unfinished = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    GridTerrain grid = make_grid(seed, 60, 60, 100, 30);
    grid.height = testing::relief_heights(seed, grid.position, 3000, 3000, seed % 2 == 0 ? 40 : 3);
    if (seed % 3 == 0) {  // plateaus
      for (auto& z : grid.height) z /= 100;
    }
    auto is_outlet = testing::hull_flags(grid);
    if (seed % 4 == 1) {
      is_outlet.assign(grid.num_vertices(), 0);
      is_outlet[lowest_vertex(grid.height, grid.position)] = 1;
    }
    const Renumbered moved = renumber(grid, is_outlet, seed);
    const std::vector<std::uint32_t>& to = moved.number;
    const Sample a = sample_of(grid, is_outlet), b = sample_of(moved.grid, moved.is_outlet);
    for (const ChangeMeasure measure : kMeasures) {
      std::int64_t lift_cost = 0, breach_cost = 0;
      for (const RemovalMethod method : {RemovalMethod::lift, RemovalMethod::breach, RemovalMethod::least_change}) {
        RemovalOptions options;
        options.method = method;
        options.measure = measure;
        options.limits.max_visits = 20;
        options.with_bound = true;
        const Removal p = remove_pits(a.view(measure), options), q = remove_pits(b.view(measure), options);
        for (std::uint32_t v = 0; v < to.size(); ++v) {
          ASSERT_EQ(p.height[v], q.height[to[v]]) << static_cast<int>(method) << static_cast<int>(measure);
          EXPECT_LE(p.height[v], p.components.level[v]);
        }
        const std::int64_t of_lakes = sum_of_lake_bounds(a.view(measure), p.components.level, measure);
        EXPECT_EQ(of_lakes, sum_of_lake_bounds(b.view(measure), q.components.level, measure));
        EXPECT_LE(of_lakes, kBoundShares * p.cost);
        EXPECT_TRUE(oracle::has_no_pit(a.around, p.height, a.is_outlet));
        EXPECT_LE(p.bound, p.cost);
        EXPECT_EQ(p.bound, q.bound);
        num_unfinished += p.components.num_unfinished;
        if (method == RemovalMethod::lift) lift_cost = p.cost;
        if (method == RemovalMethod::breach) breach_cost = p.cost;
        if (method == RemovalMethod::least_change) {
          EXPECT_LE(p.cost, std::min(lift_cost, breach_cost));
          if (measure == ChangeMeasure::total) {
            EXPECT_LT(p.cost, lift_cost);
          }
        }
      }
    }
  }
  EXPECT_GT(num_unfinished, 50u);
}

// Neither searches that end early nor those that run to their end are better everywhere.
TEST(PitRemovalWithin, TheBestSearchIsNeverDearerThanAnother) {
  std::size_t num_by_short = 0, num_by_long = 0;
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    SCOPED_TRACE(seed);
    GridTerrain grid = make_grid(seed, 50, 50, 100, 30);
    grid.height = testing::relief_heights(seed, grid.position, 1500, 3000, seed % 2 == 0 ? 200 : 20);
    const Sample s = sample_of(grid, testing::hull_flags(grid));
    for (const RemovalMethod method : kMethods) {
      if (method == RemovalMethod::greedy_breach) continue;
      RemovalOptions options;
      options.method = method;
      options.with_bound = true;
      const auto terrain = s.view(ChangeMeasure::total);
      const Removal best = remove_pits_by_best_search(terrain, options), by_long = remove_pits(terrain, options);
      options.limits.max_visits = kScalableVisits;
      const Removal by_short = remove_pits(terrain, options);
      EXPECT_TRUE(oracle::has_no_pit(s.around, best.height, s.is_outlet));
      EXPECT_EQ(best.cost, cost_of(s, best.height, ChangeMeasure::total));
      EXPECT_EQ(best.bound, by_long.bound);
      EXPECT_EQ(best.is_optimal, best.bound == best.cost);
      if (method != RemovalMethod::least_change) {
        EXPECT_EQ(best.height, by_long.height);
        continue;
      }
      EXPECT_EQ(best.cost, std::min(by_short.cost, by_long.cost));
      num_by_short += by_short.cost < by_long.cost;
      num_by_long += by_long.cost < by_short.cost;
    }
  }
  EXPECT_GT(num_by_short, 0u);
  EXPECT_GT(num_by_long, 0u);
}

// Components cut along squares: still no pit, nothing above lifting, the same in every numbering.
TEST(PitRemovalWithin, CutComponentsKeepThePromises) {
  std::uint64_t num_cut = 0, num_changed = 0;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    SCOPED_TRACE(seed);
    GridTerrain grid = make_grid(seed, 40, 40, 100, 30);
    grid.height = testing::relief_heights(seed, grid.position, 1500, 300, seed % 2 == 0 ? 200 : 3);
    if (seed % 3 == 0) {  // plateaus
      for (auto& z : grid.height) z /= 50;
    }
    const auto is_outlet = testing::hull_flags(grid);
    const Renumbered moved = renumber(grid, is_outlet, seed);
    const std::vector<std::uint32_t>& to = moved.number;
    const Sample a = sample_of(grid, is_outlet), b = sample_of(moved.grid, moved.is_outlet);
    for (const std::uint64_t most : {1u, 10u, 100u})
      for (const RemovalMethod method : {RemovalMethod::lift, RemovalMethod::breach, RemovalMethod::least_change}) {
        SCOPED_TRACE(std::to_string(most) + " " + std::to_string(static_cast<int>(method)));
        RemovalOptions options;
        options.method = method;
        options.limits.max_visits = 50;
        const Removal whole = remove_pits(a.view(ChangeMeasure::total), options);
        options.limits.max_group = most;
        options.with_bound = true;
        const Removal p = remove_pits(a.view(ChangeMeasure::total), options),
                      q = remove_pits(b.view(ChangeMeasure::total), options);
        for (std::uint32_t v = 0; v < to.size(); ++v) {
          ASSERT_EQ(p.height[v], q.height[to[v]]);
          EXPECT_LE(p.height[v], p.components.level[v]);
        }
        EXPECT_TRUE(oracle::has_no_pit(a.around, p.height, a.is_outlet));
        EXPECT_EQ(p.cost, cost_of(a, p.height, ChangeMeasure::total));
        EXPECT_LE(p.bound, p.cost);
        EXPECT_EQ(p.bound, q.bound);
        if (method == RemovalMethod::least_change) {
          EXPECT_LE(p.cost, cost_of(a, p.components.level, ChangeMeasure::total));
        }
        if (method == RemovalMethod::lift) {
          EXPECT_EQ(p.height, whole.height);
        }
        num_cut += p.components.num_cut;
        num_changed += p.height != whole.height;
      }
  }
  EXPECT_GT(num_cut, 100u);
  EXPECT_GT(num_changed, 50u);
}

// The squares by their definition: as long as there are too many members, halves by one bit of x, then of y.

}  // namespace
}  // namespace hydrotin
