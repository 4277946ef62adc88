#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "monolith.h"
#include "pipeline_outputs.h"
#include "shared_data.h"

/// The whole pipeline on real surveys, judged by what stands in its files.

namespace hydrotin {
namespace {

using testing::run;
using testing::shared_path;
using testing::TemporaryFolder;

constexpr std::uint64_t kEverything = 1'000'000'000;
const char* const kBlanca = "quickstart/Blanca_in_Pozo_USGS_UTM11_NAD83_all_color_cl2_SC12.laz";

PipelineOptions options_of(const std::vector<std::string>& files, const std::string& out, std::uint64_t target) {
  PipelineOptions options = testing::options_for({}, out);
  for (const auto& file : files) options.input.points.push_back(shared_path(file));
  options.tiles.target_points = target;
  options.output.mesh_ply = true;
  options.run.workers = 2;
  return options;
}

std::size_t distinct_places(const testing::Cloud& cloud) {
  auto place = cloud.position;
  std::sort(place.begin(), place.end());
  return static_cast<std::size_t>(std::unique(place.begin(), place.end()) - place.begin());
}

/// The run's own words, the independent count of points, the check, and the mesh must all say the same.
void expect_sound(const PipelineOptions& options, const DatasetSummary& got) {
  const testing::Cloud cloud = testing::read_cloud(options.input.points, 2);
  const std::size_t distinct = distinct_places(cloud);
  EXPECT_EQ(got.points, cloud.position.size());
  EXPECT_EQ(got.vertices, distinct);
  EXPECT_EQ(got.duplicates, cloud.position.size() - distinct);
  EXPECT_TRUE(got.ok);
  EXPECT_EQ(got.pits, 0U);
  EXPECT_LE(got.max_triangle_order, options.triangulation.order);

  const DatasetSummary checked = check_dataset(options.output.dir, 20'000);
  EXPECT_TRUE(checked.ok) << (checked.problems.empty() ? "" : checked.problems.front());
  EXPECT_EQ(checked.points, got.points);
  EXPECT_EQ(checked.vertices, got.vertices);
  EXPECT_EQ(checked.duplicates, got.duplicates);
  EXPECT_EQ(checked.triangles, got.triangles);
  EXPECT_EQ(checked.pits, 0U);
  EXPECT_LE(checked.max_triangle_order, options.triangulation.order);
  EXPECT_EQ(checked.fingerprint, got.fingerprint);

  const testing::Surface surface = testing::read_surface(options.output.dir);
  EXPECT_EQ(surface.vertex.size(), distinct);
  EXPECT_EQ(surface.triangle.size(), got.triangles);
  EXPECT_EQ(testing::fault_of(surface), "");
  EXPECT_EQ(testing::count_pits(surface), 0U);
}

TEST(Blanca, DuplicatesMergedCheckPassesAndNoPitIsLeft) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  const PipelineOptions options = options_of({kBlanca}, folder / "out", 100'000);
  const DatasetSummary got = run(options);
  EXPECT_EQ(got.points, 574'092U);
  EXPECT_GT(got.duplicates, 49'954U);  // those equal in z too
  EXPECT_EQ(got.max_triangle_order, 2);
  expect_sound(options, got);
}

struct DemComparison {
  std::size_t theirs = 0, common = 0;
  double median = 0, rms = 0;
};

DemComparison compare(const Raster& ours, const Raster& theirs) {
  DemComparison out;
  std::vector<double> difference;
  for (std::uint32_t r = 0; r < theirs.grid.num_rows; ++r)
    for (std::uint32_t c = 0; c < theirs.grid.num_columns; ++c) {
      const std::size_t there = std::size_t{r} * theirs.grid.num_columns + c;
      if (theirs.is_nodata(there)) continue;
      ++out.theirs;
      const double column = (theirs.grid.center_x(c) - ours.grid.x_min) / ours.grid.cell_x;
      const double row = (ours.grid.y_max - theirs.grid.center_y(r)) / ours.grid.cell_y;
      if (column < 0 || row < 0 || column >= ours.grid.num_columns || row >= ours.grid.num_rows) continue;
      const std::size_t here = static_cast<std::size_t>(row) * ours.grid.num_columns + static_cast<std::size_t>(column);
      if (ours.is_nodata(here)) continue;
      difference.push_back(static_cast<double>(ours.value[here]) - static_cast<double>(theirs.value[there]));
    }
  out.common = difference.size();
  if (difference.empty()) return out;
  double squares = 0;
  for (const double d : difference) squares += d * d;
  out.rms = std::sqrt(squares / static_cast<double>(difference.size()));
  std::nth_element(difference.begin(), difference.begin() + static_cast<std::ptrdiff_t>(difference.size() / 2),
                   difference.end());
  out.median = difference[difference.size() / 2];
  return out;
}

TEST(Blanca, DemBeforeLiftingIsTheAuthorsDem) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  PipelineOptions options = options_of({kBlanca}, folder / "out", 100'000);
  options.pits.method = PitMethod::none;
  options.output.mesh_ply = false;
  options.output.dem = {true, 1.0, 0.0, true, false};
  (void)run(options);
  const Raster ours = read_raster(options.output.dir + "/dem.tif");
  const Raster theirs = read_raster(shared_path("quickstart/Blanca_in_Pozo_USGS_UTM11_NAD83_SC12_1m.tif"));
  // Cells of both lie on whole metres; without a limit of edges ours cover the hull, theirs the catchment.
  EXPECT_EQ(std::fmod(ours.grid.x_min - theirs.grid.x_min, 1.0), 0.0);
  EXPECT_EQ(std::fmod(ours.grid.y_max - theirs.grid.y_max, 1.0), 0.0);
  const DemComparison found = compare(ours, theirs);
  std::printf("Blanca, ours minus the authors' 1 m DEM: %zu of their %zu cells, median %.4f m, RMS %.4f m\n",
              found.common, found.theirs, found.median, found.rms);
  EXPECT_EQ(found.theirs, 52'703U);
  EXPECT_EQ(found.common, found.theirs);
  EXPECT_LE(std::fabs(found.median), 0.005);
  EXPECT_LE(found.rms, 0.05);
  // Moved by one cell it would be another terrain: the agreement is not a matter of course.
  Raster moved = ours;
  moved.grid.x_min += 1;
  EXPECT_GT(compare(moved, theirs).rms, 10 * found.rms);
}

TEST(TilesOfBcts, SeamsAreInvisible) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  const std::vector<std::string> files{"tiles_bcts/bcts_1.laz", "tiles_bcts/bcts_2.laz", "tiles_bcts/bcts_3.laz",
                                       "tiles_bcts/bcts_4.laz"};
  PipelineOptions whole = options_of(files, folder / "whole", kEverything);
  PipelineOptions cut = options_of(files, folder / "cut", 10'000 * 2'834'350ULL / 150'341);
  whole.output.dem = cut.output.dem = {true, 1.0, 30.0, true, true};
  const DatasetSummary one = run(whole), many = run(cut);
  EXPECT_EQ(one.points, 150'341U);
  EXPECT_EQ(one.fingerprint, many.fingerprint);
  EXPECT_EQ(one.vertices, many.vertices);
  EXPECT_EQ(testing::files_in(whole.output.dir + "/mesh", ".ply").size(), 1U);
  EXPECT_GE(testing::files_in(cut.output.dir + "/mesh", ".ply").size(), 10U);
  EXPECT_EQ(testing::read_surface(whole.output.dir).triangles(), testing::read_surface(cut.output.dir).triangles());

  const Raster a = read_raster(whole.output.dir + "/dem.tif"), b = read_raster(cut.output.dir + "/dem.tif");
  EXPECT_EQ(a.grid, b.grid);
  EXPECT_TRUE(a.value == b.value);
  for (const char* name : {"/dem.tif", "/hillshade.png"})
    EXPECT_TRUE(testing::bytes_of(whole.output.dir + name) == testing::bytes_of(cut.output.dir + name)) << name;
  EXPECT_EQ(testing::difference_of_dems(cut.output.dir), "");
  testing::expect_dem_interpolates(cut.output.dir, 30.0, 200);
  expect_sound(cut, many);

  // Across a seam of the inputs, at y = 629400, the terrain goes on: there is no strip without heights.
  std::size_t with_height = 0, rows = 0;
  for (std::uint32_t r = 0; r < b.grid.num_rows; ++r) {
    if (std::fabs(b.grid.center_y(r) - 629400) > 2) continue;
    ++rows;
    for (std::uint32_t c = 0; c < b.grid.num_columns; ++c)
      with_height += !b.is_nodata(std::size_t{r} * b.grid.num_columns + c);
  }
  EXPECT_EQ(rows, 4U);
  EXPECT_GT(with_height, rows * 150);
}

TEST(TilesOfFarmA, WithheldPointsAreDropped) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  const PipelineOptions options = options_of({"tiles_farm_a_normalised/PRJ_A_207340_7357420_g_c_d_n_u.laz",
                                              "tiles_farm_a_normalised/PRJ_A_207480_7357420_g_c_d_n_u.laz"},
                                             folder / "out", 400'000);
  std::uint64_t ground = 0, withheld_ground = 0;
  for (const auto& path : options.input.points) {
    const LasFile file(path);
    PointBatch batch;
    for (std::size_t c = 0; c < file.num_chunks(); ++c) {
      file.decode(c, batch);
      for (std::size_t i = 0; i < batch.size(); ++i) {
        ground += batch.classification[i] == 2;
        withheld_ground += batch.classification[i] == 2 && (batch.flags[i] & PointFlag::withheld) != 0;
      }
    }
  }
  EXPECT_EQ(ground, 47'692U + 80'802U);
  EXPECT_GT(withheld_ground, 1'000U);
  const DatasetSummary got = run(options);
  EXPECT_EQ(got.points, ground - withheld_ground);
  expect_sound(options, got);

  PipelineOptions with = options;
  with.input.withheld = true;
  with.output.dir = folder / "with";
  with.output.mesh_ply = false;
  EXPECT_EQ(run(with).points, ground);
}

TEST(RiverTileOfIgn, OrderThreeInLambert93) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  PipelineOptions options =
      options_of({"lidar_river_ign/test_semis_2023_0292_6833_LA93_IGN69.laz"}, folder / "out", 100'000);
  options.triangulation.order = 3;
  EXPECT_EQ(plan_run(options).crs, "EPSG:2154");
  const DatasetSummary got = run(options);
  EXPECT_EQ(got.points, 152'678U);
  EXPECT_EQ(got.max_triangle_order, 3);
  expect_sound(options, got);
  for (const auto& mesh : testing::files_in(options.output.dir + "/mesh", ".prj"))
    EXPECT_EQ(testing::epsg_of_wkt(testing::bytes_of(mesh)), 2154) << mesh;
}

}  // namespace
}  // namespace hydrotin
