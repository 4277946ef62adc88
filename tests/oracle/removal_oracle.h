#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <limits>
#include <vector>

#include "oracle/terrain_oracle.h"

/// The best surface without pits, by trying all.
namespace hydrotin::oracle {

/// Whether from each vertex of a piece with an outlet a path that never rises leads to an outlet.
inline bool has_no_pit(const Neighbors& around, const std::vector<std::int32_t>& height,
                       const std::vector<std::uint8_t>& is_outlet) {
  std::vector<std::uint8_t> good(is_outlet);
  for (bool grown = true; grown;) {
    grown = false;
    for (std::size_t v = 0; v < height.size(); ++v)
      for (const std::uint32_t w : around[v])
        if (!good[v] && good[w] && height[w] <= height[v]) good[v] = 1, grown = true;
  }
  return std::all_of(good.begin(), good.end(), [](std::uint8_t g) { return g != 0; });
}

/// Least costs of surfaces without pits with heights in [lowest, highest]: 0 total, 1 max, 2 count, 3 weighted.
struct LeastCosts {
  std::array<std::int64_t, 4> joint, lowering;
};

inline LeastCosts least_costs(const Neighbors& around, const std::vector<std::int32_t>& height,
                              const std::vector<std::uint8_t>& is_outlet, const std::vector<std::int64_t>& weight) {
  LeastCosts best;
  best.joint.fill(std::numeric_limits<std::int64_t>::max());
  best.lowering = best.joint;
  const auto [lowest, highest] = std::minmax_element(height.begin(), height.end());
  std::vector<std::int32_t> x(height);
  const std::function<void(std::size_t)> choose = [&](std::size_t v) {
    if (v == height.size()) {
      if (!has_no_pit(around, x, is_outlet)) return;
      std::array<std::int64_t, 4> cost{};
      bool is_lower = true;
      for (std::size_t w = 0; w < x.size(); ++w) {
        const std::int64_t moved = std::abs(x[w] - height[w]);
        cost[0] += moved;
        cost[1] = std::max(cost[1], moved);
        cost[2] += moved != 0;
        cost[3] += moved * weight[w];
        is_lower &= x[w] <= height[w];
      }
      for (std::size_t i = 0; i < 4; ++i) {
        best.joint[i] = std::min(best.joint[i], cost[i]);
        if (is_lower) best.lowering[i] = std::min(best.lowering[i], cost[i]);
      }
      return;
    }
    if (is_outlet[v]) return choose(v + 1);
    for (x[v] = *lowest; x[v] <= *highest; ++x[v]) choose(v + 1);
    x[v] = height[v];
  };
  choose(0);
  return best;
}

}  // namespace hydrotin::oracle
