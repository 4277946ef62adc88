#include "quadrilateral_program.h"

#include <algorithm>
#include <limits>

namespace hydrotin {
namespace {

SurfacePoint surface_point(const PolygonGraph& graph, std::uint32_t v) {
  return {graph.problem().position[v], graph.problem().height[v]};
}

bool is_sum(const PolygonOptions& options) {
  return kind_of(options.objectives.front()) == ObjectiveKind::quadrilateral_sum;
}

}  // namespace

BeyondSides sides_beyond(const PolygonGraph& graph) {
  const PolygonProblem& problem = graph.problem();
  BeyondSides out(graph.num_edges());
  if (problem.beyond.empty()) return out;
  for (std::size_t t = 0; t < problem.delaunay.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      if (problem.fixed[t] >> i & 1U)
        out[PolygonGraph::twin(graph.side(static_cast<std::uint32_t>(t), i))] = problem.beyond[3 * t + i];
  return out;
}

double pair_score(const PolygonGraph& graph, const PolygonOptions& options, std::uint32_t e, const SurfacePoint& left,
                  std::uint32_t right) {
  const PolygonEdge& edge = graph.edge(e);
  return quadrilateral_score(options.objectives.front(), surface_point(graph, edge.origin),
                             surface_point(graph, edge.target), left, surface_point(graph, right), options.z_per_xy);
}

double quadrilateral_value(const PolygonGraph& graph, const PolygonOptions& options, const BeyondSides& beyond,
                           const std::vector<std::uint32_t>& triangles) {
  std::vector<std::uint32_t> third(graph.num_edges(), kNoEdge);
  const auto for_sides = [&](auto visit) {
    for (const std::uint32_t t : triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t e = graph.side(t, i);
        visit(e, PolygonGraph::twin(e), graph.triangle(t)[(i + 2) % 3]);
      }
  };
  for_sides([&](std::uint32_t e, std::uint32_t, std::uint32_t apex) { third[e] = apex; });
  double value = is_sum(options) ? 0 : -std::numeric_limits<double>::infinity();
  const auto add = [&](double score) { value = is_sum(options) ? value + score : std::max(value, score); };
  for_sides([&](std::uint32_t e, std::uint32_t twin, std::uint32_t apex) {
    if (third[twin] != kNoEdge) {
      if (e < twin) add(pair_score(graph, options, twin, surface_point(graph, third[twin]), apex));
    } else if (beyond[twin]) {
      add(pair_score(graph, options, twin, *beyond[twin], apex));
    }
  });
  return value;
}

// Fills the states of the options of one edge after another; the cells of the edges hold nothing.
struct QuadrilateralProgram::Rule {
  using Cell = QuadrilateralProgram::Cell;
  using Cells = WholeCells<Cell>;

  const PolygonGraph& graph;
  const PolygonOptions& options;
  const BeyondSides& beyond;
  const std::vector<std::uint8_t>& blocked;
  const std::vector<std::uint8_t>& closed;
  std::vector<State>& state;
  double limit = std::numeric_limits<double>::infinity();  // pairs beyond it are not allowed
  bool by_limit = false;                                   // the second pass of a bottleneck

  [[nodiscard]] static Cell empty() { return {}; }
  [[nodiscard]] static Cell boundary() { return {}; }
  [[nodiscard]] static int best_state(const Cell&) { return 0; }

  [[nodiscard]] Value combine(Value a, Value b, double score) const {
    if (by_limit) return {0, a.minor + b.minor};
    if (is_sum(options)) return {a.major + b.major + score, a.minor + b.minor};
    return {std::max({a.major, b.major, score}), a.minor + b.minor};
  }

  [[nodiscard]] double neutral() const {
    return is_sum(options) || by_limit ? 0 : -std::numeric_limits<double>::infinity();
  }

  // The best way to go on beyond edge `child` of an option whose third vertex is `right`; kNoEdge at an end.
  bool best_beyond(std::uint32_t child, std::uint32_t right, Value& value, std::uint32_t& choice) const {
    choice = kNoEdge;
    if (graph.edge(child).is_boundary || closed[child]) {
      if (!beyond[child]) return true;
      const double score = pair_score(graph, options, child, *beyond[child], right);
      if (score > limit) return false;
      value = combine(value, {neutral(), 0}, score);
      return true;
    }
    Value best;
    for (std::uint32_t o = graph.edge(child).first_option; o != kNoEdge; o = graph.option(o).next) {
      if (!state[o].possible) continue;
      const std::uint32_t apex = graph.option(o).apex;
      const double score = pair_score(graph, options, child, surface_point(graph, apex), right);
      if (score > limit) continue;
      const Value candidate = combine(value, state[o].value, score);
      if (choice != kNoEdge && !better(candidate, o, best, choice)) continue;
      best = candidate;
      choice = o;
    }
    if (choice == kNoEdge) return false;
    value = best;
    return true;
  }

  [[nodiscard]] bool better(const Value& a, std::uint32_t o, const Value& b, std::uint32_t p) const {
    if (a != b) return a < b;
    const auto at = [&](std::uint32_t option) { return graph.problem().position[graph.option(option).apex]; };
    return at(o) < at(p);
  }

  void improve(Cell&, std::uint32_t o, const Cell&, const Cell&) const {
    const Option& option = graph.option(o);
    const std::uint32_t i = graph.edge(option.left_child).origin, j = graph.edge(option.right_child).target;
    State& s = state[o];
    s.value = {neutral(), graph.foreign_sides(PolygonGraph::triangle_of(o))};
    s.possible =
        best_beyond(option.left_child, j, s.value, s.left) && best_beyond(option.right_child, i, s.value, s.right);
  }
};

bool QuadrilateralProgram::pass(Rule& rule, const PolygonGraph& graph, const std::vector<std::uint8_t>& blocked,
                                const std::vector<std::uint8_t>& closed) {
  state_.assign(graph.num_options(), {});
  PolygonProgram<Rule> order;
  order.run(rule, graph, OneWay(graph, closed), blocked);
  best_ = kNoEdge;
  Value best;
  const std::uint32_t root = graph.root();
  const std::uint32_t outside = PolygonGraph::twin(root);
  for (std::uint32_t o = graph.edge(root).first_option; o != kNoEdge; o = graph.option(o).next) {
    if (!state_[o].possible) continue;
    Value value = state_[o].value;
    std::uint32_t end = kNoEdge;
    if (!rule.best_beyond(outside, graph.option(o).apex, value, end)) continue;
    if (best_ != kNoEdge && !rule.better(value, o, best, best_)) continue;
    best_ = o;
    best = value;
  }
  if (best_ != kNoEdge && !rule.by_limit) value_ = rule.limit = best.major;
  return best_ != kNoEdge;
}

bool QuadrilateralProgram::run(const PolygonGraph& graph, const PolygonOptions& options, const BeyondSides& beyond,
                               const std::vector<std::uint8_t>& blocked, const std::vector<std::uint8_t>& closed,
                               std::vector<std::uint32_t>& triangles) {
  Rule rule{graph, options, beyond, blocked, closed, state_};
  if (!pass(rule, graph, blocked, closed)) return false;
  if (!is_sum(options)) {
    rule.by_limit = true;
    pass(rule, graph, blocked, closed);
  }
  triangles.clear();
  read_back(best_, triangles);
  return true;
}

void QuadrilateralProgram::read_back(std::uint32_t root_option, std::vector<std::uint32_t>& triangles) const {
  std::vector<std::uint32_t> trail{root_option};
  while (!trail.empty()) {
    const std::uint32_t o = trail.back();
    trail.pop_back();
    triangles.push_back(PolygonGraph::triangle_of(o));
    for (const std::uint32_t child : {state_[o].left, state_[o].right})
      if (child != kNoEdge) trail.push_back(child);
  }
}

}  // namespace hydrotin
