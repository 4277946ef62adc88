#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "monolith.h"
#include "pipeline_outputs.h"
#include "plan.h"

/// Surveys made of places, as files with any header, and what a run of them has to equal.
///
/// Places are given in thousandths of a metre, so that one cloud can be written with many scales and offsets.

namespace hydrotin::testing {

inline constexpr std::int64_t kX0 = 500'000'000, kY0 = 4'000'000'000;

/// How a file says where its points are.
struct Header {
  std::int64_t scale = 10, scale_z = 10;
  Place offset{kX0, kY0, 0};
  std::string crs = "EPSG:32633";
  std::uint8_t classification = 2;
};

inline void write_places(const std::string& path, const std::vector<Place>& places, const Header& header = {}) {
  LasWriterOptions options;
  options.crs = header.crs;
  const std::array<std::int64_t, 3> scale{header.scale, header.scale, header.scale_z};
  std::array<std::vector<std::int32_t>, 3> column;
  for (std::size_t a = 0; a < 3; ++a) {
    options.scale[a] = static_cast<double>(scale[a]) / 1000;
    options.offset[a] = static_cast<double>(header.offset[a]) / 1000;
    for (const Place& p : places) {
      ASSERT_EQ((p[a] - header.offset[a]) % scale[a], 0) << "the test's own mistake";
      column[a].push_back(static_cast<std::int32_t>((p[a] - header.offset[a]) / scale[a]));
    }
  }
  const std::vector<std::uint8_t> classification(places.size(), header.classification);
  LasPoints points;
  points.x = column[0];
  points.y = column[1];
  points.z = column[2];
  points.classification = classification;
  LasWriter writer(path, options);
  writer.write(points);
  writer.close();
}

/// n points in a rectangle, on hills some metres high; multiples of `step`.
inline std::vector<Place> hills(std::uint64_t seed, std::size_t n, std::int64_t x0, std::int64_t y0, std::int64_t width,
                                std::int64_t height, std::int64_t step = 10) {
  Random random(seed);
  std::vector<Place> out;
  for (std::size_t i = 0; i < n; ++i) {
    const std::int64_t x = x0 + random.between(0, static_cast<std::int32_t>(width / step)) * step;
    const std::int64_t y = y0 + random.between(0, static_cast<std::int32_t>(height / step)) * step;
    const double z = 4000 * std::sin(static_cast<double>(x) / 17'000) * std::cos(static_cast<double>(y) / 23'000);
    out.push_back({x, y, 100'000 + (std::llround(z) + random.between(0, 300)) / step * step});
  }
  return out;
}

inline void append(std::vector<Place>& to, const std::vector<Place>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

inline PipelineOptions options_of(const std::vector<std::string>& files, const std::string& out) {
  PipelineOptions options = options_for(files, out);
  options.output.mesh_ply = true;
  options.tiles.target_points = 1'500;
  options.run.workers = 2;
  return options;
}

/// Runs the files in many tiles and demands what one triangulation in memory of all places gives.
inline DatasetSummary expect_monolith(const PipelineOptions& options, const std::vector<Place>& places) {
  const Lattice lattice = make_plan(options).lattice;
  Cloud cloud;
  for (const Place& p : places) {
    const auto at = [&](std::size_t axis, double zero, double scale) {
      return static_cast<std::int32_t>(std::llround((static_cast<double>(p[axis]) / 1000 - zero) / scale));
    };
    cloud.position.push_back({at(0, lattice.x(0), lattice.scale_xy), at(1, lattice.y(0), lattice.scale_xy)});
    cloud.height.push_back(at(2, lattice.z(0), lattice.scale_z));
  }
  const Monolith expected =
      run_monolith(cloud.position, cloud.height, options.triangulation.order, options.triangulation.objectives,
                   options.pits.outlets == OutletPolicy::hull, {0, 0}, 0);
  const DatasetSummary got = run(options);
  EXPECT_EQ(got.fingerprint, expected.fingerprint);
  EXPECT_EQ(got.points, places.size());
  EXPECT_EQ(got.vertices, expected.vertices);
  EXPECT_EQ(got.duplicates, expected.duplicates);
  EXPECT_EQ(got.triangles, expected.triangles);
  EXPECT_EQ(got.pits, 0U);
  const DatasetSummary checked = check_dataset(options.output.dir, 3'000);
  EXPECT_TRUE(checked.ok) << (checked.problems.empty() ? "" : checked.problems.front());
  const Surface surface = read_surface(options.output.dir);
  EXPECT_EQ(surface.vertex.size(), expected.vertices);
  EXPECT_EQ(fault_of(surface), "");
  EXPECT_EQ(count_pits(surface), 0U);
  return got;
}

}  // namespace hydrotin::testing
