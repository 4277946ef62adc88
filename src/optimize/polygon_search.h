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

  /// Calls visit(blocked, closed) for each way to tie the components. Precondition: within budget, not `is_linear`.
  template <class Visit>
  void for_each_way(const std::vector<std::uint8_t>& blocked, Visit visit);
  /// An answer that is known without search, for the next run of a linear program.
  void offer(std::vector<std::uint32_t> triangles) { incumbent_ = std::move(triangles); }
  /// Whether components are left to the linear program.
  [[nodiscard]] bool is_linear() const { return linear_; }

  /// False once a search ended at a budget, or counted a vertex twice: then answers may not be the best.
  [[nodiscard]] bool is_proven() const { return proven_; }
  /// No answer has less than this in the first slot; valid after a run that is not proven.
  [[nodiscard]] double first_bound() const { return first_bound_; }
  [[nodiscard]] std::uint32_t programs() const { return programs_; }

 private:
  struct Programs;
  static constexpr std::uint64_t kMostWays = 0xffffffff;

  bool run_ties(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked, PolygonAnswer& best);
  bool run_program(const PolygonCosts& costs, PolygonAnswer& answer);
  bool run_linear(const PolygonCosts& costs, const std::vector<std::uint8_t>& blocked, PolygonAnswer& best);

  const PolygonGraph* graph_ = nullptr;
  const PolygonOptions* options_ = nullptr;
  ComponentTies ties_;
  std::unique_ptr<Programs> programs_of_;
  std::vector<std::uint8_t> blocked_, closed_;
  std::vector<std::uint32_t> incumbent_;
  std::uint32_t size_ = 0;  // triangles of an answer
  std::uint32_t programs_ = 0;
  double first_bound_ = 0;
  bool linear_ = false, proven_ = true;
};

// All ways, counted like the digits of a number.
template <class Visit>
void PolygonSearch::for_each_way(const std::vector<std::uint8_t>& blocked, Visit visit) {
  const std::uint64_t ways = ties_.num_ways(kMostWays);
  for (std::uint64_t way = 0; way < ways; ++way) {
    blocked_.assign(blocked.begin(), blocked.end());
    closed_.assign(graph_->num_edges(), 0);
    std::uint64_t rest = way;
    for (std::uint32_t c = 0; c < ties_.num_components(); ++c) {
      const std::uint32_t count = ties_.begin[c + 1] - ties_.begin[c];
      const auto t = static_cast<std::uint32_t>(ties_.begin[c] + rest % count);
      rest /= count;
      closed_[ties_.tie[t].edge] = closed_[ties_.tie[t].twin] = 1;
      for (std::uint32_t i = ties_.blocked_begin[t]; i < ties_.blocked_begin[t + 1]; ++i)
        blocked_[ties_.blocked[i]] = 1;
    }
    visit(blocked_, closed_);
  }
}

}  // namespace hydrotin
