#include "hydrotin/polygon.h"

#include <algorithm>
#include <cassert>
#include <optional>

#include "component_ties.h"
#include "hydrotin/predicates.h"
#include "polygon_program.h"

namespace hydrotin {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

// What two answers for the same polygon are compared by.
struct Score {
  std::uint32_t unserved = 0;
  double weight = 0;
  std::uint32_t foreign = 0;

  friend bool operator<(const Score& a, const Score& b) {
    if (a.unserved != b.unserved) return a.unserved < b.unserved;
    if (a.weight != b.weight) return a.weight < b.weight;
    return a.foreign < b.foreign;
  }
};

}  // namespace

struct PolygonSolver::Impl {
  Objective objective;
  std::uint32_t max_ways;

  const PolygonProblem* problem = nullptr;
  PolygonGraph graph{};
  PolygonProgram<MinWeightRule> min_weight{};
  PolygonProgram<LocalMinimaRule> local_minima{};
  std::vector<std::uint8_t> blocked{}, closed{}, served{};
  std::vector<std::uint32_t> candidate{}, best{};  // numbers of triangles
  std::optional<Score> best_score{};

  [[nodiscard]] std::uint32_t num_wanting() const {
    return static_cast<std::uint32_t>(std::count_if(problem->wants_lower.begin(), problem->wants_lower.end(),
                                                    [](std::uint8_t wants) { return wants != 0; }));
  }

  // Vertices that want and have a lower neighbour over an inner edge of `triangles`.
  std::uint32_t count_served(const std::vector<std::uint32_t>& triangles) {
    served.assign(problem->position.size(), 0);
    for (const std::uint32_t number : triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = graph.triangle(number)[i], b = graph.triangle(number)[(i + 1) % 3];
        if (graph.edge(graph.find(b, a)).is_boundary) continue;
        const bool a_is_lower =
            is_lower(problem->height[a], problem->position[a], problem->height[b], problem->position[b]);
        served[a_is_lower ? b : a] = 1;
      }
    std::uint32_t count = 0;
    for (std::size_t v = 0; v < served.size(); ++v) count += served[v] && problem->wants_lower[v];
    return count;
  }

  Score score_of(const std::vector<std::uint32_t>& triangles) {
    Score score;
    for (const std::uint32_t number : triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = graph.triangle(number)[i], b = graph.triangle(number)[(i + 1) % 3];
        const PolygonEdge& edge = graph.edge(graph.find(b, a));
        if (edge.is_boundary) continue;
        score.foreign += !edge.is_delaunay;
      }
    // The weight as the program added it up: in an order that does not depend on the numbering of corners.
    if (objective == Objective::min_weight) score.weight = min_weight.root_cell()[0].value.weight;
    if (objective == Objective::local_minima) score.unserved = num_wanting() - count_served(triangles);
    return score;
  }

  bool run_program() {
    candidate.clear();
    if (objective == Objective::min_weight) {
      const MinWeightRule rule{*problem, graph};
      if (!min_weight.run(rule, graph, blocked, closed)) return false;
      min_weight.read_back(rule, candidate);
    } else {
      const LocalMinimaRule rule{*problem, graph};
      if (!local_minima.run(rule, graph, blocked, closed)) return false;
      local_minima.read_back(rule, candidate);
    }
    return candidate.size() == problem->delaunay.size();
  }

  // Runs the program with the given ties as slits, and keeps the answer if it is better than the best so far.
  bool try_ties(std::span<const Tie> ties) {
    std::fill(blocked.begin(), blocked.end(), std::uint8_t{0});
    std::fill(closed.begin(), closed.end(), std::uint8_t{0});
    const auto at = [&](std::uint32_t v) { return problem->position[v]; };
    for (const Tie& tie : ties) {
      closed[tie.edge] = closed[tie.twin] = 1;
      const LatticePoint a = at(graph.edge(tie.edge).origin), b = at(graph.edge(tie.edge).target);
      for (std::uint32_t t = 0; t < graph.num_triangles(); ++t)
        for (std::size_t i = 0; i < 3; ++i)
          blocked[t] |= properly_cross(a, b, at(graph.triangle(t)[i]), at(graph.triangle(t)[(i + 1) % 3]));
    }
    if (!run_program()) return false;
    const Score score = score_of(candidate);
    if (best_score && !(score < *best_score)) return false;
    best_score = score;
    best.swap(candidate);
    return true;
  }

  // Ways that may be tried for this polygon: each costs a visit to every triangle.
  [[nodiscard]] std::uint32_t affordable_ways() const {
    constexpr std::uint32_t kTriangleVisits = 1U << 20;
    return std::clamp(kTriangleVisits / graph.num_triangles(), std::uint32_t{1}, max_ways);
  }

  // All ways, counted like the digits of a number; true if they were few enough.
  bool try_all_ways(const ComponentTies& ties, PolygonResult& result) {
    std::uint64_t ways = 1;
    for (std::uint32_t c = 0; c < ties.num_components(); ++c) {
      ways *= ties.begin[c + 1] - ties.begin[c];
      if (ways > affordable_ways()) return false;
    }
    std::vector<Tie> chosen(ties.num_components());
    for (std::uint64_t way = 0; way < ways; ++way) {
      std::uint64_t rest = way;
      for (std::uint32_t c = 0; c < ties.num_components(); ++c) {
        const std::uint32_t count = ties.begin[c + 1] - ties.begin[c];
        chosen[c] = ties.tie[ties.begin[c] + rest % count];
        rest /= count;
      }
      try_ties(chosen);
    }
    result.ways = static_cast<std::uint32_t>(ways);
    return true;
  }

  // Changes one tie at a time from the Delaunay ties on, until no change improves.
  void descend(const ComponentTies& ties, PolygonResult& result) {
    std::vector<Tie> chosen;
    for (std::uint32_t c = 0; c < ties.num_components(); ++c) chosen.push_back(ties.tie[ties.begin[c]]);
    try_ties(chosen);
    result.ways = 1;
    const std::uint32_t most = affordable_ways();
    for (bool improved = true; improved && result.ways < most;) {
      improved = false;
      for (std::uint32_t c = 0; c < ties.num_components() && result.ways < most; ++c)
        for (std::uint32_t i = ties.begin[c]; i < ties.begin[c + 1]; ++i, ++result.ways) {
          const Tie before = chosen[c];
          chosen[c] = ties.tie[i];
          if (try_ties(chosen))
            improved = true;
          else
            chosen[c] = before;
        }
    }
  }

  void solve_general(PolygonResult& result) {
    graph.build(*problem);
    blocked.assign(graph.num_triangles(), 0);
    closed.assign(graph.num_edges(), 0);
    best_score.reset();
    if (problem->components == 0) {
      [[maybe_unused]] const bool solved = run_program();
      assert(solved && "a polygon has at least its Delaunay triangulation");
      best.swap(candidate);
      return;
    }
    const ComponentTies ties = find_component_ties(*problem, graph);
    if (!try_all_ways(ties, result)) {
      descend(ties, result);
      result.optimal = false;
    }
    assert(best_score && "the Delaunay ties always work");
  }

  // Whether a vertex stands on the boundary twice: its two corners may both count the same service.
  [[nodiscard]] bool has_repeated_vertices() const {
    std::size_t sides = 0;
    for (const std::uint8_t mask : problem->fixed) sides += (mask & 1U) + (mask >> 1 & 1U) + (mask >> 2 & 1U);
    return sides != problem->position.size();
  }
};

PolygonSolver::PolygonSolver(Objective objective, std::uint32_t max_ways) : impl_(new Impl{objective, max_ways}) {}
PolygonSolver::~PolygonSolver() = default;
PolygonSolver::PolygonSolver(PolygonSolver&&) noexcept = default;
PolygonSolver& PolygonSolver::operator=(PolygonSolver&&) noexcept = default;

PolygonResult PolygonSolver::solve(const PolygonProblem& problem, Triangles& triangles) {
  Impl& self = *impl_;
  self.problem = &problem;
  PolygonResult result;
  const bool by_minima = self.objective == Objective::local_minima;
  const std::uint32_t wanting = by_minima ? self.num_wanting() : 0;
  const bool keep_delaunay =
      problem.others.empty() || self.objective == Objective::delaunay || (by_minima && wanting == 0);
  if (keep_delaunay) {
    triangles.insert(triangles.end(), problem.delaunay.begin(), problem.delaunay.end());
    return result;
  }
  self.solve_general(result);
  if (by_minima) {
    result.served = self.count_served(self.best);
    if (self.has_repeated_vertices()) result.optimal = false;
    if (result.served == wanting) result.optimal = true;
  }
  for (const std::uint32_t number : self.best) {
    triangles.push_back(self.graph.triangle(number));
    if (number >= problem.delaunay.size())
      result.max_order =
          std::max<std::uint32_t>(result.max_order, problem.others_order[number - problem.delaunay.size()]);
  }
  return result;
}

}  // namespace hydrotin
