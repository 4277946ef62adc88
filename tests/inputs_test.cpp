#include <cpl_vsi.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "common_lattice.h"
#include "shared_data.h"
#include "surveys.h"

/// Inputs as they come: awkward headers that meet on one lattice, awkward files, and those that are refused.

namespace hydrotin {
namespace {

using testing::append;
using testing::error_of;
using testing::expect_monolith;
using testing::Header;
using testing::hills;
using testing::kX0;
using testing::kY0;
using testing::options_of;
using testing::Place;
using testing::Random;
using testing::run;
using testing::TemporaryFolder;
using testing::write_places;

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

}  // namespace
}  // namespace hydrotin
