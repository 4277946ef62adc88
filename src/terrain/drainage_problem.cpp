#include "hydrotin/drainage_problem.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>

#include "min_heap.h"

namespace hydrotin {

std::int64_t cost_of(const DrainageProblem& problem, std::span<const std::int32_t> surface, ChangeMeasure measure) {
  assert(surface.size() == problem.height.size() && "one height per member");
  std::int64_t cost = 0;
  for (std::uint32_t v = 0; v < problem.size(); ++v) {
    const std::int64_t moved = std::abs(std::int64_t{surface[v]} - problem.height[v]);
    switch (measure) {
      case ChangeMeasure::total:
      case ChangeMeasure::volume:
        cost += moved * problem.weight_of(v);
        break;
      case ChangeMeasure::max:
        cost = std::max(cost, moved);
        break;
      case ChangeMeasure::count:
        cost += moved != 0;
        break;
    }
  }
  return cost;
}

std::vector<std::int32_t> lift(const DrainageProblem& problem, std::span<const std::int32_t> surface) {
  assert(surface.size() == problem.height.size() && "one height per member");
  const auto key = [](std::int32_t level, std::uint32_t v) {
    return (std::uint64_t{static_cast<std::uint32_t>(level) ^ 0x80000000u} << 32) | v;
  };
  std::vector<std::int32_t> level(surface.size(), kNoLevel);
  MinHeap heap;
  for (std::uint32_t v = 0; v < problem.size(); ++v) {
    if (problem.exit[v] == kNoLevel) continue;
    level[v] = std::max(problem.exit[v], surface[v]);
    heap.push(key(level[v], v));
  }
  std::vector<std::uint32_t> pool;  // reached at the level of the water: no need to queue
  while (!heap.empty()) {
    const std::uint64_t top = heap.pop();
    if (top != key(level[static_cast<std::uint32_t>(top)], static_cast<std::uint32_t>(top))) continue;
    pool.push_back(static_cast<std::uint32_t>(top));
    while (!pool.empty()) {
      const std::uint32_t v = pool.back();
      pool.pop_back();
      const std::int32_t water = level[v];
      for (const std::uint32_t w : problem.neighbors(v)) {
        const std::int32_t through = std::max(water, surface[w]);
        if (through >= level[w]) continue;
        level[w] = through;
        if (through == water)
          pool.push_back(w);
        else
          heap.push(key(through, w));
      }
    }
  }
  return level;
}

std::vector<std::int32_t> level_of(const DrainageProblem& problem) {
  return problem.level.empty() ? lift(problem, problem.height) : problem.level;
}

bool drains(const DrainageProblem& problem, std::span<const std::int32_t> surface) {
  return std::ranges::equal(lift(problem, surface), surface);
}

}  // namespace hydrotin
