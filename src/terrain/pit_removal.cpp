#include "hydrotin/pit_removal.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <utility>

#include "hydrotin/change_bound.h"
#include "hydrotin/greedy_breach.h"
#include "hydrotin/least_change.h"
#include "hydrotin/lifting.h"

namespace hydrotin {
namespace {

std::vector<std::int32_t> solve(const DrainageProblem& problem, const RemovalOptions& options,
                                std::uint64_t& num_unguaranteed) {
  const SearchLimits limits{options.limits.max_depth, options.limits.max_visits};
  switch (options.method) {
    case RemovalMethod::least_change:
      return least_change(problem, {options.measure, limits, options.thorough, options.max_rounds});
    case RemovalMethod::greedy_breach: {
      if (options.measure == ChangeMeasure::max) return breach_all(problem, options.measure, limits);
      GreedyBreach greedy = greedy_breach(problem, options.measure, options.limits.max_depth);
      num_unguaranteed += greedy.has_guarantee ? 0 : 1;
      return std::move(greedy.surface);
    }
    case RemovalMethod::breach:
      return breach_all(problem, options.measure, limits);
    case RemovalMethod::lift:
      break;
  }
  return lift(problem, problem.height);
}

/// A bound for the class of surfaces of the method. Lifting is best in its class. Lowering alone costs at least what
/// the dearest pit costs by itself, if all pits are lowered; where components were cut, some may be lifted.
std::int64_t bound_of(const ChangeableTerrain& terrain, const RemovalOptions& options, const PitComponents& components,
                      std::int64_t cost) {
  if (options.method == RemovalMethod::lift) return cost;
  const bool raises = options.method == RemovalMethod::least_change || components.num_unbreached != 0 ||
                      components.num_unfinished != 0 || components.num_cut != 0;
  const std::int64_t bound = change_bound(terrain, components.level, options.measure, raises);
  return raises ? bound : std::max(bound, components.dearest_breach);
}

std::int64_t total_cost(const ChangeableTerrain& terrain, std::span<const std::int32_t> height, ChangeMeasure measure) {
  std::int64_t cost = 0;
  for (std::size_t v = 0; v < height.size(); ++v) {
    const std::int64_t moved = std::abs(std::int64_t{height[v]} - terrain.height[v]);
    if (measure == ChangeMeasure::max)
      cost = std::max(cost, moved);
    else if (measure == ChangeMeasure::count)
      cost += moved != 0;
    else
      cost += moved * (terrain.weight.empty() ? 1 : terrain.weight[v]);
  }
  return cost;
}

}  // namespace

MemberReach reach_of(const RemovalOptions& options) {
  if (options.method == RemovalMethod::lift) return MemberReach::lifted;
  if (options.measure == ChangeMeasure::max) return MemberReach::paths;
  const bool wide = options.method == RemovalMethod::greedy_breach ||
                    (options.method == RemovalMethod::least_change && options.thorough);
  return wide ? MemberReach::centers : MemberReach::paths;
}

std::uint64_t solve_components(const ChangeableTerrain& terrain, const PitComponents& components,
                               const RemovalOptions& options, std::span<std::int32_t> height) {
  assert(height.size() == terrain.height.size() && "one entry per vertex");
  std::uint64_t num_unguaranteed = 0;
  std::vector<std::uint32_t> number(terrain.height.size(), kNoVertexNumber);
  DrainageProblem problem;
  for (std::size_t i = 0; i < components.size(); ++i) {
    const std::span<const std::uint32_t> member(components.member.data() + components.begin[i],
                                                components.member.data() + components.begin[i + 1]);
    if (options.method == RemovalMethod::lift) {
      for (const std::uint32_t v : member) height[v] = components.level[v];
      continue;
    }
    make_problem(terrain, components, i, number, problem);
    const std::vector<std::int32_t> surface = solve(problem, options, num_unguaranteed);
    for (std::uint32_t j = 0; j < member.size(); ++j) height[member[j]] = surface[j];
  }
  return num_unguaranteed;
}

Removal remove_pits(const ChangeableTerrain& terrain, const RemovalOptions& options) {
  Removal result;
  PitComponents components = find_pit_components(terrain, reach_of(options), options.measure, options.limits);
  result.height = filled_heights(terrain, components);
  {
    ChangeableTerrain filled = terrain;
    std::vector<std::int32_t> height;
    if (!components.filled.empty()) filled.height = height = result.height;
    result.num_unguaranteed = solve_components(filled, components, options, result.height);
  }
  result.cost = total_cost(terrain, result.height, options.measure);
  if (options.with_bound) {
    result.bound = bound_of(terrain, options, components, result.cost);
    result.is_optimal = result.bound == result.cost;
  }
  result.num_pits = components.num_pits;
  result.num_unbreached = components.num_unbreached;
  result.components = std::move(components);
  return result;
}

Removal remove_pits_by_best_search(const ChangeableTerrain& terrain, RemovalOptions options) {
  const bool is_small = terrain.height.size() <= kSmallTerrain;
  options.limits.max_visits = is_small ? BreachLimits{}.max_visits : kScalableVisits;
  Removal result = remove_pits(terrain, options);
  if (!is_small || options.method != RemovalMethod::least_change) return result;
  options.limits.max_visits = kScalableVisits;
  options.with_bound = false;  // it does not depend on searches
  Removal other = remove_pits(terrain, options);
  if (other.cost >= result.cost) return result;
  other.bound = result.bound;
  other.is_optimal = other.bound == other.cost;
  return other;
}

std::vector<std::int64_t> star_weights(std::span<const LatticePoint> position,
                                       std::span<const std::uint32_t> triangle_vertex) {
  std::vector<std::int64_t> weight(position.size(), 0);
  for (std::size_t t = 0; t + 3 <= triangle_vertex.size(); t += 3) {
    const LatticePoint a = position[triangle_vertex[t]], b = position[triangle_vertex[t + 1]],
                       c = position[triangle_vertex[t + 2]];
    const std::int64_t doubled = std::abs((std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) -
                                          (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x));
    for (std::size_t i = 0; i < 3; ++i) weight[triangle_vertex[t + i]] += doubled;
  }
  for (auto& w : weight) w = std::max<std::int64_t>(w, 1);
  return weight;
}

}  // namespace hydrotin
