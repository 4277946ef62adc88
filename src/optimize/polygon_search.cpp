#include "polygon_search.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "linear_program.h"
#include "sum_rule.h"

namespace hydrotin {
namespace {

constexpr std::uint32_t kTriangleVisits = 1U << 20;  // by all dynamic programs for the ties of one polygon
constexpr std::uint32_t kMostTied = 16;              // components; to list the ties of more would take too long

}  // namespace

// One dynamic program per shape of values; their scratch memory is kept.
struct PolygonSearch::Programs {
  template <class Scalar, int Slots, int States>
  struct One {
    using Scalar_ = Scalar;
    PolygonProgram<SumRule<Scalar, Slots, States>> program;

    bool run(const PolygonGraph& graph, const PolygonCosts& costs, std::array<Scalar, 3> gain,
             const std::vector<std::uint8_t>& blocked, const std::vector<std::uint8_t>& closed,
             std::vector<std::uint32_t>& triangles) {
      const SumRule<Scalar, Slots, States> rule{graph.problem(), graph, costs, gain, std::max(0, costs.minima_slot)};
      if (!program.run(rule, graph, blocked, closed)) return false;
      triangles.clear();
      program.read_back(rule, triangles);
      return true;
    }
  };

  One<std::int64_t, 2, 4> minima;
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
  if (problem.components == 0 || linear_ || !is_within_budget()) return;
  if (options.method != ComponentMethod::ties && problem.components > kMostTied) {
    linear_ = true;
    return;
  }
  ties_ = find_component_ties(problem, graph);
  if (options.method == ComponentMethod::ties) return;
  const std::uint64_t affordable = std::min(options.max_ways, kTriangleVisits / graph.num_triangles());
  linear_ = ties_.num_ways(affordable) > affordable;
}

bool PolygonSearch::is_within_budget() const {
  if (graph_->num_triangles() > options_->max_triangles || options_->method == ComponentMethod::flips) return false;
  return !linear_ || graph_->num_triangles() <= options_->max_program;
}

bool PolygonSearch::run(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked, PolygonAnswer& best) {
  if (linear_) return run_linear(costs, blocked, best);
  closed_.assign(graph_->num_edges(), 0);
  if (graph_->problem().components > 0) return run_ties(costs, blocked, best);
  blocked_.assign(blocked.begin(), blocked.end());
  return run_program(costs, best);
}

bool PolygonSearch::run_program(const PolygonCosts& costs, PolygonAnswer& answer) {
  ++programs_;
  Programs& p = *programs_of_;
  const auto run_one = [&](auto& one) {
    using Scalar = typename std::decay_t<decltype(one)>::Scalar_;
    return one.run(
        *graph_, costs,
        {Scalar{0}, static_cast<Scalar>(PolygonCosts::kGain[1]), static_cast<Scalar>(PolygonCosts::kGain[2])}, blocked_,
        closed_, answer.triangle);
  };
  bool solved = false;
  if (costs.minima_slot < 0) {
    solved = costs.num_slots == 1   ? run_one(p.sum1)
             : costs.num_slots == 2 ? run_one(p.sum2)
             : costs.num_slots <= 4 ? run_one(p.sum4)
                                    : run_one(p.sum8);
  } else if (costs.minima_slot == 0 && costs.num_slots <= 2 && graph_->num_triangles() < (1U << 20)) {
    solved = run_one(p.minima);  // gains and counts of edges fit 64 bits
  } else {
    solved = costs.num_slots <= 4 ? run_one(p.minima4) : run_one(p.minima8);
  }
  if (!solved || answer.triangle.size() != size_) return false;
  answer.value = value_of(*graph_, costs, answer.triangle);
  return true;
}

bool PolygonSearch::run_ties(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked, PolygonAnswer& best) {
  bool found = false;
  PolygonAnswer answer;
  for_each_way(blocked, [&](const auto&, const auto&) {
    if (!run_program(costs, answer) || (found && !(answer.value < best.value))) return;
    found = true;
    std::swap(best, answer);
  });
  return found;
}

bool PolygonSearch::run_linear(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked,
                               PolygonAnswer& best) {
  LinearOutcome outcome =
      solve_linear_program(*graph_, costs, blocked, size_, options_->max_branches, std::exchange(incumbent_, {}));
  programs_ += outcome.programs;
  first_bound_ = outcome.first_bound;
  proven_ = proven_ && outcome.proven;
  if (outcome.triangle.empty()) return false;
  best.triangle = std::move(outcome.triangle);
  best.value = value_of(*graph_, costs, best.triangle);
  return true;
}

}  // namespace hydrotin
