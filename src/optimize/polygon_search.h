#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "component_ties.h"
#include "polygon_costs.h"

/// Finds the best triangulation of one polygon for a vector of sums, by the method that fits its components.

namespace hydrotin {

struct PolygonAnswer {
  std::vector<std::uint32_t> triangle;  ///< numbers of triangles, unordered
  SlotValues value{};                   ///< per slot of the costs
};

class PolygonSearch {
 public:
  PolygonSearch();
  ~PolygonSearch();
  PolygonSearch(const PolygonSearch&) = delete;
  PolygonSearch& operator=(const PolygonSearch&) = delete;

  /// Takes a new polygon. Both must live until the next call.
  void start(const PolygonGraph& graph, const PolygonOptions& options);

  /// Whether the polygon is small enough to be searched at all.
  [[nodiscard]] bool is_within_budget() const;

  /// The best answer without blocked triangles; false if there is none, or none was found (then `is_proven` is false).
  bool run(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked, PolygonAnswer& best);

  /// Calls visit(blocked, closed, num_changed) for each way to tie the components, of which the ties of the first
  /// `num_changed` of an order of its own are not those of the way before. Precondition: within budget, not
  /// `is_linear`.
  template <class Visit>
  void for_each_way(const std::vector<std::uint8_t>& blocked, Visit visit);
  /// An answer that is known without search, for the next run of a linear program.
  void offer(std::vector<std::uint32_t> triangles) { incumbent_ = std::move(triangles); }
  /// Whether much work is to be expected: components are left to the linear program, or their ties are many.
  [[nodiscard]] bool is_costly() const { return linear_ || costly_; }
  /// Whether components are left to the linear program.
  [[nodiscard]] bool is_linear() const { return linear_; }

  /// False once a search ended at a budget, or counted a vertex twice: then answers may not be the best.
  [[nodiscard]] bool is_proven() const { return proven_; }
  /// No answer has less than this in the first slot; valid after a run that is not proven.
  [[nodiscard]] double first_bound() const { return first_bound_; }
  [[nodiscard]] std::uint32_t programs() const { return programs_; }

 private:
  struct Programs;

  bool run_ties(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked, PolygonAnswer& best);
  [[nodiscard]] bool is_packable(const PolygonCosts& costs) const;
  void order_components(std::uint64_t num_ways);
  bool run_program(const PolygonCosts& costs, PolygonAnswer& answer);
  bool run_program_again(const PolygonCosts& costs, std::uint32_t num_changed, const SlotValues* to_beat,
                         PolygonAnswer& answer);
  template <class Solve>
  bool answer_of_program(const PolygonCosts& costs, PolygonAnswer& answer, Solve solve);
  template <class Run>
  bool with_program(const PolygonCosts& costs, Run run);
  bool run_linear(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked, PolygonAnswer& best);

  const PolygonGraph* graph_ = nullptr;
  const PolygonOptions* options_ = nullptr;
  ComponentTies ties_;
  TieInfluence influence_;                      // empty: not worth it
  std::vector<std::uint32_t> component_order_;  // of ties; those with the least influence are changed most often
  std::unique_ptr<Programs> programs_of_;
  std::vector<std::uint8_t> blocked_, closed_;
  std::vector<std::uint32_t> incumbent_;
  std::uint32_t size_ = 0;  // triangles of an answer
  std::uint32_t programs_ = 0;
  double first_bound_ = 0;
  bool linear_ = false, costly_ = false, proven_ = true;
};

// All ways, counted like the digits of a number.
template <class Visit>
void PolygonSearch::for_each_way(const std::vector<std::uint8_t>& blocked, Visit visit) {
  std::vector<std::uint32_t> digit(ties_.num_components(), 0);
  std::uint32_t num_changed = ties_.num_components();
  for (;;) {
    blocked_.assign(blocked.begin(), blocked.end());
    closed_.assign(graph_->num_edges(), 0);
    for (std::uint32_t i = 0; i < digit.size(); ++i) {
      const std::uint32_t t = ties_.begin[component_order_[i]] + digit[i];
      closed_[ties_.tie[t].edge] = closed_[ties_.tie[t].twin] = 1;
      for (std::uint32_t b = ties_.blocked_begin[t]; b < ties_.blocked_begin[t + 1]; ++b)
        blocked_[ties_.blocked[b]] = 1;
    }
    visit(blocked_, closed_, num_changed);
    num_changed = 0;
    for (bool carry = true; carry; ++num_changed) {
      if (num_changed == digit.size()) return;
      const std::uint32_t c = component_order_[num_changed];
      carry = ++digit[num_changed] == ties_.begin[c + 1] - ties_.begin[c];
      if (carry) digit[num_changed] = 0;
    }
  }
}

}  // namespace hydrotin
