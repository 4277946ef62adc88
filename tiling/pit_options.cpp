#include "pit_options.h"

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

}  // namespace hydrotin
