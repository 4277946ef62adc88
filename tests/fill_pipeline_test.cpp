// `fill` on the TIN that a run made, against a run with the same options: surfaces, layers, tables and rasters.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>

#include "hydrotin/las.h"
#include "hydrotin/vector.h"
#include "pipeline_outputs.h"
#include "tiling_fixture.h"

namespace hydrotin {
namespace {

using testing::TemporaryFolder;

struct Answer {
  int code = -1;
  std::string err;
};

Answer fill(const TemporaryFolder& folder, const std::string& arguments) {
  const std::string command = "cd '" + folder.path() + "' && '" HYDROTIN_PROGRAM "' fill " + arguments + " >'" +
                              (folder / "stdout") + "' 2>'" + (folder / "stderr") + "' </dev/null";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128, testing::bytes_of(folder / "stderr")};
}

/// Hills with plateaus and lakes, as LAS files, and their TIN.
class FillAndRun : public ::testing::Test {
 protected:
  void SetUp() override {
    position_ = testing::distinct(testing::make_cloud(testing::CloudKind::uniform, 29, 4'000, 100));
    std::vector<std::int32_t> height;
    for (const LatticePoint p : position_) height.push_back((testing::relief_at(29, p, 3000, 2000, 5) / 10) * 10 / 10);
    files_ = testing::write_files(folder_, position_, height, 1);
    for (const LatticePoint p : position_) box_.extend(p);
    PipelineOptions options = options_of("tin", PitMethod::none);
    ASSERT_TRUE(testing::run(options).ok);
    tin_ = "tin/mesh/tile_000000.ply";
    ASSERT_TRUE(std::filesystem::exists(folder_ / tin_));
  }

  [[nodiscard]] PipelineOptions options_of(const std::string& out, PitMethod method) const {
    PipelineOptions options = testing::options_for(files_, folder_ / out);
    options.tiles.target_points = 1'000'000;
    options.triangulation.order = 1;
    options.output.mesh_ply = true;
    options.pits.method = method;
    return options;
  }

  [[nodiscard]] VectorPoint world(double fx, double fy) const {
    const double x = box_.min.x + fx * (static_cast<double>(box_.max.x) - box_.min.x),
                 y = box_.min.y + fy * (static_cast<double>(box_.max.y) - box_.min.y);
    return {500'000 + std::round(x) * 0.01, 4'000'000 + std::round(y) * 0.01, 0};
  }

  void write_places() const {
    GeoPackageWriter out(folder_ / "places.gpkg", read_las_header(files_.front()).crs_wkt);
    const std::vector<VectorPoint> ring{world(0.2, 0.2), world(0.6, 0.25), world(0.4, 0.6)},
        line{world(0.7, 0.05), world(0.8, 0.9)};
    out.add_polygon(out.add_layer("sea", VectorGeometry::polygon, false, {}), ring, {});
    out.add_line(out.add_layer("river", VectorGeometry::line, false, {}), line, {});
    out.add_point(out.add_layer("well", VectorGeometry::point, false, {}), world(0.25, 0.85), {});
    out.finish();
    GeoPackageWriter ponds(folder_ / "ponds.gpkg", read_las_header(files_.front()).crs_wkt);
    const std::vector<VectorPoint> around{world(0.5, 0.5), world(0.95, 0.4), world(0.9, 0.95)};
    ponds.add_polygon(ponds.add_layer("ponds", VectorGeometry::polygon, false, {}), around, {});
    ponds.finish();
  }

  void expect_equal(const std::string& arguments, const std::function<void(PipelineOptions&)>& set) {
    SCOPED_TRACE(arguments);
    PipelineOptions options = options_of("run", PitMethod::lift);
    options.output.dem.enabled = true;
    options.output.dem.cell_m = 2;
    set(options);
    ASSERT_TRUE(testing::run(options).ok);
    std::filesystem::create_directories(folder_ / "filled/mesh");
    const Answer answer = fill(folder_, tin_ + " " + arguments +
                                            " --search scalable --out filled/mesh/tin.ply --layers filled/layers.gpkg "
                                            "--table filled/pits.csv --change-raster filled/change.tif --cell 2");
    ASSERT_EQ(answer.code, 0) << answer.err;
    expect_equal_surfaces();
    expect_equal_layers();
    expect_equal_rasters();
    double num_kept = 0;
    for (const auto& pit : testing::read_layer(folder_ / "filled/layers.gpkg", "pits").feature)
      num_kept += pit.at("kept");
    EXPECT_EQ(num_kept > 0, options.pits.keep.any() || options.pits.cheapest.has_value());
    std::filesystem::remove_all(folder_ / "run");
    std::filesystem::remove_all(folder_ / "filled");
  }

  TemporaryFolder folder_;
  std::vector<std::string> files_;
  std::vector<LatticePoint> position_;
  LatticeBox box_;
  std::string tin_;

 private:
  void expect_equal_surfaces() const {
    const testing::Surface expected = testing::read_surface(folder_ / "run"),
                           got = testing::read_surface(folder_ / "filled"),
                           before = testing::read_surface(folder_ / "tin");
    EXPECT_EQ(got.vertex, expected.vertex);
    EXPECT_EQ(got.triangle, expected.triangle);
    EXPECT_NE(got.vertex, before.vertex) << "nothing to compare";
  }

  void expect_equal_layers() const {
    EXPECT_EQ(testing::bytes_of(folder_ / "filled/pits.csv"), testing::bytes_of(folder_ / "run/pits.csv"));
    for (const char* name : {"pits", "lifted", "breaches"}) {
      SCOPED_TRACE(name);
      const auto expected = testing::read_layer(folder_ / "run/layers.gpkg", name),
                 got = testing::read_layer(folder_ / "filled/layers.gpkg", name);
      EXPECT_EQ(got.epsg, expected.epsg);
      ASSERT_EQ(got.feature.size(), expected.feature.size());
      for (std::size_t i = 0; i < got.feature.size(); ++i) {
        ASSERT_EQ(got.feature[i].size(), expected.feature[i].size());
        for (const auto& [field, value] : expected.feature[i])
          EXPECT_NEAR(got.feature[i].at(field), value, 1e-9 * std::max(1.0, std::abs(value))) << field << i;
        for (std::size_t side = 0; side < 4; ++side) EXPECT_NEAR(got.box[i][side], expected.box[i][side], 1e-6);
      }
    }
  }

  void expect_equal_rasters() const {
    const Raster expected = read_raster(folder_ / "run/change.tif"), got = read_raster(folder_ / "filled/change.tif");
    ASSERT_EQ(got.grid.num_columns, expected.grid.num_columns);
    ASSERT_EQ(got.grid.num_rows, expected.grid.num_rows);
    EXPECT_NEAR(got.grid.x_min, expected.grid.x_min, 1e-6);
    EXPECT_NEAR(got.grid.y_max, expected.grid.y_max, 1e-6);
    std::size_t num_values = 0;
    for (std::size_t i = 0; i < got.value.size(); ++i) {
      EXPECT_NEAR(got.value[i], expected.value[i], 1e-5);
      num_values += !got.is_nodata(i);
    }
    EXPECT_GT(num_values, 0U);
  }
};

TEST_F(FillAndRun, GiveTheSameResults) {
  write_places();
  expect_equal("--method lift", [](PipelineOptions&) {});
  expect_equal("--method least-change --keep deeper_than_m=1.5 larger_than_m2=60", [](PipelineOptions& options) {
    options.pits.method = PitMethod::least_change;
    options.pits.keep.deeper_than_m = 1.5;
    options.pits.keep.larger_than_m2 = 60;
  });
  expect_equal(
      "--method breach --max-breach-length 9 --max-breach-depth 0.35 --keep volume_above_m3=0.2 "
      "ids=[0,4,9,12,20,25,31,40] "
      "combine=and",
      [](PipelineOptions& options) {
        options.pits.method = PitMethod::breach;
        options.pits.max_breach_length_m = 9;
        options.pits.max_breach_depth_m = 0.35;
        options.pits.keep.volume_above_m3 = 0.2;
        options.pits.keep.ids = {0, 4, 9, 12, 20, 25, 31, 40};
        options.pits.keep.all_conditions = true;
      });
  expect_equal("--method least-change --measure volume --outlets places.gpkg --keep inside=ponds.gpkg",
               [&](PipelineOptions& options) {
                 options.pits.method = PitMethod::least_change;
                 options.pits.measure = ChangeMeasure::volume;
                 options.pits.outlets = OutletPolicy::layer;
                 options.pits.outlet_layer = folder_ / "places.gpkg";
                 options.pits.keep.inside = folder_ / "ponds.gpkg";
               });
  expect_equal("--method least-change --measure max --cheapest 20 --voids-drain --void-edge 3.5",
               [](PipelineOptions& options) {
                 options.pits.method = PitMethod::least_change;
                 options.pits.measure = ChangeMeasure::max;
                 options.pits.cheapest = 20;
                 options.pits.voids_drain = true;
                 options.pits.void_edge_m = 3.5;
               });
}

TEST_F(FillAndRun, LayersAddUpToTheChange) {
  ASSERT_EQ(fill(folder_, tin_ + " --layers layers.gpkg --json").code, 0);
  const std::string json = testing::bytes_of(folder_ / "stdout");
  const auto number_after = [&](const std::string& key) {
    return std::stod(json.substr(json.find("\"" + key + "\":") + key.size() + 3));
  };
  double displacement = 0, volume = 0;
  std::size_t num_edits = 0;
  for (const char* name : {"lifted", "breaches"})
    for (const auto& row : testing::read_layer(folder_ / "layers.gpkg", name).feature) {
      displacement += row.at("displacement");
      volume += row.at("volume");
      ++num_edits;
    }
  EXPECT_GT(num_edits, 20U);
  EXPECT_NEAR(displacement, number_after("total_displacement"), 1e-6);
  EXPECT_NEAR(volume, number_after("volume_change"), 1e-6 * volume);
  EXPECT_EQ(num_edits, number_after("lifted_regions") + number_after("breaches"));
  EXPECT_EQ(number_after("minima_after"), 0);
  EXPECT_EQ(static_cast<double>(testing::read_layer(folder_ / "layers.gpkg", "pits").feature.size()),
            number_after("minima_before"));
}

TEST_F(FillAndRun, RefusesWithOneSentence) {
  write_places();
  const std::vector<std::pair<std::string, std::string>> refused{{"--keep deep=3", "unknown key 'deep'"},
                                                                 {"--keep deeper_than_m=x", "deeper_than_m"},
                                                                 {"--keep 7", "KEY=VALUE"},
                                                                 {"--keep ids=[100000]", "there is no pit 100000"},
                                                                 {"--keep ids=[1] --cheapest 3", "give one of the two"},
                                                                 {"--pits 3 --cheapest 3", "give one of the two"},
                                                                 {"--cheapest many", "--cheapest"},
                                                                 {"--max-breach-depth -1", "--max-breach-depth"},
                                                                 {"--void-edge 3", "--voids-drain"},
                                                                 {"--search everywhere", "--search"},
                                                                 {"--change-raster c.tif --cell 0", "--cell"},
                                                                 {"--change-raster c.tif --cell 1e-6", "--cell"},
                                                                 {"--outlets nowhere.gpkg", "no such file"},
                                                                 {"--crs EPSG:0", "--crs"}};
  for (const auto& [arguments, sentence] : refused) {
    SCOPED_TRACE(arguments);
    const Answer answer = fill(folder_, tin_ + " " + arguments);
    EXPECT_EQ(answer.code, 2);
    EXPECT_NE(answer.err.find(sentence), std::string::npos) << answer.err;
    EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "c.tif"));
  }
  const Answer absent = fill(folder_, tin_ + " --keep inside=nowhere.gpkg");
  EXPECT_EQ(absent.code, 3);
  EXPECT_NE(absent.err.find("nowhere.gpkg"), std::string::npos) << absent.err;
  {
    GeoPackageWriter out(folder_ / "far.gpkg", read_las_header(files_.front()).crs_wkt);
    out.add_point(out.add_layer("far", VectorGeometry::point, false, {}), {500'000 - 5'000, 4'000'000, 0}, {});
    out.finish();
  }
  const Answer far = fill(folder_, tin_ + " --outlets far.gpkg");
  EXPECT_EQ(far.code, 3);
  EXPECT_NE(far.err.find("water could leave nowhere"), std::string::npos) << far.err;
  const Answer unwritable = fill(folder_, tin_ + " --layers /proc/layers.gpkg");
  EXPECT_EQ(unwritable.code, 4) << unwritable.err;
  // Two triangles on the same side of an edge: a map of it would lie.
  const std::vector<MeshVertex> vertex{{0, 0, 1}, {4, 0, 2}, {0, 4, 3}, {3, 3, 4}};
  const std::vector<MeshTriangle> triangle{{0, 1, 2}, {0, 1, 3}};
  write_ply(folder_ / "fold.ply", vertex, triangle, "");
  EXPECT_EQ(fill(folder_, "fold.ply").code, 0);
  const Answer fold = fill(folder_, "fold.ply --layers l.gpkg");
  EXPECT_EQ(fold.code, 3);
  EXPECT_NE(fold.err.find("same side of the edge between vertices 0 and 1"), std::string::npos) << fold.err;
}

}  // namespace
}  // namespace hydrotin
