#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "height_key.h"
#include "hydrotin/lattice.h"
#include "radix_sort.h"

namespace hydrotin {

/// All vertices ascending by (z, x, y): the total order that stands for heights without ties.
inline std::vector<std::uint32_t> order_vertices(std::span<const std::int32_t> height,
                                                 std::span<const LatticePoint> position) {
  std::vector<std::uint32_t> order(height.size());
  {
    std::vector<std::uint64_t> keys(height.size());
    for (std::uint32_t v = 0; v < height.size(); ++v) keys[v] = height_key(height[v], v);
    radix_sort(keys, [](std::uint64_t key) { return key >> 32; });
    for (std::size_t i = 0; i < keys.size(); ++i) order[i] = static_cast<std::uint32_t>(keys[i]);
  }
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    for (end = begin + 1; end < order.size() && height[order[end]] == height[order[begin]];) ++end;
    if (end - begin > 1)
      std::sort(order.begin() + static_cast<std::ptrdiff_t>(begin), order.begin() + static_cast<std::ptrdiff_t>(end),
                [&](std::uint32_t a, std::uint32_t b) { return position[a] < position[b]; });
  }
  return order;
}

}  // namespace hydrotin
