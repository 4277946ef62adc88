#include "hydrotin/pit_edits.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <tuple>

#include "hydrotin/drainage_forest.h"
#include "local_pits.h"

namespace hydrotin {
namespace {

void find_regions(const DrainageProblem& problem, std::span<const std::int32_t> surface, PitEdits& edits) {
  std::vector<bool> is_seen(problem.size());
  for (std::uint32_t seed = 0; seed < problem.size(); ++seed) {
    if (is_seen[seed] || surface[seed] <= problem.height[seed]) continue;
    const std::size_t begin = edits.region_vertex.size();
    LiftedRegion region{surface[seed], seed, 0, 0};
    edits.region_vertex.push_back(seed);
    is_seen[seed] = true;
    for (std::size_t next = begin; next < edits.region_vertex.size(); ++next) {
      const std::uint32_t v = edits.region_vertex[next];
      region.displacement += std::int64_t{surface[v]} - problem.height[v];
      if (std::tie(problem.height[v], v) < std::tie(problem.height[region.lowest], region.lowest)) region.lowest = v;
      for (const std::uint32_t w : problem.neighbors(v)) {
        if (is_seen[w] || surface[w] != region.level || surface[w] <= problem.height[w]) continue;
        is_seen[w] = true;
        edits.region_vertex.push_back(w);
      }
    }
    std::sort(edits.region_vertex.begin() + static_cast<std::ptrdiff_t>(begin), edits.region_vertex.end());
    edits.region.push_back(region);
    edits.region_begin.push_back(static_cast<std::uint32_t>(edits.region_vertex.size()));
  }
}

/// Follows the water from vertices down to where no lowered vertex is ahead.
class BreachFollower {
 public:
  BreachFollower(const DrainageProblem& problem, std::span<const std::int32_t> surface, ProblemEdits& result)
      : problem_(&problem), surface_(surface), result_(&result), is_taken_(problem.size()), is_ahead_(problem.size()) {
    ForestFinder(problem).run(surface, forest_);
    for (const std::uint32_t v : forest_.order) {
      const std::uint32_t p = forest_.parent[v];
      is_ahead_[v] = is_lowered(v) || (p != kRoot && is_ahead_[p]);
    }
  }

  [[nodiscard]] bool is_lowered(std::uint32_t v) const { return surface_[v] < problem_->height[v]; }
  [[nodiscard]] bool is_taken(std::uint32_t v) const { return is_taken_[v]; }
  [[nodiscard]] const DrainageForest& forest() const { return forest_; }

  void follow(std::uint32_t start, std::uint32_t pit) {
    if (!is_ahead_[start]) return;
    PitEdits& edits = result_->edits;
    Breach breach;
    breach.pit = pit;
    bool leaves = false;
    for (std::uint32_t v = start;;) {
      edits.breach_vertex.push_back(v);
      const bool ends = is_taken_[v] || !is_ahead_[v];
      if (ends) break;
      is_taken_[v] = true;
      if (is_lowered(v)) {
        const std::int32_t depth = problem_->height[v] - surface_[v];
        breach.displacement += depth;
        breach.max_depth = std::max(breach.max_depth, depth);
      }
      leaves = forest_.parent[v] == kRoot;
      if (leaves) break;
      v = forest_.parent[v];
    }
    edits.breach.push_back(breach);
    edits.breach_begin.push_back(static_cast<std::uint32_t>(edits.breach_vertex.size()));
    result_->leaves.push_back(leaves);
  }

 private:
  const DrainageProblem* problem_;
  std::span<const std::int32_t> surface_;
  ProblemEdits* result_;
  DrainageForest forest_;
  std::vector<bool> is_taken_, is_ahead_;
};

void find_breaches(const DrainageProblem& problem, std::span<const std::int32_t> surface, ProblemEdits& result) {
  BreachFollower follower(problem, surface, result);
  LocalPits pits = find_local_pits(problem, problem.height, level_of(problem));
  std::sort(pits.pit.begin(), pits.pit.end(), [](const LocalPit& a, const LocalPit& b) {
    return std::tie(a.height, a.first) < std::tie(b.height, b.first);
  });
  for (const LocalPit& pit : pits.pit)
    if (!follower.is_taken(pit.first)) follower.follow(pit.first, pit.first);
  const auto& order = follower.forest().order;  // upstream first: the longest chains
  for (std::size_t i = order.size(); i-- > 0;)
    if (follower.is_lowered(order[i]) && !follower.is_taken(order[i])) follower.follow(order[i], kNoVertexNumber);
}

double distance(LatticePoint a, LatticePoint b) {
  const double x = static_cast<double>(a.x) - b.x, y = static_cast<double>(a.y) - b.y;
  return std::sqrt(x * x + y * y);
}

/// The lowest neighbour outside the component, ties by (x, y).
std::uint32_t lowest_outside(const ChangeableTerrain& terrain, std::span<const std::uint32_t> component_of,
                             std::uint32_t v) {
  std::uint32_t best = kNoVertexNumber;
  for (const std::uint32_t w : terrain.graph->neighbors(v)) {
    if (component_of[w] == component_of[v]) continue;
    if (best == kNoVertexNumber ||
        std::tie(terrain.height[w], terrain.position[w]) < std::tie(terrain.height[best], terrain.position[best]))
      best = w;
  }
  return best;
}

}  // namespace

ProblemEdits find_problem_edits(const DrainageProblem& problem, std::span<const std::int32_t> surface) {
  assert(surface.size() == problem.height.size() && "one height per member");
  ProblemEdits result;
  result.edits.region_begin.push_back(0);
  result.edits.breach_begin.push_back(0);
  find_regions(problem, surface, result.edits);
  find_breaches(problem, surface, result);
  return result;
}

PitEdits find_edits(const ChangeableTerrain& terrain, const PitComponents& components,
                    std::span<const std::int32_t> height, std::span<const std::int64_t> star) {
  assert(height.size() == terrain.height.size() && (star.empty() || star.size() == height.size()));
  PitEdits all;
  all.region_begin.push_back(0);
  all.breach_begin.push_back(0);
  std::vector<std::uint32_t> number(height.size(), kNoVertexNumber), component_of(height.size(), kNoVertexNumber);
  for (std::uint32_t i = 0; i < components.size(); ++i)
    for (std::uint32_t j = components.begin[i]; j < components.begin[i + 1]; ++j)
      component_of[components.member[j]] = i;
  const auto volume_of = [&](std::uint32_t v) {
    return star.empty() ? 0.0 : static_cast<double>(star[v]) * std::abs(double(height[v]) - terrain.height[v]) / 6;
  };
  DrainageProblem problem;
  std::vector<std::int32_t> surface;
  for (std::size_t i = 0; i < components.size(); ++i) {
    const std::uint32_t* const member = components.member.data() + components.begin[i];
    make_problem(terrain, components, i, number, problem);
    surface.clear();
    for (std::uint32_t v = 0; v < problem.size(); ++v) surface.push_back(height[member[v]]);
    if (surface == problem.height) continue;
    const ProblemEdits own = find_problem_edits(problem, surface);
    const PitEdits& edits = own.edits;
    for (std::size_t r = 0; r < edits.region.size(); ++r) {
      LiftedRegion region = edits.region[r];
      region.lowest = member[region.lowest];
      for (std::uint32_t j = edits.region_begin[r]; j < edits.region_begin[r + 1]; ++j) {
        all.region_vertex.push_back(member[edits.region_vertex[j]]);
        region.volume += volume_of(all.region_vertex.back());
      }
      all.region.push_back(region);
      all.region_begin.push_back(static_cast<std::uint32_t>(all.region_vertex.size()));
    }
    for (std::size_t b = 0; b < edits.breach.size(); ++b) {
      Breach breach = edits.breach[b];
      if (breach.pit != kNoVertexNumber) breach.pit = member[breach.pit];
      const std::size_t begin = all.breach_vertex.size();
      for (std::uint32_t j = edits.breach_begin[b]; j < edits.breach_begin[b + 1]; ++j)
        all.breach_vertex.push_back(member[edits.breach_vertex[j]]);
      const std::size_t end =
          all.breach_vertex.size() - (own.leaves[b] ? 0 : 1);  // the last one is another's, or stays
      for (std::size_t j = begin; j < end; ++j)
        if (height[all.breach_vertex[j]] < terrain.height[all.breach_vertex[j]])
          breach.volume += volume_of(all.breach_vertex[j]);
      if (own.leaves[b]) all.breach_vertex.push_back(lowest_outside(terrain, component_of, all.breach_vertex.back()));
      for (std::size_t j = begin + 1; j < all.breach_vertex.size(); ++j)
        breach.length += distance(terrain.position[all.breach_vertex[j - 1]], terrain.position[all.breach_vertex[j]]);
      all.breach.push_back(breach);
      all.breach_begin.push_back(static_cast<std::uint32_t>(all.breach_vertex.size()));
    }
  }
  return all;
}

}  // namespace hydrotin
