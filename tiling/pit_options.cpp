#include "pit_options.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hydrotin {

RemovalOptions removal_options(const RunContext& context) {
  const PitOptions& pits = context.options.pits;
  const Lattice& lattice = context.plan.lattice;
  RemovalOptions out;
  switch (pits.method) {
    case PitMethod::none:
    case PitMethod::lift:
      out.method = RemovalMethod::lift;
      break;
    case PitMethod::breach:
      out.method = RemovalMethod::breach;
      break;
    case PitMethod::greedy_breach:
      out.method = RemovalMethod::greedy_breach;
      break;
    case PitMethod::least_change:
      out.method = RemovalMethod::least_change;
      break;
  }
  out.measure = pits.measure;
  out.limits.max_visits = kScalableVisits;
  out.limits.max_lake = pits.largest_lake;
  // A hair more, so that a limit which is a multiple of the lattice unit stays one.
  if (pits.max_breach_depth_m)
    out.limits.max_depth = static_cast<std::int32_t>(
        std::min(std::floor(*pits.max_breach_depth_m / lattice.scale_z * (1 + 1e-9)), 2147483646.0));
  if (pits.max_breach_length_m)
    out.limits.max_length = *pits.max_breach_length_m / context.plan.metres_per_unit / lattice.scale_xy * (1 + 1e-9);
  return out;
}

std::string outlet_policy(const PitOptions& options) {
  constexpr const char* kNames[] = {"hull", "lowest", "layer"};
  return kNames[static_cast<std::size_t>(options.outlets)];
}

std::string pit_method(const PitOptions& options) {
  constexpr const char* kNames[] = {"none", "lift", "breach", "greedy-breach", "least-change"};
  return kNames[static_cast<std::size_t>(options.method)];
}

void ChangeableSurface::set_weights(const RunContext& context, std::span<const std::uint32_t> triangle) {
  star_ = star_weights(terrain_.position, triangle);
  if (context.options.pits.measure == ChangeMeasure::volume) terrain_.weight = star_;
}

void ChangeableSurface::set_bounds(const RunContext& context) {
  const std::int64_t depth = removal_options(context).limits.max_depth;
  if (depth == std::numeric_limits<std::int32_t>::max()) return;
  for (const std::int32_t h : terrain_.height)
    lower_.push_back(
        static_cast<std::int32_t>(std::max<std::int64_t>(h - depth, std::numeric_limits<std::int32_t>::min())));
  upper_.assign(terrain_.height.size(), kNoLevel - 1);
  terrain_.lower = lower_;
  terrain_.upper = upper_;
}

}  // namespace hydrotin
