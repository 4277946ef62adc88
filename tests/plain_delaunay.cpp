#include "plain_delaunay.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <vector>

#include "hydrotin/synthetic.h"

namespace hydrotin::testing {

double seconds_of_plain_delaunay(std::span<const PlainPoint> points) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_2> copy;
  copy.reserve(points.size());
  for (const PlainPoint p : points) copy.emplace_back(p.x, p.y);
  CGAL::Delaunay_triangulation_2<Kernel> triangulation;
  const auto start = std::chrono::steady_clock::now();
  triangulation.insert(copy.begin(), copy.end());
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double plain_delaunay_rate() {
  static const std::vector<PlainPoint> points = [] {
    SyntheticOptions options;
    options.kind = SyntheticKind::scanline;
    options.num_points = 1'000'000;
    const SyntheticTerrain terrain(options);
    std::vector<PlainPoint> all;
    terrain.points_in(terrain.box(), [&](std::span<const SyntheticPoint> batch) {
      for (const SyntheticPoint& p : batch) all.push_back({p.x, p.y});
    });
    return all;
  }();
  std::array<double, 3> seconds{};
  for (double& s : seconds) s = seconds_of_plain_delaunay(points);
  std::sort(seconds.begin(), seconds.end());
  return static_cast<double>(points.size()) / seconds[1];
}

}  // namespace hydrotin::testing
