#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "surveys.h"

/// Inputs in awkward places: overlaps, gaps, duplicates, voids, hulls of any shape.

namespace hydrotin {
namespace {

using testing::append;
using testing::expect_monolith;
using testing::hills;
using testing::kX0;
using testing::kY0;
using testing::options_of;
using testing::Place;
using testing::Random;
using testing::run;
using testing::TemporaryFolder;
using testing::write_places;

TEST(InputShapes, OverlapTouchOrLeaveGaps) {
  const std::int64_t side = 60'000;
  for (const std::int64_t gap : {-side, -side / 2, std::int64_t{-10}, std::int64_t{0}, std::int64_t{10},
                                 std::int64_t{8'000}, std::int64_t{5'000'000}}) {
    SCOPED_TRACE(::testing::Message() << "gap of " << gap << " mm");
    const TemporaryFolder folder;
    std::vector<Place> all;
    std::vector<std::string> files;
    for (int f = 0; f < 3; ++f) {
      // In a row, the third one above the first, each with points on its whole border.
      const std::int64_t x = kX0 + (f == 1 ? side + gap : 0), y = kY0 + (f == 2 ? side + gap : 0);
      auto points = hills(static_cast<std::uint64_t>(f), 2'000, x, y, side, side);
      for (std::int64_t s = 0; s <= side; s += 1'000)
        append(points,
               {{x + s, y, 100'000}, {x, y + s, 100'100}, {x + s, y + side, 100'200}, {x + side, y + s, 100'300}});
      files.push_back(folder / ("tile" + std::to_string(f) + ".las"));
      write_places(files.back(), points);
      append(all, points);
    }
    expect_monolith(options_of(files, folder / "out"), all);
  }
}

TEST(InputShapes, DuplicatesAcrossFilesKeepTheLowest) {
  const TemporaryFolder folder;
  auto first = hills(1, 3'000, kX0, kY0, 80'000, 80'000);
  auto second = first, third = first;
  Random random(5);
  for (Place& p : second) p[2] += random.between(-20, 20) * 10;
  for (Place& p : third) p[2] += random.between(-20, 20) * 10;
  third.resize(1'000);
  const std::vector<std::string> files{folder / "a.las", folder / "b.las", folder / "c.las"};
  write_places(files[0], first);
  write_places(files[1], second);
  write_places(files[2], third);
  std::vector<Place> all = first;
  append(all, second);
  append(all, third);
  expect_monolith(options_of(files, folder / "out"), all);

  PipelineOptions measured = options_of(files, folder / "measured");
  measured.pits.method = PitMethod::none;
  (void)run(measured);
  std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t> lowest;
  for (const Place& p : all) {
    const auto [at, added] = lowest.try_emplace({p[0], p[1]}, p[2]);
    if (!added) at->second = std::min(at->second, p[2]);
  }
  std::vector<Place> expected;
  for (const auto& [at, z] : lowest) expected.push_back({at.first, at.second, z});
  EXPECT_EQ(testing::read_surface(measured.output.dir).vertex, expected);
}

TEST(InputShapes, VoidsKilometresWide) {
  const TemporaryFolder folder;
  // A plain of 12 km with two lakes of some kilometres, one of them open to the side.
  std::vector<Place> plain;
  for (const Place& p : hills(3, 16'000, kX0, kY0, 12'000'000, 12'000'000)) {
    const double x = static_cast<double>(p[0] - kX0) / 1e6, y = static_cast<double>(p[1] - kY0) / 1e6;
    if (std::hypot(x - 5, y - 6) < 3 || (x > 9 && y > 2 && y < 5)) continue;
    plain.push_back(p);
  }
  std::vector<std::string> files;
  for (std::size_t f = 0; f < 2; ++f) {
    files.push_back(folder / ("half" + std::to_string(f) + ".las"));
    const auto middle = plain.begin() + static_cast<std::ptrdiff_t>(plain.size() / 2);
    write_places(files.back(), f == 0 ? std::vector(plain.begin(), middle) : std::vector(middle, plain.end()));
  }
  expect_monolith(options_of(files, folder / "out"), plain);
}

TEST(InputShapes, HullThatIsNotConvex) {
  const TemporaryFolder folder;
  // A comb with three teeth; between them lies nothing.
  std::vector<Place> comb = hills(4, 3'000, kX0, kY0, 400'000, 20'000);
  for (int tooth = 0; tooth < 3; ++tooth)
    append(comb, hills(5 + static_cast<std::uint64_t>(tooth), 2'500, kX0 + tooth * 180'000, kY0, 30'000, 300'000));
  write_places(folder / "comb.las", comb);
  PipelineOptions options = options_of({folder / "comb.las"}, folder / "out");
  options.output.dem = {true, 1.0, 25.0, true, false};
  expect_monolith(options, comb);
  EXPECT_EQ(testing::difference_of_dems(options.output.dir), "");
  testing::expect_dem_interpolates(options.output.dir, 25.0, 300);
  const Raster dem = read_raster(options.output.dir + "/dem.tif");
  const auto cell_at = [&](double x, double y) {
    return static_cast<std::size_t>(dem.grid.y_max - y) * dem.grid.num_columns +
           static_cast<std::size_t>(x - dem.grid.x_min);
  };
  EXPECT_TRUE(dem.is_nodata(cell_at(500'100.5, 4'000'150.5)));
  EXPECT_FALSE(dem.is_nodata(cell_at(500'015.5, 4'000'150.5)));
}

TEST(InputShapes, ClustersTensOfKilometresApart) {
  const TemporaryFolder folder;
  std::vector<Place> all = hills(8, 3'000, kX0, kY0, 50'000, 50'000);
  const auto far = hills(9, 3'000, kX0 + 40'000'000, kY0 + 30'000'000, 50'000, 50'000);
  const std::vector<std::string> files{folder / "here.las", folder / "there.las"};
  write_places(files[0], all);
  write_places(files[1], far);
  append(all, far);
  PipelineOptions options = options_of(files, folder / "out");
  options.output.dem = {true, 20.0, 100.0, true, false};
  expect_monolith(options, all);
  EXPECT_EQ(testing::difference_of_dems(options.output.dir), "");
}

TEST(InputShapes, OneTriangleReachesEveryOutput) {
  // As wide as some cells, and smaller than a cell whose centre it misses.
  for (const std::int64_t size : {20'000, 100}) {
    SCOPED_TRACE(size);
    const TemporaryFolder folder;
    const std::vector<Place> corners{
        {kX0 + 10, kY0 + 10, 1'000}, {kX0 + size, kY0 + 20, 3'000}, {kX0 + 20, kY0 + size, 2'000}};
    write_places(folder / "three.las", corners);
    PipelineOptions options = options_of({folder / "three.las"}, folder / "out");
    options.output.dem.enabled = true;
    EXPECT_EQ(expect_monolith(options, corners).triangles, 1U);
    EXPECT_EQ(testing::read_layer(folder / "out/layers.gpkg", "tiles").feature.size(), 1U);
    EXPECT_TRUE(testing::read_layer(folder / "out/layers.gpkg", "pits").feature.empty());
    EXPECT_FALSE(testing::read_layer(folder / "out/layers.gpkg", "tiles").box.empty());
    // A DEM has a height where a cell's centre lies in the triangle, and is absent where there is no centre at all.
    const bool has_cells = size > 1'000;
    for (const char* name : {"/dem.tif", "/hillshade.png"})
      EXPECT_EQ(std::filesystem::exists(options.output.dir + name), has_cells) << name;
    if (has_cells) testing::expect_dem_interpolates(options.output.dir, 100.0, 100);
    EXPECT_FALSE(testing::bytes_of(folder / "out/report.txt").empty());
  }
}

}  // namespace
}  // namespace hydrotin
