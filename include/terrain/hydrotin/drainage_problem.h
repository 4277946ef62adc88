#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lifting.h"

/// A part of a terrain whose heights may change, cut out so that it can be drained alone.
///
/// Its members are numbered by ascending (x, y). All that is around them stays as it is and has a way out that does not
/// lead back here (see pit_components.h, which cuts terrains so), so of the neighbours outside only the lowest counts.
/// A problem is a canonical form: two tilings of a terrain that find the same members make the same problem, bit for
/// bit, and every function of it gives them the same answer.
///
/// A surface x on the members *drains* if from each member a path that never rises leads to an exit, i.e. to a member v
/// with exit[v] <= x[v].
///
/// Source   thesis, Chapter 6: heights h, surfaces without local minima; Section 6.2.5 for the measures.
/// Symbols  k = members, e = edges between them.
/// Units    heights are integers on the z lattice.

namespace hydrotin {

/// What is to be small (thesis, Section 6.2.5).
enum class ChangeMeasure : std::uint8_t {
  total,   ///< sum of displacements
  max,     ///< largest displacement; among these surfaces a small total
  count,   ///< number of vertices moved; among these surfaces a small total
  volume,  ///< sum of displacement times area of the star / 3
};

struct DrainageProblem {
  std::vector<std::uint32_t> begin;     ///< [k + 1]
  std::vector<std::uint32_t> neighbor;  ///< [2e] members, each list ascending
  std::vector<std::int32_t> height;     ///< [k] below kNoLevel
  std::vector<std::int32_t> exit;       ///< [k] height of the lowest neighbour outside; kNoLevel: none
  std::vector<std::int32_t> level;      ///< [k] `lift` of the heights; empty: not known
  std::vector<std::int32_t> breached;   ///< [k] heights after the breaches found before cutting; empty: none are known
  std::vector<std::int64_t> weight;     ///< [k] positive costs per unit of displacement; empty: 1
  std::vector<std::int32_t> lower;      ///< [k] bounds of the heights; empty: none. The lifted surface must lie between
  std::vector<std::int32_t> upper;      ///< [k]

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(height.size()); }
  [[nodiscard]] std::span<const std::uint32_t> neighbors(std::uint32_t v) const {
    return {neighbor.data() + begin[v], neighbor.data() + begin[v + 1]};
  }
  [[nodiscard]] std::int64_t weight_of(std::uint32_t v) const { return weight.empty() ? 1 : weight[v]; }
  void clear() {
    begin.clear(), neighbor.clear(), height.clear(), exit.clear(), level.clear();
    breached.clear(), weight.clear(), lower.clear(), upper.clear();
  }
};

/// Cost of a surface: sum of weights times displacements (total, volume), largest displacement, or number of vertices.
[[nodiscard]] std::int64_t cost_of(const DrainageProblem& problem, std::span<const std::int32_t> surface,
                                   ChangeMeasure measure);

/// The least surface that drains and lies nowhere below `surface`; kNoLevel where there is none.
/// Complexity: O((k + e) log k).
[[nodiscard]] std::vector<std::int32_t> lift(const DrainageProblem& problem, std::span<const std::int32_t> surface);

/// `lift` of the heights, from `level` if that is known.
[[nodiscard]] std::vector<std::int32_t> level_of(const DrainageProblem& problem);

/// Whether a surface drains. Complexity: O((k + e) log k).
[[nodiscard]] bool drains(const DrainageProblem& problem, std::span<const std::int32_t> surface);

}  // namespace hydrotin
