#include "polygon_search.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "linear_program.h"
#include "sum_rule.h"

namespace hydrotin {
namespace {

constexpr std::uint32_t kTriangleVisits = 1U << 20;  // by all dynamic programs for the ties of one polygon
constexpr std::uint32_t kTriangleVisitsWorthFlips = 1U << 16;
constexpr std::uint64_t kWaysWorthInfluence = 6;
constexpr std::uint32_t kMostTied = 16;  // components; to list the ties of more would take too long

}  // namespace

// One dynamic program per shape of values; their scratch memory is kept.
struct PolygonSearch::Programs {
  template <class Scalar, int Slots, int States>
  struct One {
    using Rule = SumRule<Scalar, Slots, States>;
    PolygonProgram<Rule> program;

    [[nodiscard]] static Rule rule(const PolygonGraph& graph, const PolygonCosts& costs) {
      return {graph.problem(), graph, costs, std::max(0, costs.minima_slot)};
    }
  };

  using Packed = One<std::int64_t, 1, 4>;
  Packed minima;
  One<Wide, 1, 1> sum1;
  One<Wide, 2, 1> sum2;
  One<Wide, 4, 1> sum4;
  One<Wide, kMaxSlots, 1> sum8;
  One<Wide, 4, 4> minima4;
  One<Wide, kMaxSlots, 4> minima8;
};

PolygonSearch::PolygonSearch() : programs_of_(std::make_unique<Programs>()) {}
PolygonSearch::~PolygonSearch() = default;

void PolygonSearch::start(const PolygonGraph& graph, const PolygonOptions& options) {
  graph_ = &graph;
  options_ = &options;
  const PolygonProblem& problem = graph.problem();
  size_ = problem.rim.empty() ? static_cast<std::uint32_t>(problem.delaunay.size()) : problem.num_triangles;
  programs_ = 0;
  first_bound_ = -std::numeric_limits<double>::infinity();
  proven_ = true;
  ties_ = {};
  incumbent_.clear();
  linear_ = options.method == ComponentMethod::linear_program;
  costly_ = false;
  if (problem.components == 0 || linear_ || !is_within_budget()) return;
  if (options.method != ComponentMethod::ties && problem.components > kMostTied) {
    linear_ = true;
    return;
  }
  ties_ = find_component_ties(problem, graph);
  const std::uint64_t affordable = std::min(options.budget.max_ways, kTriangleVisits / graph.num_triangles());
  const std::uint64_t num_ways = ties_.num_ways(affordable);
  linear_ = num_ways > affordable && options.method != ComponentMethod::ties;
  costly_ = num_ways > kTriangleVisitsWorthFlips / graph.num_triangles();
  if (!linear_) order_components(num_ways);
}

void PolygonSearch::order_components(std::uint64_t num_ways) {
  component_order_.resize(ties_.num_components());
  std::iota(component_order_.begin(), component_order_.end(), 0U);
  influence_ = {};
  if (num_ways < kWaysWorthInfluence) return;
  influence_ = influence_of(ties_, *graph_);
  std::stable_sort(component_order_.begin(), component_order_.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return influence_.of(a).size() < influence_.of(b).size(); });
}

bool PolygonSearch::is_within_budget() const {
  if (graph_->num_triangles() > options_->budget.max_triangles || options_->method == ComponentMethod::flips)
    return false;
  return !linear_ || graph_->num_triangles() <= options_->budget.max_program;
}

bool PolygonSearch::run(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked, PolygonAnswer& best) {
  if (linear_) return run_linear(costs, blocked, best);
  closed_.assign(graph_->num_edges(), 0);
  if (graph_->problem().components > 0) return run_ties(costs, blocked, best);
  blocked_.assign(blocked.begin(), blocked.end());
  return run_program(costs, best);
}

// Local minima, then Delaunay edges: in one number of 64 bits.
bool PolygonSearch::is_packable(const PolygonCosts& costs) const {
  return costs.minima_slot == 0 && costs.counts_foreign &&
         graph_->num_triangles() < Programs::Packed::Rule::kMostPacked;
}

// Calls run(program, rule) with those that fit the costs.
template <class Run>
bool PolygonSearch::with_program(const PolygonCosts& costs, Run run) {
  Programs& p = *programs_of_;
  const auto with = [&](auto& one) { return run(one.program, one.rule(*graph_, costs)); };
  if (costs.minima_slot < 0)
    return costs.num_slots == 1   ? with(p.sum1)
           : costs.num_slots == 2 ? with(p.sum2)
           : costs.num_slots <= 4 ? with(p.sum4)
                                  : with(p.sum8);
  if (is_packable(costs)) return with(p.minima);
  return costs.num_slots <= 4 ? with(p.minima4) : with(p.minima8);
}

// `solve` runs the program that it is given and says whether its answer is worth to be read.
template <class Solve>
bool PolygonSearch::answer_of_program(const PolygonCosts& costs, PolygonAnswer& answer, Solve solve) {
  ++programs_;
  answer.triangle.clear();
  const bool solved = with_program(costs, [&](auto& program, const auto& rule) {
    if (!solve(program, rule)) return false;
    program.read_back(rule, answer.triangle);
    return true;
  });
  if (!solved || answer.triangle.size() != size_) return false;
  answer.value = value_of(*graph_, costs, answer.triangle);
  return true;
}

bool PolygonSearch::run_program(const PolygonCosts& costs, PolygonAnswer& answer) {
  return answer_of_program(
      costs, answer, [&](auto& program, const auto& rule) { return program.run(rule, *graph_, blocked_, closed_); });
}

// What only other components' ties have an influence on is kept from the run before. The answer is not read if it
// cannot beat a value.
bool PolygonSearch::run_program_again(const PolygonCosts& costs, std::uint32_t num_changed, const SlotValues* to_beat,
                                      PolygonAnswer& answer) {
  return answer_of_program(costs, answer, [&](auto& program, const auto& rule) {
    for (std::uint32_t i = 0; i < num_changed; ++i) program.forget(influence_.of(component_order_[i]));
    return program.run_again(rule, *graph_, blocked_, closed_) &&
           (to_beat == nullptr || rule.best_value(program.root_cell()) < *to_beat);
  });
}

bool PolygonSearch::run_ties(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked, PolygonAnswer& best) {
  bool found = false, first = true;
  PolygonAnswer answer;
  for_each_way(blocked, [&](const auto&, const auto&, std::uint32_t num_changed) {
    const bool again = !first && influence_.begin.size() > 1;
    first = false;
    const bool solved = again ? run_program_again(costs, num_changed, found ? &best.value : nullptr, answer)
                              : run_program(costs, answer);
    if (!solved || (found && !(answer.value < best.value))) return;
    found = true;
    std::swap(best, answer);
  });
  return found;
}

bool PolygonSearch::run_linear(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked,
                               PolygonAnswer& best) {
  LinearOutcome outcome = solve_linear_program(*graph_, costs, blocked, size_, options_->budget.max_branches,
                                               std::exchange(incumbent_, {}));
  programs_ += outcome.programs;
  first_bound_ = outcome.first_bound;
  proven_ = proven_ && outcome.proven;
  if (outcome.triangle.empty()) return false;
  best.triangle = std::move(outcome.triangle);
  best.value = value_of(*graph_, costs, best.triangle);
  return true;
}

}  // namespace hydrotin
