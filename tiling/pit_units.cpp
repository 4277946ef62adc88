#include "hydrotin/pit_units.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hydrotin {

RemovalOptions removal_options(const PitOptions& pits, const Lattice& lattice, double metres_per_unit) {
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
  out.limits.max_group = pits.largest_group;
  // A hair more, so that a limit which is a multiple of the lattice unit stays one.
  if (pits.max_breach_depth_m)
    out.limits.max_depth = static_cast<std::int32_t>(
        std::min(std::floor(*pits.max_breach_depth_m / lattice.scale_z * (1 + 1e-9)), 2147483646.0));
  if (pits.max_breach_length_m)
    out.limits.max_length = *pits.max_breach_length_m / metres_per_unit / lattice.scale_xy * (1 + 1e-9);
  return out;
}

KeepConditions keep_conditions(const KeepPits& keep, const Lattice& lattice, double metres_per_unit,
                               std::span<const std::uint8_t> is_inside, std::span<const std::uint8_t> is_listed) {
  const double side = lattice.scale_xy * metres_per_unit;
  KeepConditions out{{}, {}, {}, is_inside, is_listed, keep.all_conditions};
  if (keep.deeper_than_m) out.deeper_than = *keep.deeper_than_m / lattice.scale_z;
  if (keep.larger_than_m2) out.larger_than = *keep.larger_than_m2 / (side * side);
  if (keep.volume_above_m3) out.volume_above = *keep.volume_above_m3 / (side * side * lattice.scale_z);
  return out;
}

HeightBounds depth_bounds(std::span<const std::int32_t> height, std::int32_t max_depth) {
  HeightBounds bounds;
  if (max_depth == std::numeric_limits<std::int32_t>::max()) return bounds;
  for (const std::int32_t h : height)
    bounds.lower.push_back(static_cast<std::int32_t>(
        std::max<std::int64_t>(std::int64_t{h} - max_depth, std::numeric_limits<std::int32_t>::min())));
  bounds.upper.assign(height.size(), kNoLevel - 1);
  return bounds;
}

std::string outlet_policy(const PitOptions& options) {
  constexpr const char* kNames[] = {"hull", "lowest", "layer"};
  return kNames[static_cast<std::size_t>(options.outlets)];
}

std::string pit_method(const PitOptions& options) {
  constexpr const char* kNames[] = {"none", "lift", "breach", "greedy-breach", "least-change"};
  return kNames[static_cast<std::size_t>(options.method)];
}

}  // namespace hydrotin
