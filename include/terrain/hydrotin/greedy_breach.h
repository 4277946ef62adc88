#pragma once

#include <cstdint>
#include <vector>

#include "hydrotin/drainage_problem.h"

/// Algorithm 6.1: breaching a set of pits at a cost of at most 2 ln m times the least, m = pits and what they drain to.
///
/// In each round, for each center c and each pit u that pays for c, the group of pits is sought that costs least per
/// member: u is let through c to something lower, and pits above u come to c as long as that lowers the average. The
/// best group of all is breached. Distances are taken on the surface as it is, so what was lowered before is free; they
/// are no larger than on the terrain as it was, which is all that the proof of Theorem 6.4 needs. What water drains to
/// (the exits, or a lower pit) counts as a member of the group, also when it is the group's only other one. Pits of one
/// height are told apart by (x, y).
///
/// Source   thesis, Section 6.2.4, Algorithm 6.1, Theorem 6.4; FINDINGS C4.
/// Symbols  k = members of the problem, m = pits + 1.
/// Properties
///   (1) The result drains; it lies nowhere above the heights, except where a pit cannot be breached.
///   (2) If all pits can be breached, and for the measures total, count and volume, it costs at most max(1, 2 ln m)
///       times the least cost of a surface below the heights that drains.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

struct GreedyBreach {
  std::vector<std::int32_t> surface;  ///< [k]
  bool has_guarantee = true;          ///< false: the problem was too large, and breached as by `breach_all`
  std::uint64_t num_pits = 0;
};

/// Problems with m^2 k above this are too large.
inline constexpr std::uint64_t kGreedyBreachLimit = 20'000'000;

/// Complexity: O(m^2 k log k) time, 40 m k bytes: at most a few seconds and 100 MB by the limit.
[[nodiscard]] GreedyBreach greedy_breach(const DrainageProblem& problem, ChangeMeasure measure, std::int32_t max_depth);

}  // namespace hydrotin
