#include "river_edges.h"

#include <algorithm>

#include "hydrotin/river_statistics.h"

namespace hydrotin {

std::vector<RiverEdge> invalid_river_edges(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                                           std::span<const std::uint32_t> triangle, std::vector<RiverEdge> river,
                                           bool flow, bool valley) {
  if (river.empty()) return {};
  std::sort(river.begin(), river.end());
  const auto is_river = [&](std::uint32_t a, std::uint32_t b) {
    return std::binary_search(river.begin(), river.end(), RiverEdge{a, b}) ||
           std::binary_search(river.begin(), river.end(), RiverEdge{b, a});
  };
  std::vector<std::uint8_t> on_river(position.size(), 0);
  for (const auto& [from, to] : river) on_river[from] = on_river[to] = 1;
  // The triangles at river edges with their vertices, as doubles that hold the integers.
  std::vector<std::uint32_t> used, share;
  for (std::size_t t = 0; t < triangle.size(); t += 3) {
    const std::uint32_t a = triangle[t], b = triangle[t + 1], c = triangle[t + 2];
    if (on_river[a] + on_river[b] + on_river[c] < 2) continue;
    if (is_river(a, b) || is_river(b, c) || is_river(c, a)) share.insert(share.end(), {a, b, c});
  }
  used = share;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto number = [&](std::uint32_t v) {
    return static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin());
  };
  for (std::uint32_t& v : share) v = number(v);
  std::vector<std::array<double, 2>> place;
  std::vector<double> z;
  for (const std::uint32_t v : used) {
    place.push_back({static_cast<double>(position[v].x), static_cast<double>(position[v].y)});
    z.push_back(height[v]);
  }
  std::vector<RiverEdge> local;
  for (const auto& [from, to] : river) local.push_back({number(from), number(to)});
  const RiverFaults faults = river_faults({place, z, share}, local, z, 0);
  std::vector<RiverEdge> out;
  for (std::size_t e = 0; e < river.size(); ++e)
    if ((flow && faults.wrong_flow[e] != 0) || (valley && faults.not_valley[e] != 0)) out.push_back(river[e]);
  return out;
}

}  // namespace hydrotin
