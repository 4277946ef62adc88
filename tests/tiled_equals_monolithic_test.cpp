#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "hydrotin/error.h"
#include "layout.h"
#include "monolith.h"
#include "plan.h"
#include "shared_data.h"
#include "tiling_fixture.h"

namespace hydrotin {
namespace {

using testing::CloudKind;
using testing::Monolith;
using testing::TemporaryFolder;

constexpr std::uint64_t kEverything = 1'000'000'000;

struct TestCloud {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
};

TestCloud make_test_cloud(CloudKind kind, std::uint64_t seed, std::size_t n) {
  TestCloud out{testing::make_cloud(kind, seed, n, 100), {}};
  for (std::size_t i = 0; i < out.position.size(); ++i)
    out.height.push_back(testing::relief_at(3, out.position[i], 5000, 2000, 3) / 40 + static_cast<std::int32_t>(i % 3));
  return out;
}

Monolith monolith_of(const TestCloud& cloud, const PipelineOptions& options) {
  const Plan plan = make_plan(options);
  return testing::run_monolith(
      cloud.position, cloud.height, options.triangulation.order, options.triangulation.objective,
      options.pits.outlets == OutletPolicy::hull,
      {static_cast<std::int32_t>(plan.lattice.base_x), static_cast<std::int32_t>(plan.lattice.base_y)},
      static_cast<std::int32_t>(plan.lattice.base_z));
}

void expect_equal(const DatasetSummary& got, const Monolith& expected) {
  EXPECT_EQ(got.fingerprint, expected.fingerprint);
  EXPECT_EQ(got.vertices, expected.vertices);
  EXPECT_EQ(got.duplicates, expected.duplicates);
  EXPECT_EQ(got.triangles, expected.triangles);
  EXPECT_EQ(got.pits, 0U);
  EXPECT_TRUE(got.ok);
}

DatasetSummary run(const PipelineOptions& options) {
  testing::Silent silent;
  return run_pipeline(options, {}, silent);
}

constexpr CloudKind kKinds[] = {CloudKind::uniform, CloudKind::lattice, CloudKind::scanlines, CloudKind::clustered,
                                CloudKind::voided};

class TiledEqualsMonolithic : public ::testing::TestWithParam<CloudKind> {};

INSTANTIATE_TEST_SUITE_P(Clouds, TiledEqualsMonolithic, ::testing::ValuesIn(kKinds),
                         [](const auto& cloud) { return testing::name_of(cloud.param); });

TEST_P(TiledEqualsMonolithic, EveryTileSizeOrderAndObjective) {
  const TemporaryFolder folder;
  const TestCloud cloud = make_test_cloud(GetParam(), 1, 25'000);
  const auto files = testing::write_files(folder, cloud.position, cloud.height, 3);
  for (int k = 0; k <= 4; ++k)
    for (const auto objective : {Objective::local_minima, Objective::min_weight}) {
      if (k % 2 == 1 && objective == Objective::min_weight) continue;
      PipelineOptions options = testing::options_for(files, folder / "monolith");
      options.triangulation = {k, objective};
      options.pits.outlets = k == 3 ? OutletPolicy::lowest : OutletPolicy::hull;
      const Monolith expected = monolith_of(cloud, options);
      for (const std::uint64_t target : {kEverything, std::uint64_t{10'000}, std::uint64_t{3'000}}) {
        SCOPED_TRACE(::testing::Message() << "k " << k << " " << name(objective) << " target " << target);
        options.output.dir = folder / ("out" + std::to_string(target));
        options.tiles.target_points = target;
        options.run.workers = 2;
        expect_equal(run(options), expected);
      }
    }
}

TEST_P(TiledEqualsMonolithic, WorkersMemoryAndOrderOfInputs) {
  const TemporaryFolder folder;
  TestCloud cloud = make_test_cloud(GetParam(), 2, 20'000);
  auto files = testing::write_files(folder, cloud.position, cloud.height, 4);
  PipelineOptions options = testing::options_for(files, folder / "out");
  const Monolith expected = monolith_of(cloud, options);
  int serial = 0;
  for (const std::uint64_t target : {kEverything, std::uint64_t{10'000}, std::uint64_t{3'000}})
    for (const int workers : {1, 2})
      for (const std::uint64_t memory : {std::uint64_t{4} << 30, std::uint64_t{40} << 20}) {
        SCOPED_TRACE(::testing::Message() << "target " << target << " workers " << workers << " memory " << memory);
        options.output.dir = folder / ("out" + std::to_string(serial++));
        options.tiles.target_points = target;
        options.run.workers = workers;
        options.run.memory_bytes = memory;
        expect_equal(run(options), expected);
      }
  // The same points in another order, in other files.
  std::vector<std::size_t> order(cloud.position.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  testing::shuffle(7, order);
  TestCloud shuffled;
  for (const std::size_t i : order) {
    shuffled.position.push_back(cloud.position[i]);
    shuffled.height.push_back(cloud.height[i]);
  }
  const TemporaryFolder other;
  options.input.points = testing::write_files(other, shuffled.position, shuffled.height, 2);
  options.output.dir = other / "out";
  expect_equal(run(options), expected);
}

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_P(TiledEqualsMonolithic, KilledAndResumed) {
  const TemporaryFolder folder;
  const TestCloud cloud = make_test_cloud(GetParam(), 3, 15'000);
  const auto files = testing::write_files(folder, cloud.position, cloud.height, 2);
  PipelineOptions options = testing::options_for(files, folder / "whole");
  options.tiles.target_points = 3'000;
  const DatasetSummary whole = run(options);
  expect_equal(whole, monolith_of(cloud, options));
  testing::Random random(static_cast<std::uint64_t>(GetParam()));
  int killed = 0;
  for (int round = 0; round < 5; ++round) {
    const std::string out = folder / ("killed" + std::to_string(round));
    // Twice in a row: resuming is itself interrupted.
    for (int again = 0; again < 2; ++again) {
      std::vector<std::string> words{HYDROTIN_DYING_RUN,
                                     std::to_string(1 + random.below(45)),
                                     std::to_string(random.below(4000)),
                                     out,
                                     "2",
                                     "3000"};
      words.insert(words.end(), files.begin(), files.end());
      const pid_t child = ::fork();
      if (child == 0) {
        std::vector<char*> argv;
        for (auto& word : words) argv.push_back(word.data());
        argv.push_back(nullptr);
        ::execv(argv[0], argv.data());
        ::_exit(127);
      }
      int status = 0;
      ASSERT_EQ(::waitpid(child, &status, 0), child);
      killed += WIFSIGNALED(status);
      ASSERT_TRUE(WIFSIGNALED(status) || (WIFEXITED(status) && WEXITSTATUS(status) == 0));
    }
    options.output.dir = out;
    EXPECT_EQ(run(options).fingerprint, whole.fingerprint);
    for (const auto& entry : std::filesystem::directory_iterator(folder / "whole/terrain"))
      EXPECT_TRUE(bytes_of(entry.path().string()) == bytes_of(out + "/terrain/" + entry.path().filename().string()))
          << entry.path();
    const DatasetSummary checked = check_dataset(out, 2000);
    EXPECT_TRUE(checked.ok) << (checked.problems.empty() ? "" : checked.problems.front());
  }
  EXPECT_GE(killed, 5);
}

// Every phase as a job array of three tasks, the last task first; single-unit phases leave nothing to tasks 1 and 2.
TEST_P(TiledEqualsMonolithic, PhasesAsJobArrays) {
  const TemporaryFolder folder;
  const TestCloud cloud = make_test_cloud(GetParam(), 4, 10'000);
  PipelineOptions options =
      testing::options_for(testing::write_files(folder, cloud.position, cloud.height, 2), folder / "out");
  options.tiles.target_points = 2'000;
  testing::Silent silent;
  EXPECT_THROW(run_phase(options, Phase::ingest, 0, 1, silent), Error);  // no plan yet
  for (std::size_t p = 0; p < kNumPhases; ++p) {
    for (const std::uint64_t task : {2, 1, 0}) run_phase(options, static_cast<Phase>(p), task, 3, silent);
    const PhaseStatus status = pipeline_status(options)[p];
    EXPECT_EQ(status.done, status.units) << name(static_cast<Phase>(p));
  }
  const DatasetSummary checked = check_dataset(options.output.dir, 0);
  EXPECT_TRUE(checked.ok) << (checked.problems.empty() ? "" : checked.problems.front());
  EXPECT_EQ(checked.order_sample, checked.triangles);
  EXPECT_LE(checked.max_triangle_order, options.triangulation.order);
  EXPECT_EQ(checked.fingerprint, monolith_of(cloud, options).fingerprint);
}

TEST(CheckAfterRun, FindsAnyFlippedBitOfATile) {
  const TemporaryFolder folder;
  const TestCloud cloud = make_test_cloud(CloudKind::uniform, 5, 2'000);
  PipelineOptions options =
      testing::options_for(testing::write_files(folder, cloud.position, cloud.height, 1), folder / "out");
  options.tiles.target_points = 1'000;
  (void)run(options);
  ASSERT_TRUE(check_dataset(options.output.dir, 0).ok);
  const std::string path = folder / "out/terrain/tile_000001.h5";
  const std::string good = bytes_of(path);
  testing::Random random(1);
  for (int i = 0; i < 60; ++i) {
    std::string bad = good;
    const std::size_t at = random.below(bad.size());
    bad[at] = static_cast<char>(bad[at] ^ (1 << random.below(8)));
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bad;
    const DatasetSummary summary = check_dataset(options.output.dir, 0);
    EXPECT_FALSE(summary.ok) << "byte " << at;
    EXPECT_FALSE(summary.problems.empty());
  }
}

struct RealCloud {
  const char* name;
  std::vector<std::string> files;
};

class TiledRealData : public ::testing::TestWithParam<RealCloud> {};

INSTANTIATE_TEST_SUITE_P(
    Clouds, TiledRealData,
    ::testing::Values(RealCloud{"Blanca", {"quickstart/Blanca_in_Pozo_USGS_UTM11_NAD83_all_color_cl2_SC12.laz"}},
                      RealCloud{"fusa", {"quickstart/fusa.laz"}}, RealCloud{"lake", {"quickstart/lake.laz"}},
                      RealCloud{"bcts",
                                {"tiles_bcts/bcts_1.laz", "tiles_bcts/bcts_2.laz", "tiles_bcts/bcts_3.laz",
                                 "tiles_bcts/bcts_4.laz"}}),
    [](const auto& cloud) { return cloud.param.name; });

TEST_P(TiledRealData, EveryTileSizeAndOrder) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  PipelineOptions options = testing::options_for({}, folder / "out");
  for (const auto& file : GetParam().files) options.input.points.push_back(testing::shared_path(file));
  if (std::string(GetParam().name) == "lake") options.input.crs = "none";
  const testing::Cloud points = testing::read_cloud(options.input.points, 2);
  for (int k = 0; k <= 4; ++k) {
    options.triangulation.order = k;
    const Monolith expected = monolith_of({points.position, points.height}, options);
    for (const std::uint64_t target :
         {kEverything, std::uint64_t{50'000}, std::uint64_t{10'000}, std::uint64_t{3'000}}) {
      // All four sizes at the default order; one that cuts everywhere at the others.
      if (k != 2 && target != 10'000) continue;
      SCOPED_TRACE(::testing::Message() << "k " << k << " target " << target);
      options.output.dir = folder / ("out" + std::to_string(target));
      options.tiles.target_points = target;
      expect_equal(run(options), expected);
    }
  }
}

}  // namespace
}  // namespace hydrotin
