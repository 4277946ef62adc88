#include <cpl_vsi.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "common_lattice.h"
#include "monolith.h"
#include "pipeline_outputs.h"
#include "plan.h"
#include "shared_data.h"

/// Inputs as they come: awkward places, awkward headers, awkward files.
///
/// Points are given in thousandths of a metre, so that one cloud can be written with many scales and offsets.

namespace hydrotin {
namespace {

using testing::error_of;
using testing::Place;
using testing::Random;
using testing::run;
using testing::Surface;
using testing::TemporaryFolder;

constexpr std::int64_t kX0 = 500'000'000, kY0 = 4'000'000'000;

/// How a file says where its points are.
struct Header {
  std::int64_t scale = 10, scale_z = 10;
  Place offset{kX0, kY0, 0};
  std::string crs = "EPSG:32633";
  std::uint8_t classification = 2;
};

void write_places(const std::string& path, const std::vector<Place>& places, const Header& header = {}) {
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
std::vector<Place> hills(std::uint64_t seed, std::size_t n, std::int64_t x0, std::int64_t y0, std::int64_t width,
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

void append(std::vector<Place>& to, const std::vector<Place>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

PipelineOptions options_of(const std::vector<std::string>& files, const std::string& out) {
  PipelineOptions options = testing::options_for(files, out);
  options.output.mesh_ply = true;
  options.tiles.target_points = 1'500;
  options.run.workers = 2;
  return options;
}

/// Runs the files in many tiles and demands what one triangulation in memory of all places gives.
DatasetSummary expect_monolith(const PipelineOptions& options, const std::vector<Place>& places) {
  const Lattice lattice = make_plan(options).lattice;
  testing::Cloud cloud;
  for (const Place& p : places) {
    const auto at = [&](std::size_t axis, double zero, double scale) {
      return static_cast<std::int32_t>(std::llround((static_cast<double>(p[axis]) / 1000 - zero) / scale));
    };
    cloud.position.push_back({at(0, lattice.x(0), lattice.scale_xy), at(1, lattice.y(0), lattice.scale_xy)});
    cloud.height.push_back(at(2, lattice.z(0), lattice.scale_z));
  }
  const testing::Monolith expected =
      testing::run_monolith(cloud.position, cloud.height, options.triangulation.order, options.triangulation.objective,
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
  const Surface surface = testing::read_surface(options.output.dir);
  EXPECT_EQ(surface.vertex.size(), expected.vertices);
  EXPECT_EQ(testing::fault_of(surface), "");
  EXPECT_EQ(testing::count_pits(surface), 0U);
  return got;
}

TEST(Inputs, OverlapTouchOrLeaveGaps) {
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

TEST(Inputs, DuplicatesAcrossFilesKeepTheLowest) {
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

TEST(Inputs, VoidsKilometresWide) {
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

TEST(Inputs, HullThatIsNotConvex) {
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

TEST(Inputs, ClustersTensOfKilometresApart) {
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

TEST(Inputs, ScalesAndOffsetsMeetOnOneLattice) {
  // The offsets are no multiples of any scale, and one is a decimal that a product with a power of ten would miss.
  const std::vector<Header> headers{{10, 10, {kX0 + 123, kY0 + 7, -1'005}},
                                    {1, 10, {kX0 - 877, kY0 + 400'001, 50'005}},
                                    {10, 1, {9'167'024'630, kY0 + 2'007, 3}},
                                    {100, 100, {kX0 + 23, kY0 + 1'000'007, 95}}};
  const TemporaryFolder folder;
  std::vector<std::string> files;
  std::vector<Place> all;
  for (std::size_t f = 0; f < headers.size(); ++f) {
    const Header& h = headers[f];
    std::vector<Place> points;
    for (Place p : hills(f, 2'000, kX0 + static_cast<std::int64_t>(f) * 30'000, kY0, 50'000, 50'000, 1)) {
      const std::array<std::int64_t, 3> scale{h.scale, h.scale, h.scale_z};
      for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t rest = (p[a] - h.offset[a]) % scale[a];
        p[a] -= rest < 0 ? rest + scale[a] : rest;
      }
      points.push_back(p);
    }
    files.push_back(folder / ("file" + std::to_string(f) + ".las"));
    write_places(files.back(), points, h);
    append(all, points);
  }
  expect_monolith(options_of(files, folder / "mixed"), all);
  write_places(folder / "alike.las", all, {1, 1, {kX0, kY0, 0}});
  expect_monolith(options_of({folder / "alike.las"}, folder / "alike"), all);
  EXPECT_EQ(testing::read_surface(folder / "mixed").triangles(), testing::read_surface(folder / "alike").triangles());
}

TEST(Inputs, CommonLatticeOfAnyDecimalOffsets) {
  Random random(12);
  for (int round = 0; round < 20'000; ++round) {
    const std::int64_t a = std::int64_t{random.below(1ULL << 31)} * 5, b = std::int64_t{random.below(1ULL << 31)} * 5;
    FileLattice one{"one.las", {0.01, 0.01, 0.01}, {}, {}, {}}, two{"two.las", {0.001, 0.001, 0.01}, {}, {}, {}};
    one.offset = {static_cast<double>(a) / 1000, 0, 0};
    two.offset = {static_cast<double>(b) / 1000, 0, 0};
    one.min = one.max = two.min = two.max = one.offset;
    const FileLattice files[] = {one, two};
    const CommonLattice common = common_lattice(files);
    ASSERT_EQ(common.lattice.scale_xy, 0.001) << a << " " << b;
    ASSERT_EQ(common.map[0].factor[0], 10);
    ASSERT_EQ(common.map[1].factor[0], 1);
    ASSERT_EQ(common.map[1].shift[0] - common.map[0].shift[0], b - a);
  }
}

TEST(Inputs, ScalesWithoutACommonLatticeAreRefused) {
  const TemporaryFolder folder;
  write_places(folder / "good.las", hills(1, 100, kX0, kY0, 10'000, 10'000));
  const auto write_scaled = [&](const std::string& name, double scale) {
    LasWriterOptions options;
    options.scale = {scale, scale, 0.01};
    options.offset = {500'000, 4'000'000, 0};
    options.crs = "EPSG:32633";
    const std::vector<std::int32_t> x{0, 2'000'000'000, 5}, y{0, 7, 2'000'000'000}, z{1, 2, 3};
    LasPoints points;
    points.x = x;
    points.y = y;
    points.z = z;
    LasWriter writer(folder / name, options);
    writer.write(points);
    writer.close();
  };
  write_scaled("thirds.las", 1.0 / 3);
  write_scaled("tenths.las", 1e-7);
  write_scaled("coarse.las", 0.1);
  const auto refusal = [&](const std::vector<std::string>& files) {
    return error_of([&] { (void)plan_run(options_of(files, folder / "out")); }, ErrorKind::input);
  };
  const std::string thirds = refusal({folder / "good.las", folder / "thirds.las"});
  EXPECT_NE(thirds.find("thirds.las"), std::string::npos) << thirds;
  EXPECT_NE(thirds.find("scale"), std::string::npos) << thirds;
  // Each is fine alone; together 200,000 km in steps of 0.1 micrometres.
  const std::string wide = refusal({folder / "tenths.las", folder / "coarse.las"});
  EXPECT_NE(wide.find("coarse.las"), std::string::npos) << wide;
  EXPECT_NE(wide.find("32 bits"), std::string::npos) << wide;
  EXPECT_EQ(plan_run(options_of({folder / "thirds.las"}, folder / "out")).points, 3U);
}

TEST(Inputs, CrsThatDiffersOrIsMissing) {
  const TemporaryFolder folder;
  const auto points = hills(1, 400, kX0, kY0, 20'000, 20'000);
  write_places(folder / "a.las", points);
  Header other;
  other.crs = "EPSG:32632";
  write_places(folder / "b.las", points, other);
  other.crs.clear();
  write_places(folder / "c.las", points, other);
  const auto refusal = [&](const std::vector<std::string>& files) {
    const std::string text = error_of([&] { run(options_of(files, folder / "refused")); }, ErrorKind::input);
    EXPECT_FALSE(std::filesystem::exists(folder / "refused"));
    return text;
  };
  const std::string differs = refusal({folder / "a.las", folder / "b.las"});
  for (const char* word : {"a.las", "b.las", "EPSG:32632", "EPSG:32633", "input.crs"})
    EXPECT_NE(differs.find(word), std::string::npos) << differs;
  const std::string missing = refusal({folder / "a.las", folder / "c.las"});
  for (const char* word : {"c.las", "no CRS", "input.crs"}) EXPECT_NE(missing.find(word), std::string::npos) << missing;

  PipelineOptions given = options_of({folder / "a.las", folder / "b.las", folder / "c.las"}, folder / "given");
  given.input.crs = "EPSG:25833";
  EXPECT_EQ(run(given).points, 1'200U);
  for (const auto& prj : testing::files_in(folder / "given/mesh", ".prj"))
    EXPECT_EQ(testing::epsg_of_wkt(testing::bytes_of(prj)), 25833);
  EXPECT_EQ(testing::read_layer(folder / "given/layers.gpkg", "tiles").epsg, 25833);
  PipelineOptions none = options_of({folder / "c.las"}, folder / "none");
  none.input.crs = "none";
  EXPECT_EQ(run(none).points, 400U);
  EXPECT_TRUE(testing::files_in(folder / "none/mesh", ".prj").empty());
}

TEST(Inputs, NothingToTriangulateIsAnInputError) {
  const TemporaryFolder folder;
  Header vegetation;
  vegetation.classification = 5;
  write_places(folder / "trees.las", hills(1, 400, kX0, kY0, 20'000, 20'000), vegetation);
  const auto refusal = [&](const std::string& file) {
    return error_of([&] { run(options_of({folder / file}, folder / "out")); }, ErrorKind::input);
  };
  const std::string classes = refusal("trees.las");
  EXPECT_NE(classes.find("trees.las"), std::string::npos) << classes;
  EXPECT_NE(classes.find("input.classes"), std::string::npos) << classes;

  std::vector<Place> line;
  for (int i = 0; i < 3'000; ++i) line.push_back({kX0 + 30 * i, kY0 + 70 * i, 1'000 * (i % 7)});
  write_places(folder / "line.las", line);
  EXPECT_NE(refusal("line.las").find("one line"), std::string::npos);
  write_places(folder / "two.las", {line[0], line[5], line[0]});
  EXPECT_NE(refusal("two.las").find("one line"), std::string::npos);
  write_places(folder / "one.las", {line[0]});
  EXPECT_NE(refusal("one.las").find("one line"), std::string::npos);
  write_places(folder / "empty.las", {});
  EXPECT_NE(refusal("empty.las").find("no point"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/terrain/index.h5"));
}

TEST(Inputs, OneTriangleReachesEveryOutput) {
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

TEST(Inputs, FilesWithoutPointsAmongOthers) {
  const TemporaryFolder folder;
  const auto points = hills(2, 4'000, kX0, kY0, 60'000, 60'000);
  write_places(folder / "a_empty.las", {});
  write_places(folder / "b.las", points);
  write_places(folder / "c_empty.las", {}, {1, 1, {7, 9, 11}, "EPSG:32632", 2});
  write_places(folder / "a_empty_without_crs.las", {}, {1, 1, {7, 9, 11}, "", 2});
  expect_monolith(options_of({folder / "*.las"}, folder / "out"), points);
}

TEST(Inputs, CutFilesAreRefusedBeforeAnyWork) {
  const TemporaryFolder folder;
  write_places(folder / "good.las", hills(1, 4'000, kX0, kY0, 60'000, 60'000));
  const std::string whole = testing::bytes_of(folder / "good.las");
  std::ofstream(folder / "cut.las", std::ios::binary) << whole.substr(0, whole.size() - 1);
  const auto refusal = [&](const std::string& file) {
    const PipelineOptions options = options_of({folder / "good.las", folder / file}, folder / "out");
    const std::string plan = error_of([&] { (void)plan_run(options); }, ErrorKind::input);
    EXPECT_NE(plan.find(file), std::string::npos) << plan;
    EXPECT_EQ(error_of([&] { run(options); }, ErrorKind::input), plan);
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  };
  refusal("cut.las");
  if (!testing::has_shared_data()) return;
  const std::string laz = testing::bytes_of(testing::shared_path("quickstart/fusa.laz"));
  for (const std::size_t bytes : {laz.size() - 1, laz.size() / 2, std::size_t{300}}) {
    std::ofstream(folder / "cut.laz", std::ios::binary) << laz.substr(0, bytes);
    refusal("cut.laz");
  }
}

TEST(Inputs, MemoryThatDoesNotHoldATileIsSaidBeforeAnyWork) {
  const TemporaryFolder folder;
  write_places(folder / "a.las", hills(1, 20'000, kX0, kY0, 90'000, 90'000));
  PipelineOptions options = options_of({folder / "a.las"}, folder / "out");
  options.tiles.target_points = 1'000'000;
  options.run.memory_bytes = std::uint64_t{30} << 20;
  for (const bool plan_only : {true, false}) {
    const std::string text = error_of(
        [&] {
          if (plan_only)
            (void)plan_run(options);
          else
            run(options);
        },
        ErrorKind::resource);
    for (const char* word : {"tile 0", "20000 points", "30 MiB", "run.memory", "tiles.target_points"})
      EXPECT_NE(text.find(word), std::string::npos) << text;
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  }
  options.tiles.target_points = 5'000;  // the remedy
  EXPECT_TRUE(run(options).ok);
}

TEST(Inputs, FilesInsideArchives) {
  const TemporaryFolder folder;
  auto all = hills(1, 2'000, kX0, kY0, 50'000, 50'000);
  const auto more = hills(2, 2'000, kX0 + 40'000, kY0, 50'000, 50'000);
  const auto last = hills(3, 2'000, kX0, kY0 + 45'000, 50'000, 50'000);
  write_places(folder / "a.las", all);
  write_places(folder / "b.las", more);
  write_places(folder / "c.las", last);
  const std::string zip = "/vsizip/" + (folder / "survey.zip"), gzip = "/vsigzip/" + (folder / "c.las.gz");
  const auto store = [&](const std::string& from, const std::string& to) {
    const std::string bytes = testing::bytes_of(folder / from);
    VSILFILE* file = VSIFOpenL(to.c_str(), "wb");
    ASSERT_NE(file, nullptr) << to;
    ASSERT_EQ(VSIFWriteL(bytes.data(), 1, bytes.size(), file), bytes.size());
    ASSERT_EQ(VSIFCloseL(file), 0);
  };
  VSILFILE* archive = VSIFOpenL(zip.c_str(), "wb");  // stays open while files are put into it
  ASSERT_NE(archive, nullptr);
  store("a.las", zip + "/a.las");
  store("b.las", zip + "/deep/b.las");
  ASSERT_EQ(VSIFCloseL(archive), 0);
  store("c.las", gzip);
  append(all, more);
  append(all, last);
  const DatasetSummary packed =
      expect_monolith(options_of({zip + "/a.las", zip + "/deep/b.las", gzip}, folder / "packed"), all);
  const DatasetSummary plain =
      run(options_of({folder / "a.las", folder / "b.las", folder / "c.las"}, folder / "plain"));
  EXPECT_EQ(packed.fingerprint, plain.fingerprint);
  const std::string text =
      error_of([&] { (void)plan_run(options_of({zip + "/none.las"}, folder / "none")); }, ErrorKind::input);
  EXPECT_NE(text.find("none.las"), std::string::npos) << text;
}

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

TEST(Outputs, OfAnEarlierRunInTheFolderAreGone) {
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

TEST(Outputs, DemTilesTooLargeForOneBand) {
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

TEST(Outputs, RasterInBandsIsTheRasterInOnePiece) {
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

TEST(Outputs, CarryTheCrsAndAgreeWithEachOther) {
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
      testing::run_monolith(cloud.position, cloud.height, 2, options.triangulation.objective, true,
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
  // Each stands on a vertex that was lifted to the level said.
  std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t> final_height;
  for (const Place& v : testing::read_surface(out).vertex) final_height[{v[0], v[1]}] = v[2];
  for (std::size_t i = 0; i < pits.feature.size(); ++i) {
    const auto& row = pits.feature[i];
    EXPECT_GT(row.at("depth"), 0);
    EXPECT_NEAR(row.at("z_level") - row.at("z_before"), row.at("depth"), 1e-9);
    EXPECT_GE(row.at("vertices"), 1);
    const auto at = final_height.find({std::llround(pits.box[i][0] * 1000), std::llround(pits.box[i][2] * 1000)});
    ASSERT_NE(at, final_height.end());
    EXPECT_EQ(at->second, std::llround(row.at("z_level") * 1000));
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
