#pragma once

#include <cstdint>
#include <span>

/// B': the yardstick of all benchmarks. The time that CGAL's `Delaunay_triangulation_2` (exact predicates, inexact
/// constructions) takes for the range insert of plain points, its own spatial sort included, on one thread.

namespace hydrotin::testing {

/// A point as the files hold it.
struct PlainPoint {
  std::int32_t x = 0, y = 0;
};

/// Seconds for one insertion of `points` into an empty triangulation; copying and freeing are not counted.
/// Complexity: O(n log n) time; about 180 bytes a point.
[[nodiscard]] double seconds_of_plain_delaunay(std::span<const PlainPoint> points);

/// B' in points a second: the median of three insertions of about a million synthetic scan-line points.
[[nodiscard]] double plain_delaunay_rate();

}  // namespace hydrotin::testing
