#include "polygon_search.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <numeric>
#include <utility>

#include "double_counts.h"
#include "linear_program.h"
#include "sum_rule.h"

namespace hydrotin {
namespace {

constexpr std::uint32_t kTriangleVisits = 1U << 20;           // by the dynamic programs for the ties of one polygon
constexpr std::uint32_t kVisitsWorthFlips = 4;                // of each triangle
constexpr std::uint32_t kTriangleVisitsForCounts = 1U << 16;  // by the programs for vertices that were counted twice

}  // namespace

// One dynamic program per shape of values; their scratch memory is kept.
struct PolygonSearch::Programs {
  template <class Scalar, int Slots, int States>
  struct One {
    using Rule = SumRule<Scalar, Slots, States>;
    PolygonProgram<Rule> program;

    [[nodiscard]] static Rule rule(const PolygonGraph& graph, const PolygonCosts& costs,
                                   std::span<const std::uint8_t> wishes) {
      return {graph.problem(), graph, costs, wishes, std::max(0, costs.minima_slot)};
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
  few_ways_ = !linear_;
  if (problem.components == 0 || linear_ || !is_within_budget()) return;
  const bool only_ties = options.method == ComponentMethod::ties;
  const std::uint64_t affordable =
      std::min<std::uint64_t>(options.budget.max_ways, kTriangleVisits / graph.num_triangles());
  ties_ = find_component_ties(problem, graph);
  few_ways_ = only_ties || ties_.num_ways(affordable) <= affordable;
  linear_ = !ways_.build(problem, graph, ties_, only_ties ? TieWays::kMostWays : options.budget.max_ways,
                         only_ties ? TieWays::kMostVisits : kTriangleVisits);
  costly_ = !linear_ && ways_.num_visits() > std::uint64_t{kVisitsWorthFlips} * graph.num_triangles();
}

bool PolygonSearch::is_within_budget() const {
  if (graph_->num_triangles() > options_->budget.max_triangles || options_->method == ComponentMethod::flips)
    return false;
  return !linear_ || graph_->num_triangles() <= options_->budget.max_program;
}

bool PolygonSearch::run(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked, PolygonAnswer& best) {
  return linear_ ? run_linear(costs, blocked, best) : run_program(costs, blocked, best);
}

// Local minima, then Delaunay edges: in one number of 64 bits.
bool PolygonSearch::is_packable(const PolygonCosts& costs) const {
  return costs.minima_slot == 0 && costs.counts_foreign &&
         graph_->num_triangles() < Programs::Packed::Rule::kMostPacked;
}

// Calls run(program, rule) with those that fit the costs.
template <class Run>
bool PolygonSearch::with_program(const PolygonCosts& costs, std::span<const std::uint8_t> wishes, Run run) {
  Programs& p = *programs_of_;
  const auto with = [&](auto& one) { return run(one.program, one.rule(*graph_, costs, wishes)); };
  if (costs.minima_slot < 0)
    return costs.num_slots == 1   ? with(p.sum1)
           : costs.num_slots == 2 ? with(p.sum2)
           : costs.num_slots <= 4 ? with(p.sum4)
                                  : with(p.sum8);
  if (is_packable(costs)) return with(p.minima);
  return costs.num_slots <= 4 ? with(p.minima4) : with(p.minima8);
}

bool PolygonSearch::run_counted(const PolygonCosts& costs, std::span<const std::uint8_t> wishes,
                                const std::vector<std::uint8_t>& blocked, CountedAnswer& out) {
  ++programs_;
  out.answer.triangle.clear();
  out.counted_twice.clear();
  count_.assign(graph_->problem().position.size(), 0);
  const auto count = [&](std::uint32_t v) {
    if (++count_[v] == 2) out.counted_twice.push_back(v);
  };
  const bool solved = with_program(costs, wishes, [&](auto& program, const auto& rule) {
    const auto in_ways = [&](const auto& ways) {
      if (!program.run(rule, *graph_, ways, blocked)) return false;
      program.read_back(rule, ways, [&](std::uint32_t o, const auto& entry) {
        const Option& option = graph_->option(o);
        out.answer.triangle.push_back(PolygonGraph::triangle_of(o));
        if (costs.minima_slot >= 0 && rule.counts_apex(o, entry)) count(option.apex);
      });
      for (const std::uint32_t v : rule.counted_ends(program.root_cell())) count(v);
      out.claimed = rule.best_value(program.root_cell());
      return true;
    };
    if (graph_->problem().components > 0) return in_ways(ways_);
    return in_ways(OneWay(*graph_));
  });
  if (!solved || out.answer.triangle.size() != size_) return false;
  // The program counts what is served in its answer; by the wishes of the polygon and once for each vertex, it counts
  // right.
  const bool is_right = out.counted_twice.empty() && wishes.data() == graph_->problem().wants_lower.data();
  assert(!is_right || out.claimed == value_of(*graph_, costs, out.answer.triangle));
  out.answer.value = is_right ? out.claimed : value_of(*graph_, costs, out.answer.triangle);
  return true;
}

bool PolygonSearch::serves_all(const PolygonAnswer& answer) const {
  Wide all = 0;
  for (const std::uint8_t wish : graph_->problem().wants_lower) all += PolygonCosts::kGain[wish];
  return answer.value[0] == -all;
}

bool PolygonSearch::run_program(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked,
                                PolygonAnswer& best) {
  const std::span<const std::uint8_t> wishes = graph_->problem().wants_lower;
  CountedAnswer& root = counted_;
  if (!run_counted(costs, wishes, blocked, root)) return false;
  std::swap(best, root.answer);
  // Nothing can be better, or nothing can serve more.
  if (costs.minima_slot < 0 || best.value == root.claimed || (costs.counts_foreign && serves_all(best))) return true;
  const auto program = [&](std::span<const std::uint8_t> other_wishes, const std::vector<std::uint8_t>& other_blocked,
                           CountedAnswer& out) { return run_counted(costs, other_wishes, other_blocked, out); };
  const std::uint32_t max_programs =
      std::min(options_->budget.max_branches, std::max(1U, kTriangleVisitsForCounts / graph_->num_triangles()));
  if (resolve_double_counts(*graph_, costs, blocked, program, max_programs, root, best)) return true;
  if (options_->method == ComponentMethod::automatic && graph_->num_triangles() <= options_->budget.max_program) {
    offer(best.triangle);
    return run_linear(costs, blocked, best);
  }
  first_bound_ = from_fixed(root.claimed[0]);
  proven_ = false;
  return true;
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
