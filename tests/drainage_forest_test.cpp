#include "hydrotin/drainage_forest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <tuple>

#include "clouds.h"

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

}  // namespace
}  // namespace hydrotin
