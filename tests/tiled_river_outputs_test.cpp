// Rivers through the whole pipeline: what users open says what was done, the files prove that every river edge is
// valid, and bad inputs are named.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "expected_error.h"
#include "hdf5_attributes.h"
#include "hydrotin/error.h"
#include "hydrotin/las.h"
#include "hydrotin/vector.h"
#include "monolith.h"
#include "plan.h"
#include "river_scenes.h"
#include "shared_data.h"
#include "store.h"
#include "tiling_fixture.h"

namespace hydrotin {
namespace {

using testing::in_crs;
using testing::kEverything;
using testing::make_scene;
using testing::options_of;
using testing::preserve_some;
using testing::RiverScene;
using testing::run;
using testing::TemporaryFolder;
using testing::write_lines;

TEST(TiledRivers, ReportAndLayersSayWhatWasDone) {
  const TemporaryFolder folder;
  const RiverScene scene = make_scene(folder, 5, 6'000, true);
  PipelineOptions options = options_of(scene, folder / "out", 1'500);
  options.rivers.points_out = PointsFile::las;
  const DatasetSummary summary = run(options);
  const auto report = nlohmann::json::parse(testing::bytes_of(folder / "out/report.json"));
  const auto& rivers = report.at("rivers");
  EXPECT_EQ(rivers.at("river_edges"), summary.river_edges);
  EXPECT_EQ(rivers.at("invalid_river_edges"), 0);
  EXPECT_EQ(rivers.at("lines").at("lines"), scene.line.size());
  EXPECT_EQ(rivers.at("lakes"), 2);
  EXPECT_GT(rivers.at("all").at("wrong_flow_before"), 0);
  EXPECT_EQ(rivers.at("all").at("wrong_flow_after"), 0);
  EXPECT_EQ(rivers.at("all").at("not_valley_after"), 0);
  std::uint64_t edges = 0;
  std::string profile;
  for (std::size_t i = 0; i < rivers.at("rivers").size(); ++i) {
    const auto& river = rivers.at("rivers").at(i);
    edges += river.at("edges").get<std::uint64_t>();
    if (river.at("name") == "stem")
      profile = testing::bytes_of(folder / ("out/profiles/0" + std::to_string(i + 1) + "-stem.svg"));
  }
  EXPECT_EQ(edges, summary.river_edges);
  // A lake that no river reaches is of no river.
  EXPECT_GE(rivers.at("objective").get<double>(), rivers.at("all").at("total_change").get<double>() - 1e-6);
  // The bound is that of rows with margins; heights are then rounded to centimetres.
  EXPECT_LE(rivers.at("bound").get<double>(),
            rivers.at("objective").get<double>() + 0.005 * rivers.at("vertices_moved").get<double>());
  EXPECT_NE(profile.find("<polyline"), std::string::npos);
  EXPECT_NE(profile.find(">stem</text>"), std::string::npos);
  // River vertices as points: their heights in the files.
  std::map<LatticePoint, std::int32_t> height;
  const Lattice lattice = make_plan(options).lattice;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "out/terrain")) {
    if (!entry.path().filename().string().starts_with("tile_")) continue;
    const store::Reader in(entry.path().string());
    const auto x = in.read<std::int32_t>("x"), y = in.read<std::int32_t>("y"), z = in.read<std::int32_t>("height");
    const auto xyz = in.read<std::int32_t>("foreign_xyz"), h = in.read<std::int32_t>("foreign_height");
    for (const std::uint32_t v : in.read<std::uint32_t>("river_edge"))
      if (v < x.size())
        height[{x[v], y[v]}] = z[v];
      else
        height[{xyz[3 * (v - x.size())], xyz[3 * (v - x.size()) + 1]}] = h[v - x.size()];
  }
  const LasFile points(folder / "out/river_vertices.las");
  EXPECT_EQ(points.header().point_count, height.size());
  EXPECT_EQ(points.header().scale[2], lattice.scale_z);
  std::size_t same = 0;
  for (std::size_t chunk = 0; chunk < points.num_chunks(); ++chunk) {
    PointBatch batch;
    points.decode(chunk, batch);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const auto at = [&](std::int32_t value, std::size_t axis, double offset, std::int64_t base) {
        const double c = value * points.header().scale[axis] + points.header().offset[axis];
        return static_cast<std::int32_t>(
            std::llround((c - offset) / points.header().scale[axis] - static_cast<double>(base)));
      };
      const auto found = height.find(
          {at(batch.x[i], 0, lattice.offset_x, lattice.base_x), at(batch.y[i], 1, lattice.offset_y, lattice.base_y)});
      same += found != height.end() && found->second == at(batch.z[i], 2, lattice.offset_z, lattice.base_z) ? 1 : 0;
    }
  }
  EXPECT_EQ(same, height.size());
  options.rivers.points_out = PointsFile::gpkg;
  EXPECT_TRUE(run(options).ok);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/river_vertices.las"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/river_vertices.gpkg"));
  // Without rivers nothing of them is left.
  PipelineOptions without = options;
  without.rivers = {};
  EXPECT_EQ(run(without).river_edges, 0U);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/terrain/rivers.h5"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/profiles"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/river_vertices.gpkg"));
  EXPECT_TRUE(check_dataset(folder / "out", 1000).ok);
}

bool mentions(const DatasetSummary& checked, const std::string& text) {
  return std::any_of(checked.problems.begin(), checked.problems.end(),
                     [&](const std::string& problem) { return problem.find(text) != std::string::npos; });
}

TEST(TiledRivers, CheckFindsWhatIsWrong) {
  const TemporaryFolder folder;
  const RiverScene scene = make_scene(folder, 5, 4'000, true);
  const PipelineOptions options = options_of(scene, folder / "out", 1'000);
  const DatasetSummary summary = run(options);
  ASSERT_TRUE(check_dataset(folder / "out", 10).ok);
  const auto damaged = [&](const std::string& name, auto damage) {
    const std::string copy = folder / name;
    std::filesystem::copy(folder / "out", copy, std::filesystem::copy_options::recursive);
    damage(copy + "/terrain/");
    return copy;
  };
  // The lower end of a river edge that one file holds rises above the upper one.
  const std::string higher = damaged("higher", [&](const std::string& terrain) {
    for (int t = 0; t < 4; ++t) {
      const std::string path = terrain + "tile_00000" + std::to_string(t) + ".h5";
      std::optional<std::pair<std::uint32_t, std::int32_t>> change;
      {
        const store::Reader in(path);
        const auto edge = in.read<std::uint32_t>("river_edge");
        const auto height = in.read<std::int32_t>("height");
        for (std::size_t i = 0; i + 1 < edge.size() && !change; i += 2)
          if (edge[i] < height.size() && edge[i + 1] < height.size()) change = {edge[i + 1], height[edge[i]] + 1};
      }
      if (!change) continue;
      testing::set_entry(path, "height", change->first, change->second);
      return;
    }
  });
  DatasetSummary checked = check_dataset(higher, 10);
  EXPECT_FALSE(checked.ok);
  EXPECT_GT(checked.invalid_river_edges, 0U);
  EXPECT_TRUE(mentions(checked, "is invalid, though nothing speaks against it"));
  EXPECT_TRUE(mentions(checked, "river edges, 0 of them invalid, but there are"));

  checked = check_dataset(damaged("fewer",
                                  [&](const std::string& terrain) {
                                    testing::set_attribute(terrain + "index.h5", "river_edges",
                                                           static_cast<std::int64_t>(summary.river_edges - 1));
                                  }),
                          10);
  EXPECT_TRUE(mentions(checked, "it states " + std::to_string(summary.river_edges - 1) + " river edges"));

  ASSERT_GT(store::Reader(folder / "out/terrain/rivers.h5").size("new_xyz"), 0U) << "the scene needs a Steiner point";
  checked = check_dataset(
      damaged("moved",
              [&](const std::string& terrain) { testing::set_entry(terrain + "rivers.h5", "new_xyz", 2, -7); }),
      10);
  EXPECT_TRUE(mentions(checked, "the new vertex at"));

  const std::string lost =
      damaged("lost", [&](const std::string& terrain) { std::filesystem::remove(terrain + "rivers.h5"); });
  EXPECT_NE(testing::error_of([&] { (void)check_dataset(lost, 10); }, ErrorKind::storage).find("rivers.h5"),
            std::string::npos);
}

PipelineOptions options_for_dem(const std::string& dem, const std::string& lines, std::uint64_t target,
                                const std::string& out) {
  PipelineOptions options = testing::options_for({}, out);
  options.input.dem = {testing::shared_path(dem)};
  options.rivers.lines = testing::shared_path(lines);
  options.tiles.target_points = target;
  return options;
}

TEST(TiledRivers, LinesDrawnUpstreamOnARealDem) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  const PipelineOptions options =
      options_for_dem("dem_rivers_logan/output[0-3].tif", "dem_rivers_logan/logannet.shp", 20'000, folder / "out");
  const DatasetSummary got = run(options);
  EXPECT_TRUE(got.ok);
  EXPECT_EQ(got.pits, 0U);
  EXPECT_EQ(got.river_edges, 2'838U);
  EXPECT_EQ(got.invalid_river_edges, 0U);
  const auto rivers = nlohmann::json::parse(testing::bytes_of(folder / "out/report.json")).at("rivers");
  EXPECT_EQ(rivers.at("lines").at("lines_turned"), 152);
  EXPECT_EQ(rivers.at("all").at("wrong_flow_before"), 522);
  EXPECT_EQ(rivers.at("all").at("not_valley_after"), 0);
  EXPECT_EQ(rivers.at("optimal"), true);
}

TEST(TiledRivers, MemoryIsAskedForBeforeTheLongWork) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  PipelineOptions options =
      options_for_dem("dem_rivers_nc/elev_ned_30m.tif", "dem_rivers_nc/streams.shp", 30'000, folder / "out");
  options.run.memory_bytes = std::uint64_t{64} << 20;
  // 24,005 river edges on 371,000 triangles in the end.
  const PlanSummary plan = plan_run(options);
  EXPECT_NEAR(static_cast<double>(plan.river_edges), 24'005, 2'500);
  EXPECT_NEAR(static_cast<double>(plan.river_bytes), 371'000 * 400.0, 371'000 * 80.0);
  EXPECT_GE(plan.memory_bytes, plan.river_bytes);
  const std::string text = testing::error_of([&] { (void)run(options); }, ErrorKind::resource);
  EXPECT_NE(text.find("streams.shp: about 24"), std::string::npos) << text;
  EXPECT_NE(text.find("bytes an edge), but run.memory is 64 MiB"), std::string::npos) << text;
  EXPECT_FALSE(std::filesystem::exists(folder / "out/work/triangulate"));
  testing::Silent silent;
  EXPECT_NE(
      testing::error_of([&] { run_phase(options, Phase::outline, 0, 1, silent); }, ErrorKind::resource).find("24"),
      std::string::npos);
  options.rivers = {};
  EXPECT_EQ(plan_run(options).river_bytes, 0U);
}

TEST(TiledRivers, BadInputsAreNamed) {
  const TemporaryFolder folder;
  RiverScene scene = make_scene(folder, 3, 2'000, false);
  PipelineOptions options = options_of(scene, folder / "out", 1'000);
  options.rivers.lines = folder / "absent.gpkg";
  EXPECT_NE(testing::error_of([&] { (void)run(options); }, ErrorKind::input).find("absent.gpkg"), std::string::npos);
  scene.line = {{{-900'000, -900'000}, {-890'000, -900'000}}};
  write_lines(scene, folder, "far_");
  options = options_of(scene, folder / "out", 1'000);
  EXPECT_NE(
      testing::error_of([&] { (void)run(options); }, ErrorKind::input).find("no line runs along or across an edge"),
      std::string::npos);
  RiverScene edges = make_scene(folder, 3, 2'000, false);
  preserve_some(edges, folder, options_of(edges, folder / "plan", kEverything), 3'000);
  options = options_of(edges, folder / "out", 1'000);
  options.rivers.matching.direction = LineDirection::digitised;
  options.triangulation.order = 2;  // another terrain, maybe without that edge; and a line that is no edge of either
  {
    GeoPackageWriter out(folder / "preserved.gpkg", "EPSG:32633");
    const int layer = out.add_layer("edges", VectorGeometry::line, false, {});
    out.add_line(layer, std::vector<VectorPoint>{in_crs(edges.position.front()), in_crs(edges.position.back())}, {});
    out.finish();
  }
  EXPECT_NE(testing::error_of([&] { (void)run(options); }, ErrorKind::input).find("runs no edge of the terrain"),
            std::string::npos);
  options.rivers.preserve_edges = options.rivers.lines;  // leaves the terrain
  EXPECT_NE(testing::error_of([&] { (void)run(options); }, ErrorKind::input).find("is outside the terrain"),
            std::string::npos);
  options = options_of(edges, folder / "out", 1'000);
  options.rivers.preserve_edges.clear();
  options.rivers.method = RiverMethod::dp;  // its network parts
  EXPECT_NE(testing::error_of([&] { (void)run(options); }, ErrorKind::input).find("which rivers.method: dp cannot"),
            std::string::npos);
  RiverScene lakes = make_scene(folder, 3, 2'000, true);
  lakes.lake.push_back(lakes.lake[0]);
  write_lines(lakes, folder, "twice_");
  options = options_of(lakes, folder / "out", 1'000);
  EXPECT_NE(testing::error_of([&] { (void)run(options); }, ErrorKind::input).find("lakes must not overlap"),
            std::string::npos);
}

}  // namespace
}  // namespace hydrotin
