#include "degree_program.h"

#include <limits>

#include "polygon_program.h"

namespace hydrotin {
namespace {

constexpr std::uint32_t kImpossible = std::numeric_limits<std::uint32_t>::max();

struct DegreeRule {
  struct Entry {
    std::uint32_t at_target = kImpossible;  // least number of inner edges at the target
    std::uint32_t option = kNoEdge;
    std::array<std::uint32_t, 2> child_state{};
  };
  using Cell = std::vector<Entry>;  // by number of inner edges allowed at the origin
  using Cells = WholeCells<Cell>;

  const PolygonGraph& graph;
  const std::vector<std::uint8_t>& closed;
  std::uint32_t most;

  [[nodiscard]] Cell empty() const { return Cell(most + 1); }
  [[nodiscard]] Cell boundary() const { return Cell(most + 1, Entry{0, kNoEdge, {}}); }
  [[nodiscard]] static const Entry& entry(const Cell& cell, std::uint32_t, int state) {
    return cell[static_cast<std::size_t>(state)];
  }
  [[nodiscard]] std::uint32_t base(std::uint32_t v) const {
    return graph.problem().base_degree.empty() ? 0 : graph.problem().base_degree[v];
  }

  void improve(Cell& cell, std::uint32_t o, const Cell& left, const Cell& right) const {
    const Option& option = graph.option(o);
    const std::uint32_t inner_l = is_inner(option.left_child), inner_r = is_inner(option.right_child);
    const std::uint32_t taken = base(option.apex) + inner_l + inner_r;
    if (taken > most) return;
    for (std::uint32_t allowed = inner_l; allowed <= most; ++allowed) {
      const std::uint32_t at_apex = left[allowed - inner_l].at_target;
      if (at_apex == kImpossible || at_apex > most - taken) continue;
      const std::uint32_t rest = most - taken - at_apex, at_target = right[rest].at_target;
      if (at_target == kImpossible || at_target + inner_r > most) continue;
      Entry& entry = cell[allowed];
      const std::uint32_t needed = at_target + inner_r;
      if (entry.option != kNoEdge &&
          (entry.at_target < needed || (entry.at_target == needed && !earlier(o, entry.option))))
        continue;
      entry = {needed, o, {allowed - inner_l, rest}};
    }
  }

  // A closed edge would be counted from both sides: it is left out, so that what the program rules out is impossible.
  [[nodiscard]] std::uint32_t is_inner(std::uint32_t e) const { return !graph.edge(e).is_boundary && !closed[e]; }

  [[nodiscard]] bool earlier(std::uint32_t o, std::uint32_t p) const {
    const auto at = [&](std::uint32_t option) { return graph.problem().position[graph.option(option).apex]; };
    return at(o) < at(p);
  }

  [[nodiscard]] int best_state(const Cell& cell) const {
    const PolygonEdge& root = graph.edge(graph.root());
    for (std::uint32_t allowed = 0; base(root.origin) + allowed <= most; ++allowed)
      if (cell[allowed].at_target != kImpossible && base(root.target) + cell[allowed].at_target <= most)
        return static_cast<int>(allowed);
    return -1;
  }
};

}  // namespace

std::vector<std::uint32_t> degrees(const PolygonGraph& graph, const std::vector<std::uint32_t>& triangles) {
  const PolygonProblem& problem = graph.problem();
  std::vector<std::uint32_t> degree(problem.position.size(), 0);
  if (!problem.base_degree.empty()) degree.assign(problem.base_degree.begin(), problem.base_degree.end());
  for (const std::uint32_t number : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t e = graph.side(number, i);
      // An inner edge is met from both sides, once in each direction.
      if (graph.is_inner(e)) ++degree[graph.edge(e).origin];
    }
  return degree;
}

bool triangulate_with_degree(const PolygonGraph& graph, std::uint32_t most, const std::vector<std::uint8_t>& blocked,
                             const std::vector<std::uint8_t>& closed, std::vector<std::uint32_t>& triangles) {
  const DegreeRule rule{graph, closed, most};
  PolygonProgram<DegreeRule> program;
  const OneWay way(graph, closed);
  if (!program.run(rule, graph, way, blocked)) return false;
  triangles.clear();
  program.read_back(
      rule, way, [&](std::uint32_t o, const DegreeRule::Entry&) { triangles.push_back(PolygonGraph::triangle_of(o)); });
  return true;
}

}  // namespace hydrotin
