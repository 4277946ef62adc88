#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/drainage_problem.h"

namespace hydrotin {

/// A problem with a surface that changes, as `BreachSearch` sees it.
struct ProblemGround {
  const DrainageProblem* problem;
  const std::vector<std::int32_t>* surface;
  ChangeMeasure measure;
  std::int64_t max_depth;

  [[nodiscard]] std::span<const std::uint32_t> neighbors(std::uint32_t v) const { return problem->neighbors(v); }
  [[nodiscard]] std::int64_t cost(std::uint32_t v, std::int32_t level) const {
    if ((*surface)[v] <= level) return 0;
    if (std::int64_t{problem->height[v]} - level > max_depth) return -1;
    if (!problem->lower.empty() && problem->lower[v] > level) return -1;
    if (measure == ChangeMeasure::count) return (*surface)[v] == problem->height[v];
    return (std::int64_t{(*surface)[v]} - level) * problem->weight_of(v);
  }
  [[nodiscard]] bool is_goal(std::uint32_t v, std::int32_t level) const { return (*surface)[v] < level; }
  [[nodiscard]] bool is_exit(std::uint32_t v, std::int32_t level) const { return problem->exit[v] <= level; }
  [[nodiscard]] static bool before(std::uint32_t v, std::uint32_t w) { return v < w; }
};

/// A plateau of a surface from which water cannot leave without rising.
struct LocalPit {
  std::int32_t height, spill;        // spill: the level from which it can
  std::uint32_t first;               // smallest member
  std::uint32_t begin = 0, end = 0;  // of its plateau
};

struct LocalPits {
  std::vector<LocalPit> pit;  ///< ascending by their smallest members
  std::vector<std::uint32_t> plateau;

  [[nodiscard]] std::span<const std::uint32_t> vertices(const LocalPit& p) const {
    return {plateau.data() + p.begin, plateau.data() + p.end};
  }
};

/// @param level  `lift` of the surface.
/// @param pits   filled.
inline void find_local_pits(const DrainageProblem& problem, std::span<const std::int32_t> surface,
                            std::span<const std::int32_t> level, LocalPits& pits) {
  pits.pit.clear();
  pits.plateau.clear();
  std::vector<bool> is_seen(problem.size());
  for (std::uint32_t v = 0; v < problem.size(); ++v) {
    if (is_seen[v] || level[v] == surface[v]) continue;
    const auto begin = static_cast<std::uint32_t>(pits.plateau.size());
    pits.plateau.push_back(v);
    is_seen[v] = true;
    bool is_pit = true;
    for (std::size_t next = begin; next < pits.plateau.size(); ++next)
      for (const std::uint32_t w : problem.neighbors(pits.plateau[next])) {
        is_pit &= surface[w] >= surface[v];
        if (surface[w] != surface[v] || is_seen[w]) continue;
        is_seen[w] = true;
        pits.plateau.push_back(w);
      }
    if (is_pit)
      pits.pit.push_back({surface[v], level[v], v, begin, static_cast<std::uint32_t>(pits.plateau.size())});
    else
      pits.plateau.resize(begin);
  }
}

inline LocalPits find_local_pits(const DrainageProblem& problem, std::span<const std::int32_t> surface,
                                 std::span<const std::int32_t> level) {
  LocalPits pits;
  find_local_pits(problem, surface, level, pits);
  return pits;
}

}  // namespace hydrotin
