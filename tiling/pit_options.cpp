#include "pit_options.h"

#include <algorithm>
#include <limits>

#include "embedded_rivers.h"

namespace hydrotin {

RemovalOptions removal_options(const RunContext& context) {
  RemovalOptions out = removal_options(context.options.pits, context.plan.lattice, context.plan.metres_per_unit);
  out.limits.max_lake = context.options.pits.largest_lake;  // the in-memory commands hold the terrain whole anyway
  return out;
}

void ChangeableSurface::set_weights(const RunContext& context, std::span<const std::uint32_t> triangle) {
  star_ = star_weights(terrain_.position, triangle);
  if (context.options.pits.measure == ChangeMeasure::volume) terrain_.weight = star_;
}

void ChangeableSurface::set_bounds(const RunContext& context) {
  bounds_ = depth_bounds(terrain_.height, removal_options(context).limits.max_depth);
  terrain_.lower = bounds_.lower;
  terrain_.upper = bounds_.upper;
}

// Rivers stay, and rise at most with the water where it stands above them; wingtips keep what the valleys need.
void ChangeableSurface::keep_rivers(const RunContext& context, std::span<const std::uint64_t> point,
                                    std::span<const std::int32_t> level) {
  if (bounds_.lower.empty()) {
    bounds_.lower.assign(point.size(), std::numeric_limits<std::int32_t>::min());
    bounds_.upper.assign(point.size(), kNoLevel - 1);
  }
  for (std::size_t v = 0; v < point.size(); ++v) {
    const auto found = context.rivers->bound.find(point[v]);
    if (found == context.rivers->bound.end()) continue;
    const std::int32_t height = terrain_.height[v];
    std::int32_t& lower = bounds_.lower[v];
    lower = std::max(lower, found->second.is_way ? height : std::min(found->second.lower, height));
    if (found->second.is_way) bounds_.upper[v] = level[v] == kNoLevel ? height : level[v];
  }
  terrain_.lower = bounds_.lower;
  terrain_.upper = bounds_.upper;
}

}  // namespace hydrotin
