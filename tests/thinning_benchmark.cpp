#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "hydrotin/convex_hull.h"
#include "hydrotin/dem_points.h"
#include "hydrotin/hilbert.h"
#include "hydrotin/las.h"
#include "hydrotin/thinning.h"

/// thinning_benchmark LIMIT_M CELLS FILE...: the ground points of LAS files or the cells of rasters, thinned to the
/// limit on a grid whose cells are CELLS mean spacings wide: rounds, points kept, microseconds a point.

namespace {

using namespace hydrotin;

struct Points {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  double scale_xy = 1, scale_z = 1;
};

void read(const std::string& path, std::map<LatticePoint, std::int32_t>& lowest, Points& points) {
  const auto add = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    const auto narrow = [](std::int64_t v) { return static_cast<std::int32_t>(v); };
    const auto [at, is_new] = lowest.try_emplace({narrow(x), narrow(y)}, narrow(z));
    if (!is_new) at->second = std::min(at->second, narrow(z));
  };
  if (is_raster(path)) {
    DemFile dem(path);
    points.scale_xy = points.scale_z = DemReading{}.quantum;
    const auto x0 = std::llround(dem.header().center[0] / points.scale_xy);
    const auto y0 = std::llround(dem.header().center[1] / points.scale_xy);
    (void)dem.read(0, dem.header().num_rows, [&](const DemBatch& batch) {
      for (std::size_t i = 0; i < batch.size(); ++i) add(batch.x[i] - x0, batch.y[i] - y0, batch.z[i]);
    });
    return;
  }
  const LasFile las(path);
  points.scale_xy = las.header().scale[0];
  points.scale_z = las.header().scale[2];
  PointBatch batch;
  for (std::size_t c = 0; c < las.num_chunks(); ++c) {
    las.decode(c, batch);
    for (std::size_t i = 0; i < batch.size(); ++i)
      if (batch.classification[i] == 2 && (batch.flags[i] & PointFlag::withheld) == 0)
        add(batch.x[i], batch.y[i], batch.z[i]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: thinning_benchmark LIMIT_M CELLS FILE...\n");
    return 2;
  }
  Points points;
  {
    std::map<LatticePoint, std::int32_t> lowest;
    for (int i = 3; i < argc; ++i) read(argv[i], lowest, points);
    std::vector<std::pair<std::uint64_t, std::pair<LatticePoint, std::int32_t>>> order;
    for (const auto& [p, z] : lowest) order.push_back({hilbert_key(p), {p, z}});
    std::sort(order.begin(), order.end());
    for (const auto& [key, point] : order) {
      points.position.push_back(point.first);
      points.height.push_back(point.second);
    }
  }
  const double n = static_cast<double>(points.position.size());
  const auto hull = convex_hull(points.position);
  double area = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const LatticePoint a = points.position[hull[i]], b = points.position[hull[(i + 1) % hull.size()]];
    area += (static_cast<double>(a.x) * b.y - static_cast<double>(a.y) * b.x) / 2;
  }
  ThinningOptions options;
  options.limit_millionths = std::llround(std::atof(argv[1]) / points.scale_z * 1e6);
  options.cell = static_cast<std::int32_t>(std::max(1.0, std::round(std::atof(argv[2]) * std::sqrt(area / n))));
  for (const bool prune : {false, true}) {
    options.prune = prune;
    const auto start = std::chrono::steady_clock::now();
    const Thinning got = thin(points.position, points.height, hull, options);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    double kept = 0, pruned = 0, settled = 0;
    for (const PointFate fate : got.fate) {
      kept += is_kept(fate);
      pruned += fate == PointFate::pruned;
      settled += fate == PointFate::settled;
    }
    std::printf(
        "%9.0f points  cell %6.2f  kept %6.2f %%  pruned %5.2f %%  settled %4.0f  max %.4f  rms %.4f  beyond %zu  "
        "%.3f us/point\n",
        n, options.cell * points.scale_xy, 100 * kept / n, 100 * pruned / std::max(1.0, kept + pruned), settled,
        got.max_error * points.scale_z, std::sqrt(got.squared_error / std::max(1.0, n - kept)) * points.scale_z,
        got.unsettled.size(), 1e6 * seconds / n);
  }
}
