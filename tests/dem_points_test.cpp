#include "hydrotin/dem_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "expected_error.h"
#include "hydrotin/mesh.h"
#include "plan.h"
#include "raster_files.h"
#include "shared_data.h"
#include "tiling_fixture.h"

namespace hydrotin {
namespace {

using testing::error_of;
using testing::TemporaryFolder;
using testing::TestRaster;
using testing::write_raster;

struct Cells {
  std::map<std::uint64_t, std::array<std::int64_t, 3>> at;  ///< by cell
  DemSkips skips;
};

Cells cells_of(DemFile& dem, std::uint64_t first, std::uint64_t rows) {
  Cells out;
  out.skips = dem.read(first, rows, [&](const DemBatch& batch) {
    for (std::size_t i = 0; i < batch.size(); ++i)
      EXPECT_TRUE(out.at.emplace(batch.cell[i], std::array{batch.x[i], batch.y[i], batch.z[i]}).second);
  });
  return out;
}

Cells cells_of(const std::string& path, const DemReading& reading = {}) {
  DemFile dem(path, reading);
  return cells_of(dem, 0, dem.header().num_rows);
}

double value_at(std::uint64_t cell) {
  return std::round(1e3 * std::sin(static_cast<double>(cell)) * 50) / 1e3;
}

TestRaster relief(int columns, int rows) {
  TestRaster out;
  out.columns = columns;
  out.rows = rows;
  out.type = GDT_Float64;
  for (std::uint64_t c = 0; c < static_cast<std::uint64_t>(columns * rows); ++c) out.value.push_back(value_at(c));
  return out;
}

TEST(DemPoints, CellCentresAndHeightsAreMultiplesOfTheQuantum) {
  const TemporaryFolder folder;
  TestRaster raster = relief(7, 5);
  raster.transform = {500000.5, 2, 0, 4000000.25, 0, -3};
  const Cells got = cells_of(write_raster(folder / "a.tif", raster));
  ASSERT_EQ(got.at.size(), 35U);
  for (const auto& [cell, p] : got.at) {
    EXPECT_EQ(p[0], 500001500 + 2000 * static_cast<std::int64_t>(cell % 7));
    EXPECT_EQ(p[1], 3999998750 - 3000 * static_cast<std::int64_t>(cell / 7));
    EXPECT_EQ(p[2], std::llround(value_at(cell) * 1000));
  }
  raster.transform = {500000.5, 2, 0, 4000000.25, 0, 3};  // rows go up
  const Cells up = cells_of(write_raster(folder / "up.tif", raster));
  EXPECT_EQ(up.at.at(34)[1], 4000001750 + 3000 * 4);
  const Cells coarse = cells_of(folder / "a.tif", {1, std::nullopt, 0.5});
  for (const auto& [cell, p] : coarse.at)
    EXPECT_LE(std::abs(static_cast<double>(p[2]) * 0.5 - value_at(cell)), 0.25 + 1e-12);
}

TEST(DemPoints, NodataMasksAndNumbersThatAreNoneAreCounted) {
  const TemporaryFolder folder;
  TestRaster raster = relief(4, 4);
  raster.type = GDT_Float32;
  raster.nodata = -9999;
  raster.value[3] = -9999;
  raster.value[5] = std::numeric_limits<double>::quiet_NaN();
  raster.value[6] = std::numeric_limits<double>::infinity();
  raster.value[7] = -std::numeric_limits<double>::infinity();
  raster.value[9] = -3.4e38;
  const std::string path = write_raster(folder / "a.tif", raster);
  EXPECT_NE(error_of([&] { (void)cells_of(path); }, ErrorKind::input).find("set input.dem_nodata"), std::string::npos);
  const Cells got = cells_of(path, {1, -3.4e38});
  EXPECT_EQ(got.at.size(), 11U);
  EXPECT_EQ(got.skips.nodata + got.skips.not_finite, 5U);
  EXPECT_GE(got.skips.not_finite, 2U);
  for (const std::uint64_t cell : {3, 5, 6, 7, 9}) EXPECT_FALSE(got.at.contains(cell));
}

TEST(DemPoints, ScaleOffsetAndBand) {
  const TemporaryFolder folder;
  TestRaster raster = relief(3, 2);
  raster.bands = 2;
  raster.type = GDT_Int16;
  raster.scale = 0.1;
  raster.offset = 100;
  raster.value = {0, 1, 2, 3, 4, 5, 10, 20, 30, 40, 50, -7};
  const std::string path = write_raster(folder / "a.tif", raster);
  EXPECT_EQ(cells_of(path).at.at(4)[2], 100400);
  EXPECT_EQ(cells_of(path, {2, std::nullopt}).at.at(5)[2], 99300);
  EXPECT_NE(error_of(
                [&] {
                  (void)cells_of(path, {3, std::nullopt});
                },
                ErrorKind::input)
                .find("no band 3; its bands are 1 to 2"),
            std::string::npos);
}

TEST(DemPoints, RangesOfRowsMakeTheWhole) {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& creation :
       {std::vector<std::string>{}, {"TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=32"}, {"BLOCKYSIZE=7"}}) {
    TestRaster raster = relief(101, 97);
    raster.creation = creation;
    const std::string path = write_raster(folder / "a.tif", raster);
    const Cells whole = cells_of(path);
    EXPECT_EQ(whole.at.size(), raster.value.size());
    Cells parts;
    for (std::uint64_t row = 0; row < 97; row += 13) {
      DemFile dem(path);
      for (const auto& [cell, p] : cells_of(dem, row, 13).at) {
        EXPECT_TRUE(cell / 101 >= row && cell / 101 < row + 13);
        EXPECT_TRUE(parts.at.emplace(cell, p).second);
      }
    }
    EXPECT_EQ(parts.at, whole.at);
  }
}

TEST(DemPoints, WhatIsNoDemIsRefusedWithTheReason) {
  const TemporaryFolder folder;
  const auto says = [&](const TestRaster& raster, const std::string& text, const DemReading& reading = {}) {
    const std::string path = write_raster(folder / "bad.tif", raster);
    const std::string got = error_of([&] { (void)DemFile(path, reading); }, ErrorKind::input);
    EXPECT_EQ(got.find(path), 0U) << got;
    EXPECT_NE(got.find(text), std::string::npos) << got;
    std::filesystem::remove(path);
  };
  TestRaster raster = relief(3, 3);
  raster.transform = {500000, 1, 0.1, 4000000, 0.1, -1};
  says(raster, "it is rotated");
  raster = relief(3, 3);
  raster.is_located = false;
  says(raster, "does not say where it lies");
  raster = relief(3, 3);
  raster.type = GDT_CFloat32;
  says(raster, "complex");
  raster = relief(3, 3);
  raster.transform = {500000, 0.001, 0, 4000000, 0, -0.001};
  says(raster, "give a smaller quantum");
  EXPECT_NE(error_of([&] { (void)DemFile(folder / "absent.tif"); }, ErrorKind::input).find("absent.tif"),
            std::string::npos);
  std::ofstream(folder / "text.tif") << "no raster\n";
  EXPECT_NE(error_of([&] { (void)DemFile(folder / "text.tif"); }, ErrorKind::input).find("cannot be opened"),
            std::string::npos);
}

TEST(DemPoints, CutFilesAreNoticed) {
  const TemporaryFolder folder;
  TestRaster raster = relief(300, 300);
  raster.creation = {"TILED=YES", "BLOCKXSIZE=64", "BLOCKYSIZE=64"};
  const std::string path = write_raster(folder / "a.tif", raster);
  const auto size = std::filesystem::file_size(path);
  for (const double share : {0.02, 0.3, 0.7, 0.99}) {
    std::filesystem::copy_file(path, folder / "cut.tif", std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(folder / "cut.tif", static_cast<std::uintmax_t>(share * static_cast<double>(size)));
    const std::string got = error_of([&] { (void)cells_of(folder / "cut.tif"); }, ErrorKind::input);
    EXPECT_EQ(got.find(folder / "cut.tif"), 0U) << got;
  }
}

TEST(DemPoints, RastersAreToldFromListsOfPoints) {
  const TemporaryFolder folder;
  EXPECT_TRUE(is_raster(write_raster(folder / "a.tif", relief(3, 3))));
  std::ofstream(folder / "p.csv") << "x,y,z\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n";
  EXPECT_FALSE(is_raster(folder / "p.csv"));
  EXPECT_FALSE(is_raster(folder / "absent"));
}

std::vector<std::array<double, 3>> vertices_of(const std::string& ply) {
  const Mesh mesh = read_mesh(ply);
  std::vector<std::array<double, 3>> out;
  for (const MeshVertex& v : mesh.vertex)
    out.push_back({std::round(v[0] * 1e3), std::round(v[1] * 1e3), std::round(v[2] * 1e3)});
  std::sort(out.begin(), out.end());
  return out;
}

// A DEM is the cloud of its cells, alone or beside points.
TEST(DemInput, IsTheCloudOfItsCells) {
  const TemporaryFolder folder;
  TestRaster raster = relief(60, 50);
  raster.nodata = -9999;
  raster.value[70] = raster.value[1234] = -9999;
  const std::string dem = write_raster(folder / "dem.tif", raster);
  std::vector<LatticePoint> position, beside;
  std::vector<std::int32_t> height, beside_height;
  for (const auto& [cell, p] : cells_of(dem).at) {
    position.push_back({static_cast<std::int32_t>(p[0] - 500000000), static_cast<std::int32_t>(p[1] - 4000000000)});
    height.push_back(static_cast<std::int32_t>(p[2]));
  }
  for (std::int32_t i = 0; i < 500; ++i) {
    beside.push_back({70000 + i * 37 % 9000, -i * 53 % 40000});
    beside_height.push_back(i * 11 % 700);
  }
  LasWriterOptions header = testing::cloud_header();
  header.scale = {0.001, 0.001, 0.001};
  testing::write_cloud(folder / "cells.las", position, height, header);
  testing::write_cloud(folder / "beside.las", beside, beside_height, header);
  for (const bool is_mixed : {false, true}) {
    PipelineOptions by_cloud = testing::options_for({folder / "cells.las"}, folder / "cloud");
    PipelineOptions by_dem = testing::options_for({}, folder / "out");
    by_dem.input.dem = {folder / "d*.tif"};
    for (PipelineOptions* options : {&by_cloud, &by_dem}) {
      options->output.mesh_ply = true;
      options->pits.method = PitMethod::none;
      if (is_mixed) options->input.points.push_back(folder / "beside.las");
    }
    const DatasetSummary expected = testing::run(by_cloud), got = testing::run(by_dem);
    EXPECT_EQ(plan_run(by_dem).files, is_mixed ? 2U : 1U);
    EXPECT_EQ(got.points, is_mixed ? 3498U : 2998U);
    EXPECT_EQ(got.points, expected.points);
    EXPECT_EQ(got.triangles, expected.triangles);
    EXPECT_EQ(got.pits, expected.pits);
    EXPECT_EQ(vertices_of(folder / "out/mesh/tile_000000.ply"), vertices_of(folder / "cloud/mesh/tile_000000.ply"));
    EXPECT_TRUE(check_dataset(folder / "out").ok);
    std::filesystem::remove_all(folder / "out");
    std::filesystem::remove_all(folder / "cloud");
  }
}

// Units are ranges of rows, so that a large raster is shared and never whole in memory.
// The same cells from a GeoTIFF and as variables of a netCDF file and pages of a TIFF; a file of several variables by
// itself is refused.
TEST(DemInput, SubdatasetsAreRasters) {
  const TemporaryFolder folder;
  GDALAllRegister();
  GDALDriverH memory = GDALGetDriverByName("MEM");
  const std::unique_ptr<void, decltype(&GDALClose)> source(GDALCreate(memory, "", 60, 50, 1, GDT_Float32, nullptr),
                                                           GDALClose);
  double frame[6] = {500000, 2, 0, 4000000, 0, -2};
  GDALSetGeoTransform(source.get(), frame);
  OGRSpatialReferenceH crs = OSRNewSpatialReference(nullptr);
  OSRImportFromEPSG(crs, 32633);
  GDALSetSpatialRef(source.get(), crs);
  OSRDestroySpatialReference(crs);
  std::vector<float> z(60 * 50);
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = static_cast<float>((i * 7919) % 1000) / 8;
  ASSERT_EQ(
      GDALRasterIO(GDALGetRasterBand(source.get(), 1), GF_Write, 0, 0, 60, 50, z.data(), 60, 50, GDT_Float32, 0, 0),
      CE_None);
  const auto copy = [&](const char* driver, const std::string& path, char** options) {
    GDALDatasetH out =
        GDALCreateCopy(GDALGetDriverByName(driver), path.c_str(), source.get(), FALSE, options, nullptr, nullptr);
    ASSERT_NE(out, nullptr) << path;
    GDALClose(out);
  };
  copy("GTiff", folder / "dem.tif", nullptr);
  copy("netCDF", folder / "dem.nc", nullptr);
  for (const char* table : {"first", "second"}) {
    char** options = CSLSetNameValue(nullptr, "RASTER_TABLE", table);
    options = CSLSetNameValue(options, "APPEND_SUBDATASET", std::string(table) == "first" ? "NO" : "YES");
    options = CSLSetNameValue(options, "TILING_SCHEME", "CUSTOM");
    copy("GPKG", folder / "two.gpkg", options);
    CSLDestroy(options);
  }
  const auto result = [&](const std::string& name, const std::string& raster) {
    PipelineOptions options = testing::options_for({}, folder / name);
    options.input.dem = {raster};
    options.tiles.target_points = 2'000;
    options.run.workers = 2;
    options.output.dem.enabled = options.output.mesh_ply = false;
    return testing::run(options);
  };
  const DatasetSummary expected = result("tif", folder / "dem.tif");
  EXPECT_EQ(expected.vertices, 3'000U);
  for (const std::string& raster :
       {"NETCDF:" + (folder / "dem.nc") + ":Band1", "NETCDF:\"" + (folder / "d*.nc") + "\":Band1",
        "GTIFF_DIR:1:" + (folder / "dem.tif"), folder / "dem.nc", "GPKG:" + (folder / "two.gpkg") + ":second"})
    EXPECT_EQ(result("sub", raster).fingerprint, expected.fingerprint) << raster;
  EXPECT_NE(error_of([&] { (void)result("none", "NETCDF:" + (folder / "none.nc") + ":z"); }, ErrorKind::input)
                .find("nothing matches"),
            std::string::npos);
  EXPECT_NE(
      error_of([&] { (void)result("none", "NETCDF:" + (folder / "dem.nc") + ":no"); }, ErrorKind::input).find("dem.nc"),
      std::string::npos);
  EXPECT_NE(error_of([&] { (void)result("none", folder / "two.gpkg"); }, ErrorKind::input).find("subdatasets"),
            std::string::npos);
}

TEST(DemInput, LargeRastersAreReadInRangesOfRows) {
  const TemporaryFolder folder;
  TestRaster raster;
  raster.columns = raster.rows = 9000;
  raster.nodata = -9999;
  raster.type = GDT_Int16;
  raster.creation = {"TILED=YES", "SPARSE_OK=TRUE"};
  write_raster(folder / "a.tif", raster);
  const GDALDatasetH out = GDALOpen((folder / "a.tif").c_str(), GA_Update);
  std::vector<std::int16_t> patch(40 * 40);
  for (std::size_t i = 0; i < patch.size(); ++i) patch[i] = static_cast<std::int16_t>(i * 37 % 101);
  for (const int at : {0, 1860, 3700, 8960})
    ASSERT_EQ(GDALRasterIO(GDALGetRasterBand(out, 1), GF_Write, at, at, 40, 40, patch.data(), 40, 40, GDT_Int16, 0, 0),
              CE_None);
  GDALClose(out);
  PipelineOptions options = testing::options_for({}, folder / "out");
  options.input.dem = {folder / "a.tif"};
  const Plan plan = make_plan(options);
  ASSERT_GT(plan.files.size(), 3U);
  std::uint64_t rows = 0;
  for (const PlanFile& file : plan.files) {
    EXPECT_EQ(file.first_row, rows);
    EXPECT_EQ(file.first_row % 256, 0U);
    EXPECT_LE(file.points, std::uint64_t{1} << 24);
    rows += file.num_rows;
  }
  EXPECT_EQ(rows, 9000U);
  options.tiles.target_points = 10'000'000;
  const DatasetSummary got = testing::run(options);
  EXPECT_EQ(got.points, 4U * 1600U);
  EXPECT_TRUE(got.ok);
  const auto report = nlohmann::json::parse(testing::bytes_of(folder / "out/report.json"));
  EXPECT_EQ(report.at("files"), 1);
  EXPECT_EQ(report.at("cells_nodata"), 9000 * 9000 - 4 * 1600);
}

TEST(DemInput, RealDemsMakeTerrains) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  PipelineOptions options = testing::options_for({}, folder / "tiles");
  options.input.dem = {testing::shared_path("dem_rivers_logan/output?.tif")};
  const DatasetSummary tiles = testing::run(options);
  options.input.dem = {testing::shared_path("dem_rivers_logan/output.vrt")};
  options.output.dir = folder / "mosaic";
  const DatasetSummary mosaic = testing::run(options);
  EXPECT_EQ(tiles.vertices, 143922U);
  EXPECT_EQ(tiles.fingerprint, mosaic.fingerprint);
  EXPECT_TRUE(check_dataset(folder / "mosaic").ok);
}

}  // namespace
}  // namespace hydrotin
