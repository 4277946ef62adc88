#include "hydrotin/drainage_problem.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>

#include "flood.h"

namespace hydrotin {

std::int64_t cost_of(const DrainageProblem& problem, std::span<const std::int32_t> surface, ChangeMeasure measure) {
  assert(surface.size() == problem.height.size() && "one height per member");
  const auto moved = [&](std::uint32_t v) { return std::abs(std::int64_t{surface[v]} - problem.height[v]); };
  std::int64_t cost = 0;
  switch (measure) {
    case ChangeMeasure::total:
    case ChangeMeasure::volume:
      if (problem.weight.empty())
        for (std::uint32_t v = 0; v < problem.size(); ++v) cost += moved(v);
      else
        for (std::uint32_t v = 0; v < problem.size(); ++v) cost += moved(v) * problem.weight[v];
      break;
    case ChangeMeasure::max:
      for (std::uint32_t v = 0; v < problem.size(); ++v) cost = std::max(cost, moved(v));
      break;
    case ChangeMeasure::count:
      for (std::uint32_t v = 0; v < problem.size(); ++v) cost += moved(v) != 0;
      break;
  }
  return cost;
}

std::vector<std::int32_t> lift(const DrainageProblem& problem, std::span<const std::int32_t> surface) {
  assert(surface.size() == problem.height.size() && "one height per member");
  std::vector<std::int32_t> level(surface.begin(), surface.end());
  Flood flood(problem, level);
  for (std::uint32_t v = 0; v < problem.size(); ++v) {
    if (problem.exit[v] == kNoLevel) continue;
    if (problem.exit[v] <= surface[v])
      flood.add_source(v, surface[v]);
    else
      flood.add_inlet(v, problem.exit[v]);
  }
  flood.run(NoVisitor());
  return level;
}

std::vector<std::int32_t> level_of(const DrainageProblem& problem) {
  return problem.level.empty() ? lift(problem, problem.height) : problem.level;
}

bool drains(const DrainageProblem& problem, std::span<const std::int32_t> surface) {
  assert(surface.size() == problem.height.size() && "one height per member");
  // Members with an exit or a lower neighbour lead on; the others must be joined to one of these by their flats.
  std::vector<std::uint32_t> waiting, open;
  for (std::uint32_t v = 0; v < problem.size(); ++v) {
    if (problem.exit[v] <= surface[v]) continue;
    if (std::ranges::none_of(problem.neighbors(v), [&](std::uint32_t w) { return surface[w] < surface[v]; }))
      waiting.push_back(v);
  }
  if (waiting.empty()) return true;
  std::vector<bool> is_waiting(problem.size());
  for (const std::uint32_t v : waiting) is_waiting[v] = true;
  std::size_t num_left = waiting.size();
  const auto leads_on = [&](std::uint32_t v) {
    return std::ranges::any_of(problem.neighbors(v),
                               [&](std::uint32_t w) { return surface[w] == surface[v] && !is_waiting[w]; });
  };
  for (const std::uint32_t seed : waiting) {
    if (!is_waiting[seed] || !leads_on(seed)) continue;
    is_waiting[seed] = false;
    open.assign(1, seed);
    while (!open.empty()) {
      const std::uint32_t v = open.back();
      open.pop_back();
      --num_left;
      for (const std::uint32_t w : problem.neighbors(v)) {
        if (!is_waiting[w] || surface[w] != surface[v]) continue;
        is_waiting[w] = false;
        open.push_back(w);
      }
    }
  }
  return num_left == 0;
}

}  // namespace hydrotin
