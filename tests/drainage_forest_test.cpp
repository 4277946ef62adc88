#include "hydrotin/drainage_forest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <set>
#include <tuple>

#include "clouds.h"
#include "grid_terrain.h"
#include "hydrotin/vertex_graph.h"

namespace hydrotin {
namespace {

using testing::Random;

/// A random forest as a problem: each member drains to its exit or to one before it.
struct Trees {
  DrainageProblem problem;
  DrainageForest forest;
  std::vector<std::int32_t> lower, upper;
};

Trees random_trees(std::uint64_t seed, std::uint32_t max_size) {
  Random random(seed);
  Trees t;
  const std::uint32_t k = 1 + random.below(max_size);
  const std::int32_t range = 1 + static_cast<std::int32_t>(random.below(5));
  for (std::uint32_t v = 0; v < k; ++v) {
    t.problem.height.push_back(random.between(0, range));
    const bool is_root = v == 0 || random.below(5) == 0;
    t.forest.parent.push_back(is_root ? kRoot : random.below(3) == 0 ? v - 1 : random.below(v));
    t.problem.exit.push_back(is_root ? random.between(0, range) : kNoLevel);
    t.forest.order.push_back(v);
  }
  if (random.below(2) == 0)
    for (std::uint32_t v = 0; v < k; ++v) t.problem.weight.push_back(1 + random.below(3));
  return t;
}

using Surface = std::vector<std::int32_t>;

/// Calls visit(x) for every surface with heights in 0 .. highest that keeps to the forest and the bounds.
void for_each_surface(const Trees& t, std::int32_t highest, const std::function<void(const Surface&)>& visit) {
  Surface x(t.problem.size());
  const std::function<void(std::uint32_t)> choose = [&](std::uint32_t v) {
    if (v == x.size()) return visit(x);
    const std::uint32_t p = t.forest.parent[v];
    std::int32_t from = p == kRoot ? t.problem.exit[v] : x[p], to = highest;
    if (!t.lower.empty()) from = std::max(from, t.lower[v]), to = std::min(to, t.upper[v]);
    for (x[v] = from; x[v] <= to; ++x[v]) choose(v + 1);
  };
  choose(0);
}

bool keeps_to(const Trees& t, const Surface& x) {
  for (std::uint32_t v = 0; v < x.size(); ++v) {
    const std::uint32_t p = t.forest.parent[v];
    if (x[v] < (p == kRoot ? t.problem.exit[v] : x[p])) return false;
    if (!t.lower.empty() && (x[v] < t.lower[v] || x[v] > t.upper[v])) return false;
  }
  return true;
}

TEST(TreeRegression, LeastTotalIsTheLowestOfTheBestSurfaces) {
  TreeRegression regression;
  std::size_t num_bounded = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    SCOPED_TRACE(seed);
    Trees t = random_trees(seed, 6);
    Random random(seed ^ 77);
    if (random.below(2) == 0)
      for (std::uint32_t v = 0; v < t.problem.size(); ++v) {
        const std::int32_t a = random.between(0, 5), b = random.between(0, 5);
        t.lower.push_back(std::min(a, b));
        t.upper.push_back(std::max(a, b));
      }
    std::int64_t best = std::numeric_limits<std::int64_t>::max();
    Surface lowest;
    for_each_surface(t, 5, [&](const Surface& x) {
      const std::int64_t cost = cost_of(t.problem, x, ChangeMeasure::total);
      if (cost < best) best = cost, lowest = x;
      if (cost == best)
        for (std::size_t v = 0; v < x.size(); ++v) lowest[v] = std::min(lowest[v], x[v]);
    });
    if (lowest.empty()) continue;  // the bounds allow nothing
    num_bounded += !t.lower.empty();
    Surface x;
    regression.least_total(t.problem, t.forest, t.lower, t.upper, x);
    ASSERT_TRUE(keeps_to(t, x));
    EXPECT_EQ(cost_of(t.problem, x, ChangeMeasure::total), best);
    EXPECT_EQ(x, lowest);
  }
  EXPECT_GT(num_bounded, 300u);
}

TEST(TreeRegression, LeastCountKeepsTheMost) {
  TreeRegression regression;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    SCOPED_TRACE(seed);
    const Trees t = random_trees(seed, 6);
    std::int64_t best = std::numeric_limits<std::int64_t>::max();
    for_each_surface(t, 5,
                     [&](const Surface& x) { best = std::min(best, cost_of(t.problem, x, ChangeMeasure::count)); });
    Surface x;
    regression.least_count(t.problem, t.forest, x);
    ASSERT_TRUE(keeps_to(t, x));
    EXPECT_EQ(cost_of(t.problem, x, ChangeMeasure::count), best);
  }
}

TEST(TreeRegression, LargeTreesAgreeWithAnExchangeOfSingleBlocks) {
  TreeRegression regression;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Trees t = random_trees(seed, 2000);
    Surface x;
    regression.least_total(t.problem, t.forest, {}, {}, x);
    ASSERT_TRUE(keeps_to(t, x));
    // Level by level: at a level t the set {x >= t} must be a best set closed upstream (a minimum cut, here by a sum
    // over subtrees from the leaves, because the constraints form a forest).
    for (std::int32_t level = 1; level <= 6; ++level) {
      std::int64_t best = 0, own = 0;
      std::vector<std::int64_t> raised(t.problem.size(), 0), free(t.problem.size(), 0);
      for (std::size_t i = t.problem.size(); i-- > 0;) {
        const auto v = static_cast<std::uint32_t>(i);
        const std::int64_t w = t.problem.weight_of(v);
        raised[v] += t.problem.height[v] < level ? w : 0;
        const std::int64_t stays = free[v] + (t.problem.height[v] < level ? 0 : w);
        const std::uint32_t p = t.forest.parent[v];
        const bool is_forced = p == kRoot && t.problem.exit[v] >= level;
        const std::int64_t least = is_forced ? raised[v] : std::min(raised[v], stays);
        if (p == kRoot) {
          best += least;
        } else {
          raised[p] += raised[v];
          free[p] += least;
        }
        own += (x[v] >= level) != (t.problem.height[v] >= level) ? w : 0;
      }
      EXPECT_EQ(own, best) << level;
    }
  }
}

/// A square of members with heights from 0 to 20 above the lowest, and few exits.
DrainageProblem grid_problem(std::uint32_t side, std::int32_t lowest, Random& random) {
  const testing::GridTerrain grid = testing::make_grid(side, side, side, 10, 3);
  const VertexGraph graph = make_vertex_graph(grid.num_vertices(), grid.triangle);
  DrainageProblem problem;
  problem.begin.assign(graph.begin.begin(), graph.begin.end());
  for (std::uint32_t v = 0; v < grid.num_vertices(); ++v) {
    const auto neighbors = graph.neighbors(v);
    problem.neighbor.insert(problem.neighbor.end(), neighbors.begin(), neighbors.end());
    std::sort(problem.neighbor.end() - static_cast<std::ptrdiff_t>(neighbors.size()), problem.neighbor.end());
    problem.height.push_back(lowest + random.between(0, 20));
    problem.exit.push_back(v == 0 || random.below(50) == 0 ? lowest + random.between(0, 20) : kNoLevel);
  }
  return problem;
}

constexpr std::int32_t kLowestOfAll = std::numeric_limits<std::int32_t>::min();

// The forest by its definition, with a sorted set in place of the queue: on surfaces with flats, where members are
// reached after their turn, up to sizes at which the queue has all its levels.
TEST(ForestFinder, TakesMembersInTheOrderOfItsDefinition) {
  ForestFinder finder;  // one finder serves many problems
  for (const std::uint32_t side : {1u, 2u, 3u, 9u, 70u, 520u}) {
    SCOPED_TRACE(side);
    Random random(side);
    const DrainageProblem problem = grid_problem(side, side % 2 == 0 ? 0 : kLowestOfAll, random);
    const std::uint32_t k = problem.size();
    const Surface surface = lift(problem, problem.height);
    DrainageForest forest;
    finder.set_problem(problem);
    finder.run(Surface(k, 20), forest);  // and many surfaces
    finder.run(surface, forest);

    using Place = std::tuple<std::int32_t, std::int32_t, std::uint32_t>;
    const auto place = [&](std::uint32_t v) { return Place(surface[v], problem.height[v], v); };
    std::vector<std::uint32_t> order, parent(k, kRoot);
    std::vector<bool> is_reached(k), is_done(k);
    std::set<Place> queue;
    for (std::uint32_t v = 0; v < k; ++v)
      if (problem.exit[v] <= surface[v]) is_reached[v] = true, queue.insert(place(v));
    while (!queue.empty()) {
      const std::uint32_t v = std::get<2>(*queue.begin());
      queue.erase(queue.begin());
      is_done[v] = true;
      order.push_back(v);
      for (const std::uint32_t w : problem.neighbors(v)) {
        if (is_done[w] || surface[w] < surface[v]) continue;
        if (!is_reached[w]) {
          is_reached[w] = true;
          parent[w] = v;
          queue.insert(place(w));
        } else if (parent[w] == kRoot && surface[v] < problem.exit[w]) {
          parent[w] = v;
        }
      }
    }
    EXPECT_EQ(forest.order, order);
    EXPECT_EQ(forest.parent, parent);
  }
}

// From the exits upwards, whatever does not lie lower drains.
bool drains_by_definition(const DrainageProblem& problem, const Surface& surface) {
  std::vector<std::uint32_t> open;
  std::vector<bool> is_reached(problem.size());
  for (std::uint32_t v = 0; v < problem.size(); ++v)
    if (problem.exit[v] <= surface[v]) is_reached[v] = true, open.push_back(v);
  for (std::size_t next = 0; next < open.size(); ++next)
    for (const std::uint32_t w : problem.neighbors(open[next]))
      if (!is_reached[w] && surface[w] >= surface[open[next]]) is_reached[w] = true, open.push_back(w);
  return open.size() == problem.size();
}

TEST(DrainageProblem, DrainsByDefinition) {
  std::size_t num_draining = 0, num_others = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const DrainageProblem problem = grid_problem(1 + random.below(9), seed % 3 == 0 ? kLowestOfAll : 0, random);
    Surface surface = random.below(2) == 0 ? lift(problem, problem.height) : problem.height;
    for (std::uint32_t changes = random.below(4); changes > 0; --changes) {
      const std::uint32_t v = random.below(problem.size());
      surface[v] = surface[random.below(problem.size())];
    }
    const bool expected = drains_by_definition(problem, surface);
    EXPECT_EQ(drains(problem, surface), expected);
    EXPECT_EQ(lift(problem, surface) == surface, expected);
    ++(expected ? num_draining : num_others);
  }
  EXPECT_GT(num_draining, 50u);
  EXPECT_GT(num_others, 50u);
}

}  // namespace
}  // namespace hydrotin
