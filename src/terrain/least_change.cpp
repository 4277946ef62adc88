#include "hydrotin/least_change.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <tuple>
#include <utility>

#include "breach_search.h"
#include "hydrotin/drainage_forest.h"
#include "hydrotin/greedy_breach.h"
#include "local_pits.h"

namespace hydrotin {

class ChangeScratch::State {
 public:
  ForestFinder finder;
  BreachSearch search;
  TreeRegression regression;
  DrainageForest forest;
  LocalPits pits;
  std::vector<std::uint32_t> order;
  std::vector<std::int32_t> next;
};

ChangeScratch::ChangeScratch() : state_(std::make_unique<State>()) {}
ChangeScratch::~ChangeScratch() = default;

namespace {

using Scratch = ChangeScratch::State;

constexpr std::uint32_t kFewMembers = 100;     // below: every way of breaching is tried
constexpr std::uint32_t kManyMembers = 1'000;  // above: with limited searches, only the breaches that are known
constexpr std::int64_t kSmallGain = 20;        // and no round after one that gains less than this part of the cost

/// A surface that drains, and the forest along which it was made, if it was made along one.
struct Start {
  std::vector<std::int32_t> surface;
  DrainageForest forest;
};

/// Breaches what is left, where that is possible at all, along the forest by which the flood drains; the rest is
/// lifted.
Start breach_rest(const DrainageProblem& problem, std::vector<std::int32_t> surface, const SearchLimits& limits,
                  ForestFinder& finder) {
  if (drains(problem, surface)) return {std::move(surface), {}};
  std::vector<std::int32_t> level = lift(problem, surface);
  if (limits.max_visits == ~std::uint64_t{0}) return {std::move(level), {}};
  DrainageForest forest;
  finder.run(level, forest);
  std::vector<std::int32_t> lowered = std::move(surface);
  for (std::size_t i = forest.order.size(); i-- > 0;) {
    const std::uint32_t v = forest.order[i], p = forest.parent[v];
    if (p == kRoot || lowered[p] <= lowered[v]) continue;
    const std::int64_t floor = std::int64_t{problem.height[p]} - limits.max_depth;
    lowered[p] = static_cast<std::int32_t>(std::max<std::int64_t>(lowered[v], floor));
    if (!problem.lower.empty()) lowered[p] = std::max(lowered[p], problem.lower[p]);
  }
  if (!drains(problem, lowered)) lowered = lift(problem, lowered);
  return {std::move(lowered), std::move(forest)};
}

/// Breaches the pits in the scratch's order, then what is left.
Start breach_in_turn(const DrainageProblem& problem, ChangeMeasure measure, const SearchLimits& limits,
                     Scratch& scratch) {
  std::vector<std::int32_t> surface = problem.height;
  const ProblemGround ground{&problem, &surface, measure, limits.max_depth};
  scratch.search.reserve(problem.size());
  for (const std::uint32_t i : scratch.order) {
    const LocalPit& pit = scratch.pits.pit[i];
    const std::int32_t level = surface[pit.first];
    if (level != pit.height) continue;  // a breach has gone through it
    if (!scratch.search.run(ground, scratch.pits.vertices(pit), level, limits.max_visits)) continue;
    for (const std::uint32_t v : scratch.search.path()) surface[v] = std::min(surface[v], level);
  }
  return breach_rest(problem, std::move(surface), limits, scratch.finder);
}

/// Cost in the sense of a measure, ties by total.
std::pair<std::int64_t, std::int64_t> rank_of(const DrainageProblem& problem, std::span<const std::int32_t> surface,
                                              ChangeMeasure measure) {
  const std::int64_t total = cost_of(problem, surface, ChangeMeasure::total);
  return {
      measure == ChangeMeasure::total || measure == ChangeMeasure::volume ? total : cost_of(problem, surface, measure),
      total};
}

/// All surfaces made by breaching, lifted where that was not possible.
std::vector<Start> breached_surfaces(const DrainageProblem& problem, const std::vector<std::int32_t>& level,
                                     ChangeMeasure measure, const SearchLimits& limits, Scratch& scratch) {
  std::vector<Start> surfaces;
  if (!problem.breached.empty()) surfaces.push_back(breach_rest(problem, problem.breached, limits, scratch.finder));
  if (!surfaces.empty()) {
    if (measure == ChangeMeasure::max) return surfaces;  // merging the best of each is the best of all
    if (problem.size() > kManyMembers && limits.max_visits != ~std::uint64_t{0}) return surfaces;
  }
  const std::vector<LocalPit>& pit = scratch.pits.pit;
  find_local_pits(problem, problem.height, level, scratch.pits);
  if (pit.size() == 1 && !surfaces.empty()) return surfaces;
  std::vector<std::uint32_t>& order = scratch.order;
  order.resize(pit.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const LocalPit &p = pit[a], &q = pit[b];
    return std::tie(p.spill, p.height, p.first) < std::tie(q.spill, q.height, q.first);
  });
  surfaces.push_back(breach_in_turn(problem, measure, limits, scratch));
  if (problem.size() > kFewMembers) return surfaces;
  const auto by_spill = order;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const LocalPit &p = pit[a], &q = pit[b];
    return std::tie(p.height, p.spill, p.first) < std::tie(q.height, q.spill, q.first);
  });
  if (order != by_spill) surfaces.push_back(breach_in_turn(problem, measure, limits, scratch));
  return surfaces;
}

Start cheapest(const DrainageProblem& problem, std::vector<Start> surfaces, ChangeMeasure measure) {
  if (surfaces.size() == 1) return std::move(surfaces.front());
  const auto best =
      std::ranges::min_element(surfaces, {}, [&](const Start& s) { return rank_of(problem, s.surface, measure); });
  return std::move(*best);
}

/// Rounds of forest and regression from a start.
class Improver {
 public:
  Improver(const DrainageProblem& problem, const std::vector<std::int32_t>& level, const LeastChangeOptions& options,
           Scratch& scratch)
      : problem_(&problem),
        level_(&level),
        options_(options),
        lower_(problem.lower),
        upper_(problem.upper),
        scratch_(&scratch) {}

  void bound(std::vector<std::int32_t> lower, std::vector<std::int32_t> upper) {
    lower_ = std::move(lower);
    upper_ = std::move(upper);
  }

  /// @param start  of a large problem, the first round takes its forest instead of finding another.
  void improve(Start start) {
    std::vector<std::int32_t> surface = std::move(start.surface);
    std::vector<std::int32_t>& next = scratch_->next;
    auto cost = rank_of(*problem_, surface, options_.measure);
    bool is_final = false;
    for (int round = 0; round < options_.max_rounds; ++round) {
      const bool has_forest = round == 0 && is_large() && !start.forest.order.empty();
      if (!has_forest && best_is_final_ && cost == best_cost_ && surface == best_) return;  // nothing new follows
      if (!has_forest) scratch_->finder.run(surface, scratch_->forest);
      find_next(has_forest ? start.forest : scratch_->forest);
      const auto next_cost = rank_of(*problem_, next, options_.measure);
      is_final = next_cost >= cost;
      if (is_final) break;
      const bool is_last = is_large() && next_cost.first > cost.first - cost.first / kSmallGain;
      cost = next_cost;
      surface.swap(next);
      if (is_last) break;
    }
    if (best_.empty() || cost < best_cost_) {
      best_cost_ = cost;
      best_ = std::move(surface);
      best_is_final_ = is_final;
    }
  }

  [[nodiscard]] std::vector<std::int32_t> take_best() { return std::move(best_); }

 private:
  [[nodiscard]] bool is_large() const {
    return problem_->size() > kManyMembers && options_.limits.max_visits != ~std::uint64_t{0};
  }

  /// The best surface for a forest, in the scratch.
  void find_next(const DrainageForest& forest) {
    std::vector<std::int32_t>& next = scratch_->next;
    if (options_.measure == ChangeMeasure::count)
      scratch_->regression.least_count(*problem_, forest, next);
    else
      scratch_->regression.least_total(*problem_, forest, lower_, upper_, next);
    for (std::uint32_t v = 0; v < next.size(); ++v) next[v] = std::min(next[v], (*level_)[v]);
  }

  const DrainageProblem* problem_;
  const std::vector<std::int32_t>* level_;
  LeastChangeOptions options_;
  std::vector<std::int32_t> lower_, upper_, best_;
  std::pair<std::int64_t, std::int64_t> best_cost_;
  bool best_is_final_ = false;  // no round from the best surface gains anything
  Scratch* scratch_;
};

struct Corridor {
  std::vector<std::int32_t> lower, upper;  // h - D, h + D within the bounds of the problem
  std::vector<std::int32_t> least;         // the least surface in it that drains, kNoLevel anywhere: none
};

Corridor corridor(const DrainageProblem& problem, std::int64_t displacement) {
  Corridor c;
  for (std::uint32_t v = 0; v < problem.size(); ++v) {
    const std::int64_t h = problem.height[v];
    std::int64_t low = std::max<std::int64_t>(h - displacement, std::numeric_limits<std::int32_t>::min());
    std::int64_t high = std::min<std::int64_t>(h + displacement, kNoLevel - 1);
    if (!problem.lower.empty()) low = std::max<std::int64_t>(low, problem.lower[v]);
    if (!problem.upper.empty()) high = std::min<std::int64_t>(high, problem.upper[v]);
    c.lower.push_back(static_cast<std::int32_t>(low));
    c.upper.push_back(static_cast<std::int32_t>(high));
  }
  c.least = lift(problem, c.lower);
  for (std::uint32_t v = 0; v < problem.size(); ++v)
    if (c.least[v] > c.upper[v]) c.least.clear();
  return c;
}

Corridor narrowest_corridor(const DrainageProblem& problem, const std::vector<std::int32_t>& level) {
  const std::int64_t highest = cost_of(problem, level, ChangeMeasure::max);
  std::int64_t low = (highest + 1) / 2, high = highest;  // lifting needs `highest`
  while (low < high) {
    const std::int64_t middle = low + (high - low) / 2;
    if (corridor(problem, middle).least.empty())
      low = middle + 1;
    else
      high = middle;
  }
  return corridor(problem, low);
}

}  // namespace

std::vector<std::int32_t> breach_all(const DrainageProblem& problem, ChangeMeasure measure, const SearchLimits& limits,
                                     ChangeScratch& scratch) {
  const std::vector<std::int32_t> level = level_of(problem);
  scratch.state().finder.set_problem(problem);
  return cheapest(problem, breached_surfaces(problem, level, measure, limits, scratch.state()), measure).surface;
}

std::vector<std::int32_t> breach_all(const DrainageProblem& problem, ChangeMeasure measure,
                                     const SearchLimits& limits) {
  ChangeScratch scratch;
  return breach_all(problem, measure, limits, scratch);
}

std::vector<std::int32_t> least_change(const DrainageProblem& problem, const LeastChangeOptions& options,
                                       ChangeScratch& scratch) {
  assert(problem.lower.size() == problem.upper.size() && "both bounds or none");
  const std::vector<std::int32_t> level = level_of(problem);
  Scratch& state = scratch.state();
  state.finder.set_problem(problem);
  Improver improver(problem, level, options, state);
  if (options.measure == ChangeMeasure::max) {
    Corridor c = narrowest_corridor(problem, level);
    improver.bound(std::move(c.lower), std::move(c.upper));
    improver.improve({std::move(c.least), {}});
    return improver.take_best();
  }
  Start breached =
      cheapest(problem, breached_surfaces(problem, level, options.measure, options.limits, state), options.measure);
  const bool lifting_is_worse =
      rank_of(problem, breached.surface, options.measure) < rank_of(problem, level, options.measure);
  if (problem.size() <= kFewMembers || !lifting_is_worse) improver.improve({level, {}});
  improver.improve(std::move(breached));
  if (options.with_greedy) {
    GreedyBreach greedy = greedy_breach(problem, options.measure, options.limits.max_depth);
    if (greedy.has_guarantee) improver.improve({std::move(greedy.surface), {}});
  }
  return improver.take_best();
}

std::vector<std::int32_t> least_change(const DrainageProblem& problem, const LeastChangeOptions& options) {
  ChangeScratch scratch;
  return least_change(problem, options, scratch);
}

}  // namespace hydrotin
