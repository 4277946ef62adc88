#pragma once

#include <cstdint>
#include <optional>

#include "small_points.h"

namespace hydrotin::app {

/// What thinning did to the points of a one-shot command; heights in the unit of z.
struct SmallThinning {
  double limit = 0, cell = 0;  ///< of errors; side of the grid's cells, in the unit of x and y
  std::uint64_t kept = 0, removed = 0, pruned = 0, settled = 0;
  double max_error = 0, rms_error = 0;  ///< of the points removed, in the Delaunay triangulation of those kept
};

/// Keeps the points that a TIN needs to pass all others within `limit`; the others become reference points, after those
/// that there are.
/// @param cell  none: eight mean spacings over the hull
/// Fails: Error(config) for numbers beyond the lattice, Error(input) if all points lie on one line.
[[nodiscard]] SmallThinning thin_small_points(SmallPoints& points, double limit, std::optional<double> cell);

}  // namespace hydrotin::app
