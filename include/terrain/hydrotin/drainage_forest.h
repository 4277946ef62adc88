#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hydrotin/drainage_problem.h"

/// Drainage forests, and the best surface for a given one.
///
/// A surface drains exactly if there is a forest p on the members, whose roots lie at exits, with x(v) >= x(p(v)) and
/// x(root) >= exit(root). For a fixed forest the best mix of raising and lowering is an isotonic regression on trees,
/// solved exactly:
///   total, volume  in the sense of L1. Let G_v(t) be the least cost of the subtree of v if v must lie at t or above:
///                  convex and piecewise linear. Each node holds the breakpoints of G_v in a heap: it melds those of
///                  its children, adds its own height with twice its weight, and takes its weight away from the lowest
///                  breakpoints; the last of them is the best height m(v) without regard to what lies below. Downwards
///                  from the roots x(v) = max(m(v), x(p(v))).
///   count          in the sense of L0: which vertices may keep their heights. The same with the step function of the
///                  largest number kept; a height takes away the next lower one, as in the longest ascending
///                  subsequence. The others then move as little as they can.
///
/// Source   FINDINGS C5; T6.3 leaves it open. Breakpoint heaps: Stout, "Isotonic regression via partitioning", 2013,
///          and the slope trick of dynamic programming.
/// Symbols  k = members.
/// Properties
///   (1) The result is a least-cost surface with x(v) >= x(p(v)), x(root) >= exit(root) and lower <= x <= upper; the
///       lowest one of these.
///   (2) Its heights are heights, bounds or exits of the problem: they stay on the lattice.
/// Threads  One object belongs to one thread; it keeps its memory from call to call.

namespace hydrotin {

inline constexpr std::uint32_t kRoot = 0xffffffffu;

/// parent[v] = the member that v drains to, kRoot: to its exit. `order` has all members, parents before children.
struct DrainageForest {
  std::vector<std::uint32_t> parent;  ///< [k]
  std::vector<std::uint32_t> order;   ///< [k]
};

/// The forest by which a surface drains: each member to the lowest neighbour or exit through which it is reached when
/// the members are taken in the order (surface, height, number), each after one that it can drain to.
///
/// @param surface  [k], drains.
/// Complexity: O((k + e) log k).
class ForestFinder {
 public:
  explicit ForestFinder(const DrainageProblem& problem);
  ~ForestFinder();
  void run(std::span<const std::int32_t> surface, DrainageForest& forest);

 private:
  class State;
  const DrainageProblem* problem_;
  std::unique_ptr<State> state_;  // made by the first run
};

class TreeRegression {
 public:
  /// The best surface for a forest in the sense of total or volume.
  /// @param lower, upper  [k] or empty; they must allow some surface.
  /// Complexity: O(k log k) amortized, pairing heaps.
  void least_total(const DrainageProblem& problem, const DrainageForest& forest, std::span<const std::int32_t> lower,
                   std::span<const std::int32_t> upper, std::vector<std::int32_t>& surface);

  /// The best surface for a forest in the sense of count, then total. Bounds must include the heights.
  /// Complexity: O(k log^2 k), small sets merged into large ones.
  void least_count(const DrainageProblem& problem, const DrainageForest& forest, std::vector<std::int32_t>& surface);

 private:
  struct Slot {
    std::int64_t weight = 0;
    std::int32_t key = 0;
    std::uint32_t child = kRoot, sibling = kRoot;
  };
  [[nodiscard]] std::uint32_t meld(std::uint32_t a, std::uint32_t b);
  [[nodiscard]] std::uint32_t pop(std::uint32_t root);
  [[nodiscard]] std::uint32_t make_slot(std::int32_t key, std::int64_t weight);
  [[nodiscard]] std::int32_t take(std::uint32_t& root, std::int64_t weight);

  std::vector<Slot> slot_;
  std::vector<std::uint32_t> free_, heap_, pairs_;
};

}  // namespace hydrotin
