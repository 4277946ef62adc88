#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "component_ties.h"
#include "polygon_costs.h"
#include "tie_ways.h"

/// Finds the best triangulation of one polygon for a vector of sums, by the method that fits its components.

namespace hydrotin {

struct PolygonAnswer {
  std::vector<std::uint32_t> triangle;  ///< numbers of triangles, unordered
  SlotValues value{};                   ///< per slot of the costs
};

/// An answer of a dynamic program, and what it takes its value for.
struct CountedAnswer {
  PolygonAnswer answer;
  SlotValues claimed{};                      ///< less than the value if vertices are counted twice
  std::vector<std::uint32_t> counted_twice;  ///< vertices
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

  /// Calls visit(blocked, closed) for each way to tie all components, for measures that need the whole polygon in one
  /// way. Precondition: within budget, `has_few_ways`.
  template <class Visit>
  void for_each_way(const std::vector<std::uint8_t>& blocked, Visit visit);
  [[nodiscard]] bool has_few_ways() const { return few_ways_; }

  /// An answer that is known without search, for the next run of a linear program.
  void offer(std::vector<std::uint32_t> triangles) { incumbent_ = std::move(triangles); }
  /// Whether much work is to be expected: components are left to the linear program, or their ties are many.
  [[nodiscard]] bool is_costly() const { return linear_ || costly_; }

  /// False once a search ended at a budget: then answers may not be the best.
  [[nodiscard]] bool is_proven() const { return proven_; }
  /// No answer has less than this in the first slot; valid after a run that is not proven.
  [[nodiscard]] double first_bound() const { return first_bound_; }
  [[nodiscard]] std::uint32_t programs() const { return programs_; }

 private:
  struct Programs;

  bool run_program(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked, PolygonAnswer& best);
  bool run_counted(const PolygonCosts& costs, std::span<const std::uint8_t> wishes,
                   const std::vector<std::uint8_t>& blocked, CountedAnswer& out);
  [[nodiscard]] bool serves_all(const PolygonAnswer& answer) const;
  bool run_linear(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked, PolygonAnswer& best);
  [[nodiscard]] bool is_packable(const PolygonCosts& costs) const;
  template <class Run>
  bool with_program(const PolygonCosts& costs, std::span<const std::uint8_t> wishes, Run run);

  const PolygonGraph* graph_ = nullptr;
  const PolygonOptions* options_ = nullptr;
  ComponentTies ties_;
  TieWays ways_;
  std::unique_ptr<Programs> programs_of_;
  std::vector<std::uint8_t> blocked_, closed_;
  CountedAnswer counted_;
  std::vector<std::uint8_t> count_;  // [n] corners at which a vertex is counted as served
  std::vector<std::uint32_t> incumbent_;
  std::uint32_t size_ = 0;  // triangles of an answer
  std::uint32_t programs_ = 0;
  double first_bound_ = 0;
  bool linear_ = false, costly_ = false, few_ways_ = true, proven_ = true;
};

// All ways, counted like the digits of a number.
template <class Visit>
void PolygonSearch::for_each_way(const std::vector<std::uint8_t>& blocked, Visit visit) {
  std::vector<std::uint32_t> digit(ties_.num_components(), 0);
  for (;;) {
    blocked_.assign(blocked.begin(), blocked.end());
    closed_.assign(graph_->num_edges(), 0);
    for (std::uint32_t c = 0; c < digit.size(); ++c) {
      const std::uint32_t t = ties_.begin[c] + digit[c];
      closed_[ties_.tie[t].edge] = closed_[ties_.tie[t].twin] = 1;
      for (std::uint32_t b = ties_.blocked_begin[t]; b < ties_.blocked_begin[t + 1]; ++b)
        blocked_[ties_.blocked[b]] = 1;
    }
    visit(blocked_, closed_);
    std::uint32_t c = 0;
    while (c < digit.size() && ++digit[c] == ties_.num_ties(c)) digit[c++] = 0;
    if (c == digit.size()) return;
  }
}

}  // namespace hydrotin
