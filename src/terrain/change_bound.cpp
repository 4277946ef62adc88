#include "hydrotin/change_bound.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "hydrotin/lifting.h"
#include "level_moats.h"
#include "moat_packing.h"

namespace hydrotin {
namespace {

struct TerrainPacking {
  const ChangeableTerrain* terrain;
  bool only_once;
  [[nodiscard]] std::span<const std::uint32_t> neighbors(std::uint32_t v) const { return terrain->graph->neighbors(v); }
  [[nodiscard]] std::int64_t height(std::uint32_t v) const { return terrain->height[v]; }
  [[nodiscard]] std::int64_t capacity(std::uint32_t v) const {
    return only_once || terrain->weight.empty() ? 1 : terrain->weight[v];
  }
};

/// Whether a surface without pits exists that moves no vertex by more than `displacement`: the least one above h -
/// displacement is the best candidate.
bool is_feasible(const ChangeableTerrain& terrain, std::int64_t displacement) {
  std::vector<std::int32_t> lowered(terrain.height.begin(), terrain.height.end());
  for (std::size_t v = 0; v < lowered.size(); ++v) {
    if (terrain.is_outlet[v]) continue;
    const std::int64_t low =
        std::max<std::int64_t>(lowered[v] - displacement, std::numeric_limits<std::int32_t>::min());
    lowered[v] = static_cast<std::int32_t>(low);
    if (!terrain.lower.empty()) lowered[v] = std::max(lowered[v], terrain.lower[v]);
  }
  const std::vector<std::int32_t> level = lift(*terrain.graph, lowered, terrain.is_outlet);
  for (std::size_t v = 0; v < level.size(); ++v)
    if (level[v] != kNoLevel && level[v] > terrain.height[v] + displacement) return false;
  return true;
}

/// The least possible largest displacement, between half of the deepest flood and all of it.
std::int64_t least_largest(const ChangeableTerrain& terrain, std::int64_t deepest) {
  std::int64_t low = (deepest + 1) / 2, high = deepest;
  while (low < high) {
    const std::int64_t middle = low + (high - low) / 2;
    if (is_feasible(terrain, middle))
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

}  // namespace

std::int64_t change_bound(const ChangeableTerrain& terrain, std::span<const std::int32_t> level, ChangeMeasure measure,
                          bool may_raise) {
  std::int64_t most = 0;
  std::vector<std::uint32_t> bottoms;  // no lower neighbour: a vertex of each pit, and some others, which add nothing
  for (std::uint32_t v = 0; v < level.size(); ++v) {
    if (level[v] == terrain.height[v] || level[v] == kNoLevel) continue;
    most = std::max(most, std::int64_t{level[v]} - terrain.height[v]);
    const auto around = terrain.graph->neighbors(v);
    if (std::ranges::none_of(around, [&](std::uint32_t w) { return terrain.height[w] < terrain.height[v]; }))
      bottoms.push_back(v);
  }
  if (measure == ChangeMeasure::max) return least_largest(terrain, most);
  const auto depth = [&](std::uint32_t v) { return std::int64_t{level[v]} - terrain.height[v]; };
  std::sort(bottoms.begin(), bottoms.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(-depth(a), terrain.height[a], terrain.position[a]) <
           std::tuple(-depth(b), terrain.height[b], terrain.position[b]);
  });
  const bool only_once = measure == ChangeMeasure::count;
  MoatPacking packing(TerrainPacking{&terrain, only_once}, level.size(), only_once);
  Wide bound = 0;
  for (const std::uint32_t v : bottoms) bound += packing.add_pit(v, level[v]);
  if (level.size() <= kSmallTerrain) {
    LevelMoats moats(terrain, level, measure, may_raise);
    Wide by_moats = 0;
    for (const std::uint32_t v : bottoms) by_moats += moats.add_pit(v);
    bound = std::max(bound, by_moats);
  }
  return static_cast<std::int64_t>(std::min<Wide>(bound, std::numeric_limits<std::int64_t>::max()));
}

}  // namespace hydrotin
