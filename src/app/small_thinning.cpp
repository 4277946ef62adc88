#include "small_thinning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrotin/convex_hull.h"
#include "hydrotin/error.h"
#include "hydrotin/thinning.h"

namespace hydrotin::app {
namespace {

// In squared lattice units.
double hull_area(const SmallPoints& points, const std::vector<std::uint32_t>& hull) {
  double twice = 0;
  const LatticePoint o = points.position[hull.front()];
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const LatticePoint a = points.position[hull[i]], b = points.position[hull[(i + 1) % hull.size()]];
    twice += (static_cast<double>(a.x) - o.x) * (static_cast<double>(b.y) - o.y) -
             (static_cast<double>(b.x) - o.x) * (static_cast<double>(a.y) - o.y);
  }
  return twice / 2;
}

ThinningOptions options_for(const SmallPoints& points, double limit, std::optional<double> cell,
                            const std::vector<std::uint32_t>& hull) {
  const Lattice& l = points.lattice;
  const double millionths = std::round(limit / l.scale_z * 1e6);
  if (!(limit >= 0) || !(millionths < 2e15))
    throw Error(ErrorKind::config,
                fmt::format("--thin: {} is not possible (allowed: from 0 to 2^31 units of height)", limit));
  const double side =
      cell ? *cell / l.scale_xy : 8 * std::sqrt(hull_area(points, hull) / static_cast<double>(points.position.size()));
  if (!(side > 0) || !(side < 0x1p28))
    throw Error(ErrorKind::config, fmt::format("--thin-cell: {} is not possible (allowed: more than 0, to 2^28 units)",
                                               side * l.scale_xy));
  ThinningOptions out;
  out.limit_millionths = static_cast<std::int64_t>(millionths);
  out.set_grid(l, side);
  return out;
}

}  // namespace

SmallThinning thin_small_points(SmallPoints& points, double limit, std::optional<double> cell) {
  const std::vector<std::uint32_t> hull = convex_hull(points.position);
  if (hull.size() < 3)
    throw Error(ErrorKind::input, fmt::format("--thin: the {} distinct points lie on one line or are fewer than three: "
                                              "there is no triangle",
                                              points.position.size()));
  const ThinningOptions options = options_for(points, limit, cell, hull);
  const Thinning thinning = thin(points.position, points.height, hull, options);
  if (!thinning.unsettled.empty())
    throw Error(ErrorKind::resource, fmt::format("--thin: {} points are beyond the limit after all rounds; give a "
                                                 "smaller --thin-cell",
                                                 thinning.unsettled.size()));
  SmallThinning out;
  out.limit = limit;
  out.cell = options.cell * points.lattice.scale_xy;
  SmallPoints kept = points;
  kept.position.clear();
  kept.height.clear();
  kept.row.clear();
  for (std::size_t i = 0; i < points.position.size(); ++i) {
    out.pruned += thinning.fate[i] == PointFate::pruned;
    out.settled += thinning.fate[i] == PointFate::settled;
    if (!is_kept(thinning.fate[i])) {
      kept.reference_position.push_back(points.position[i]);
      kept.reference_height.push_back(points.height[i]);
      continue;
    }
    kept.position.push_back(points.position[i]);
    kept.height.push_back(points.height[i]);
    kept.row.push_back(points.row[i]);
  }
  out.kept = kept.position.size();
  out.removed = points.position.size() - out.kept;
  out.max_error = thinning.max_error * points.lattice.scale_z;
  out.rms_error = std::sqrt(thinning.squared_error / static_cast<double>(std::max<std::uint64_t>(out.removed, 1))) *
                  points.lattice.scale_z;
  points = std::move(kept);
  return out;
}

}  // namespace hydrotin::app
