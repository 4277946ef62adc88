#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "hydrotin/drainage_problem.h"

/// The methods of pit removal on one drainage problem.
///
/// Source   thesis, Theorem 6.1 (lift), Theorem 6.2 (breach), Section 6.3 (both together, left open there),
/// Section 6.2.5
///          (measures); FINDINGS C5.
/// Properties
///   (1) Every result drains, lies nowhere above the lifted surface, and within the bounds of the problem.
///   (2) `least_change` costs no more than `lift` nor than `breach_all` in the same measure.
///   (3) Results are functions of the problem: no clock, no random number, ties by (x, y).
/// Threads  Pure: safe to call concurrently, no hidden parallelism; but one `ChangeScratch` belongs to one thread.

namespace hydrotin {

/// Limits of the searches for breaches; see `BreachLimits`.
struct SearchLimits {
  std::int32_t max_depth = 0x7fffffff;           ///< of lowering a vertex
  std::uint64_t max_visits = ~std::uint64_t{0};  ///< vertices looked at for one pit
};

/// Memory of the methods, kept from problem to problem: most problems have a few members only, and are solved in less
/// time than memory takes to be found.
class ChangeScratch {
 public:
  class State;
  ChangeScratch();
  ~ChangeScratch();
  [[nodiscard]] State& state() { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

/// Breaches pit after pit on the surface that the breaches before have left, so that channels are shared: ascending by
/// (spill level, height, x, y), and in problems of up to 100 members also by (height, spill level, x, y); compared with
/// the breaches by themselves, `DrainageProblem::breached`; the cheapest of these. What cannot be breached is lifted.
///
/// Complexity: the searches of Theorem 6.2 for all pits, twice. Pits whose searches `max_visits` ends are breached
/// together afterwards, along the forest by which the flooded rest drains.
[[nodiscard]] std::vector<std::int32_t> breach_all(const DrainageProblem& problem, ChangeMeasure measure,
                                                   const SearchLimits& limits, ChangeScratch& scratch);
[[nodiscard]] std::vector<std::int32_t> breach_all(const DrainageProblem& problem, ChangeMeasure measure,
                                                   const SearchLimits& limits);

struct LeastChangeOptions {
  ChangeMeasure measure = ChangeMeasure::total;
  SearchLimits limits;
  bool with_greedy = false;  ///< starts from `greedy_breach` too
  int max_rounds = 3;        ///< regressions from each start; a round that gains nothing is the last, with limited
                             ///< searches in problems of more than 1,000 members one that gains less than 5 %
};

/// Lifts and lowers together: from the lifted surface and from the cheapest breached one, again and again finds the
/// forest by which the surface drains and the best surface for this forest (drainage_forest.h), as long as that gains;
/// the best one. (With limited searches, in problems of more than 1,000 members, the first forest is the one along
/// which the breached surface was made.) For `max` the least possible largest displacement D is found first (the least
/// D such that h - D, lifted, lies nowhere above h + D), then the total is reduced within h - D .. h + D.
///
/// Complexity: rounds times O((k + e) log k), plus `breach_all`.
[[nodiscard]] std::vector<std::int32_t> least_change(const DrainageProblem& problem, const LeastChangeOptions& options,
                                                     ChangeScratch& scratch);
[[nodiscard]] std::vector<std::int32_t> least_change(const DrainageProblem& problem, const LeastChangeOptions& options);

}  // namespace hydrotin
