#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "hydrotin/las.h"
#include "surveys.h"

/// What a run leaves in its folder: complete, nothing of an earlier run, and of one mind.

namespace hydrotin {
namespace {

using testing::hills;
using testing::kX0;
using testing::kY0;
using testing::options_of;
using testing::Place;
using testing::Random;
using testing::run;
using testing::TemporaryFolder;
using testing::write_places;

// Names and contents of what users open; reports and HDF5 files apart, which say how a run was made.
std::map<std::string, std::string> results_in(const std::string& dir) {
  std::map<std::string, std::string> out;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(dir)) {
    const std::string name = std::filesystem::relative(entry.path(), dir).string();
    if (!entry.is_regular_file()) continue;
    out[name] = name.starts_with("report") || name.ends_with(".h5") ? "" : testing::bytes_of(entry.path().string());
  }
  return out;
}

TEST(PipelineOutputs, OfAnEarlierRunInTheFolderAreGone) {
  const TemporaryFolder folder;
  write_places(folder / "a.las", hills(6, 4'000, kX0, kY0, 100'000, 80'000));
  write_places(folder / "small.las", hills(6, 40, kX0 + 50, kY0 + 600, 300, 300));
  PipelineOptions many = options_of({folder / "a.las"}, folder / "reused");
  many.output.dem.enabled = true;
  PipelineOptions few = many, mesh_only = many, dem_only = many, no_cell = many;
  few.tiles.target_points = 100'000;
  few.output.dem.cell_m = 3;
  few.output.dem.hillshade = false;
  mesh_only.output.dem.enabled = false;
  dem_only.output.mesh_ply = false;
  dem_only.output.dem.cog = false;
  no_cell.input.points = {folder / "small.las"};
  int serial = 0;
  for (PipelineOptions next : {few, mesh_only, dem_only, no_cell, many}) {
    SCOPED_TRACE(serial);
    (void)run(many);
    std::ofstream(many.output.dir + "/mesh/tile_of_mine.txt") << "not ours";
    (void)run(next);
    EXPECT_TRUE(check_dataset(next.output.dir, 100).ok);
    EXPECT_TRUE(std::filesystem::remove(many.output.dir + "/mesh/tile_of_mine.txt"));
    auto reused = results_in(next.output.dir);
    next.output.dir = folder / ("fresh" + std::to_string(serial++));
    (void)run(next);
    EXPECT_TRUE(reused == results_in(next.output.dir));
  }
}

TEST(PipelineOutputs, DemTilesTooLargeForOneBand) {
  const TemporaryFolder folder;
  write_places(folder / "a.las", hills(6, 6'000, kX0, kY0, 90'000, 100'000));
  PipelineOptions whole = options_of({folder / "a.las"}, folder / "whole");
  whole.output.dem = {true, 0.03, 3.0, true, false};
  PipelineOptions cut = whole;
  whole.tiles.target_points = 100'000;
  cut.output.dir = folder / "cut";
  (void)run(whole);
  (void)run(cut);
  EXPECT_EQ(testing::files_in(whole.output.dir + "/dem", ".tif").size(), 1U);
  const Raster one = read_raster(whole.output.dir + "/dem.tif"), many = read_raster(cut.output.dir + "/dem.tif");
  EXPECT_GT(one.grid.size(), std::size_t{1} << 23);  // a band has fewer cells
  EXPECT_EQ(one.grid, many.grid);
  EXPECT_TRUE(one.value == many.value);
  testing::expect_dem_interpolates(whole.output.dir, 3.0, 300);
}

TEST(PipelineOutputs, RasterInBandsIsTheRasterInOnePiece) {
  const TemporaryFolder folder;
  const RasterGrid grid{500'000, 4'000'000, 2, 2, 700, 1'300};
  std::vector<float> value(grid.size());
  Random random(3);
  for (float& v : value) v = random.below(5) == 0 ? kNodata : static_cast<float>(random.below(1'000)) / 8;
  write_places(folder / "crs.las", hills(1, 3, kX0, kY0, 1'000, 1'000));
  const std::string wkt = read_las_header(folder / "crs.las").crs_wkt;
  write_geotiff(folder / "whole.tif", grid, value, wkt);
  EXPECT_TRUE(read_raster(folder / "whole.tif").value == value);
  for (const std::uint32_t rows : {256U, 512U, 1'300U, 2'048U}) {
    const auto fill = [&](std::uint32_t first, std::span<float> band) {
      EXPECT_EQ(first % rows, 0U);
      EXPECT_TRUE(std::all_of(band.begin(), band.end(), [](float v) { return v == kNodata; }));
      const auto from = value.begin() + std::ptrdiff_t{first} * grid.num_columns;
      std::copy(from, from + static_cast<std::ptrdiff_t>(band.size()), band.begin());
    };
    write_geotiff(folder / "bands.tif", grid, rows, fill, wkt);
    EXPECT_TRUE(testing::bytes_of(folder / "bands.tif") == testing::bytes_of(folder / "whole.tif")) << rows;
  }
}

TEST(PipelineOutputs, CarryTheCrsAndAgreeWithEachOther) {
  const TemporaryFolder folder;
  const auto points = hills(6, 12'000, kX0, kY0, 150'000, 120'000);
  write_places(folder / "a.las", points);
  PipelineOptions options = options_of({folder / "a.las"}, folder / "out");
  options.output.dem.enabled = true;
  const Lattice lattice = make_plan(options).lattice;
  testing::Cloud cloud;
  for (const Place& p : points) {
    cloud.position.push_back(
        {static_cast<std::int32_t>((p[0] - kX0) / 10), static_cast<std::int32_t>((p[1] - kY0) / 10)});
    cloud.height.push_back(static_cast<std::int32_t>(p[2] / 10));
  }
  const auto expected =
      testing::run_monolith(cloud.position, cloud.height, 2, options.triangulation.objectives, true,
                            {static_cast<std::int32_t>(lattice.base_x), static_cast<std::int32_t>(lattice.base_y)},
                            static_cast<std::int32_t>(lattice.base_z));
  const DatasetSummary got = run(options);
  EXPECT_EQ(got.fingerprint, expected.fingerprint);
  const std::string out = options.output.dir;

  const auto tiles = testing::files_in(out + "/dem", ".tif");
  const auto meshes = testing::files_in(out + "/mesh", ".ply");
  const std::uint64_t num_tiles = plan_run(options).tiles;
  EXPECT_GE(num_tiles, 8U);
  EXPECT_EQ(tiles.size(), num_tiles);
  EXPECT_EQ(meshes.size(), num_tiles);
  for (const auto& tile : tiles) EXPECT_EQ(testing::epsg_of_raster(tile), 32633) << tile;
  EXPECT_EQ(testing::epsg_of_raster(out + "/dem.tif"), 32633);
  EXPECT_EQ(testing::epsg_of_raster(out + "/dem/mosaic.vrt"), 32633);
  EXPECT_EQ(testing::epsg_of_raster(out + "/hillshade.png"), 32633);
  for (const auto& mesh : meshes)
    EXPECT_EQ(testing::epsg_of_wkt(testing::bytes_of(mesh.substr(0, mesh.size() - 3) + "prj")), 32633) << mesh;
  EXPECT_EQ(testing::difference_of_dems(out), "");
  testing::expect_dem_interpolates(out, 100.0, 300);

  const testing::LayerContent boxes = testing::read_layer(out + "/layers.gpkg", "tiles");
  EXPECT_EQ(boxes.epsg, 32633);
  EXPECT_EQ(boxes.feature.size(), num_tiles);
  double vertices = 0, triangles = 0;
  for (const auto& row : boxes.feature) {
    vertices += row.at("points");
    triangles += row.at("triangles");
  }
  EXPECT_EQ(vertices, static_cast<double>(got.vertices));
  EXPECT_EQ(triangles, static_cast<double>(got.triangles));
  for (const Place& p : points)
    EXPECT_TRUE(std::any_of(boxes.box.begin(), boxes.box.end(), [&](const auto& b) {
      const double x = static_cast<double>(p[0]) / 1000, y = static_cast<double>(p[1]) / 1000, slack = 1e-6;
      return x >= b[0] - slack && x <= b[1] + slack && y >= b[2] - slack && y <= b[3] + slack;
    }));

  const testing::LayerContent pits = testing::read_layer(out + "/layers.gpkg", "pits");
  EXPECT_EQ(pits.epsg, 32633);
  EXPECT_EQ(pits.feature.size(), expected.pits_before);
  EXPECT_GT(pits.feature.size(), 10U);
  // Each stands on a vertex that ends nowhere above the levels of the pools that it lies in.
  std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t> final_height;
  for (const Place& v : testing::read_surface(out).vertex) final_height[{v[0], v[1]}] = v[2];
  for (std::size_t i = 0; i < pits.feature.size(); ++i) {
    const auto& row = pits.feature[i];
    EXPECT_GT(row.at("depth"), 0);
    EXPECT_NEAR(row.at("z_level") - row.at("z_before"), row.at("depth"), 1e-9);
    EXPECT_GE(row.at("vertices"), 1);
    const auto at = final_height.find({std::llround(pits.box[i][0] * 1000), std::llround(pits.box[i][2] * 1000)});
    ASSERT_NE(at, final_height.end());
    EXPECT_EQ(row.at("id"), static_cast<double>(i));
    double level = row.at("z_level");
    for (double parent = row.at("parent"); parent >= 0;) {
      const auto& above = pits.feature[static_cast<std::size_t>(parent)];
      level = std::max(level, above.at("z_level"));
      parent = above.at("parent");
    }
    EXPECT_LE(at->second, std::llround(level * 1000));
  }

  // The pits before lifting, counted in the mesh that was not lifted.
  PipelineOptions measured = options;
  measured.output.dir = folder / "measured";
  measured.pits.method = PitMethod::none;
  const DatasetSummary unlifted = run(measured);
  EXPECT_EQ(unlifted.pits, expected.pits_before);
  EXPECT_EQ(testing::count_pits(testing::read_surface(measured.output.dir)), expected.pits_before);
  EXPECT_EQ(testing::read_layer(measured.output.dir + "/layers.gpkg", "pits").feature.size(), expected.pits_before);
}

}  // namespace
}  // namespace hydrotin
