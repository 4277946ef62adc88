#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "expected_error.h"
#include "hdf5_attributes.h"
#include "hydrotin/convex_hull.h"
#include "hydrotin/thinning.h"
#include "monolith.h"
#include "plan.h"
#include "report.h"
#include "shared_data.h"
#include "store.h"
#include "tiling_fixture.h"

/// Thinning in tiles keeps what `thin` keeps of all points in memory, and the TIN passes all others within the limit.

namespace hydrotin {
namespace {

using testing::CloudKind;
using testing::TemporaryFolder;

constexpr double kLimit = 0.3, kCell = 8;

struct Survey {
  testing::Cloud points;
  std::vector<std::string> files;
};

Survey survey_of(const TemporaryFolder& folder, CloudKind kind, std::uint64_t seed, std::size_t n = 8'000) {
  Survey out;
  out.points.position = testing::make_cloud(kind, seed, n, 100);
  for (const LatticePoint p : out.points.position)
    out.points.height.push_back(testing::relief_at(seed, p, 3'000, 1'500, 12));
  for (std::size_t i = 0; i < 40; ++i) {  // places with two heights, some of them far apart
    out.points.position.push_back(out.points.position[i * 7]);
    out.points.height.push_back(out.points.height[i * 7] + (i % 2 == 0 ? 400 : 5));
  }
  out.files = testing::write_files(folder, out.points.position, out.points.height, 3);
  return out;
}

PipelineOptions options_of(const Survey& survey, const std::string& out, int k, std::uint64_t target) {
  PipelineOptions options = testing::options_for(survey.files, out);
  options.triangulation.order = k;
  options.triangulation.objectives = {Objective::local_minima, Objective::min_squared_error};
  options.thin.vertical_error_m = kLimit;
  options.thin.cell_m = kCell;
  options.tiles.target_points = target;
  return options;
}

struct Whole {
  testing::Cloud kept, removed;
  std::uint64_t settled = 0;
};

/// What `thin` makes of the points as the files hold them.
Whole thin_whole(const testing::Cloud& points) {
  const auto lowest = testing::lowest_points(points.position, points.height);
  testing::Cloud all;
  for (const auto& [p, z] : lowest) {
    all.position.push_back(p);
    all.height.push_back(z);
  }
  // On a lattice of 1 cm.
  const ThinningOptions options{std::llround(kLimit * 1e8), static_cast<std::int32_t>(kCell * 100), -50'000'000,
                                -400'000'000, true};
  const Thinning thinning = thin(all.position, all.height, convex_hull(all.position), options);
  EXPECT_TRUE(thinning.unsettled.empty());
  Whole out;
  for (std::size_t i = 0; i < lowest.size(); ++i) {
    testing::Cloud& to = is_kept(thinning.fate[i]) ? out.kept : out.removed;
    to.position.push_back(all.position[i]);
    to.height.push_back(all.height[i]);
    out.settled += thinning.fate[i] == PointFate::settled;
  }
  return out;
}

nlohmann::json report_of(const PipelineOptions& options) {
  return nlohmann::json::parse(testing::bytes_of(options.output.dir + "/report.json"));
}

class TiledThinning : public ::testing::TestWithParam<CloudKind> {};

TEST_P(TiledThinning, EqualsThinningInMemory) {
  for (const int k : {0, 3}) {
    SCOPED_TRACE(k);
    const TemporaryFolder folder;
    const Survey survey = survey_of(folder, GetParam(), 10 + static_cast<std::uint64_t>(k));
    const Whole whole = thin_whole(survey.points);
    std::optional<testing::Monolith> expected;
    nlohmann::json totals;
    int run = 0;
    for (const std::uint64_t target : {1'000'000, 3'000, 1'500}) {
      PipelineOptions options = options_of(survey, folder / ("out" + std::to_string(target)), k, target);
      options.run.workers = 1 + run;
      options.run.memory_bytes = std::uint64_t{run == 1 ? 64U : 4096U} << 20;
      if (run++ == 2) std::reverse(options.input.points.begin(), options.input.points.end());
      const Lattice lattice = make_plan(options).lattice;
      const ErrorLimit limit{std::llround(kLimit / lattice.scale_z * 1e6)};
      if (!expected)
        expected = testing::run_monolith(
            whole.kept.position, whole.kept.height, k, options.triangulation.objectives, true,
            {static_cast<std::int32_t>(lattice.base_x), static_cast<std::int32_t>(lattice.base_y)},
            static_cast<std::int32_t>(lattice.base_z), whole.removed, limit);
      const DatasetSummary summary = testing::run(options);
      EXPECT_TRUE(summary.ok) << (summary.problems.empty() ? "" : summary.problems.front());
      EXPECT_EQ(summary.fingerprint, expected->fingerprint);
      EXPECT_EQ(summary.vertices, whole.kept.position.size());
      nlohmann::json report = report_of(options);
      const nlohmann::json& thinning = report.at("thinning");
      EXPECT_EQ(thinning.at("kept"), whole.kept.position.size());
      EXPECT_EQ(thinning.at("removed"), whole.removed.position.size());
      EXPECT_EQ(thinning.at("settled"), whole.settled);
      EXPECT_EQ(thinning.at("places_with_two_heights"), 20);
      EXPECT_EQ(thinning.at("beyond_guarantee"), 0);
      EXPECT_EQ(thinning.at("not_in_one_triangle"), 0);
      EXPECT_NEAR(thinning.at("guaranteed_m"), kLimit, 1e-12);
      EXPECT_LE(thinning.at("max_error_m"), kLimit + 1e-12);
      EXPECT_NEAR(thinning.at("max_error_m"), expected->figures.error.largest * lattice.scale_z, 1e-9);
      const double rms = std::sqrt(expected->figures.error.squared.value() /
                                   static_cast<double>(std::max<std::size_t>(whole.removed.position.size(), 1)));
      EXPECT_NEAR(thinning.at("rms_error_m"), rms * lattice.scale_z, 1e-9);
      EXPECT_EQ(report.at("triangulation").at("reference").at("points"), whole.removed.position.size());
      EXPECT_EQ(report.at("triangulation").at("limit_missed"), 0);
      if (totals.is_null()) totals = thinning;
      EXPECT_EQ(thinning, totals) << "to the last bit";
      const DatasetSummary checked = check_dataset(options.output.dir, 0);
      EXPECT_TRUE(checked.ok) << (checked.problems.empty() ? "" : checked.problems.front());
      EXPECT_EQ(checked.fingerprint, expected->fingerprint);
      if (HasFailure()) return;
    }
    EXPECT_GT(whole.removed.position.size(), whole.kept.position.size());
  }
}

INSTANTIATE_TEST_SUITE_P(Clouds, TiledThinning,
                         ::testing::Values(CloudKind::uniform, CloudKind::lattice, CloudKind::scanlines,
                                           CloudKind::clustered, CloudKind::voided, CloudKind::l_shaped),
                         [](const auto& kind) { return testing::name_of(kind.param); });

TEST(ThinnedRun, PhasesAsJobArraysAndAfterLosses) {
  const TemporaryFolder folder;
  const Survey survey = survey_of(folder, CloudKind::voided, 3);
  PipelineOptions whole = options_of(survey, folder / "whole", 2, 1'000'000);
  whole.pits.method = PitMethod::least_change;  // no phase but those of rivers is left out
  const DatasetSummary expected = testing::run(whole);
  PipelineOptions options = options_of(survey, folder / "out", 2, 2'000);
  options.pits.method = whole.pits.method;
  options.output.keep = KeepWork::always;
  testing::Silent silent;
  for (std::size_t p = 0; p < kNumPhases; ++p) {
    for (const std::uint64_t task : {2, 1, 0}) run_phase(options, static_cast<Phase>(p), task, 3, silent);
    const PhaseStatus status = pipeline_status(options)[p];
    EXPECT_EQ(status.done, status.units) << name(static_cast<Phase>(p));
    const bool is_of_rivers = static_cast<Phase>(p) >= Phase::lay && static_cast<Phase>(p) <= Phase::unite;
    EXPECT_EQ(status.units > 0, !is_of_rivers) << name(static_cast<Phase>(p));
  }
  EXPECT_EQ(check_dataset(options.output.dir, 0).fingerprint, expected.fingerprint);
  // Outputs of every kind that an interruption took.
  for (const std::string lost : {"work/thin/000001.h5", "work/verify/000000.h5", "work/survey/000000.h5",
                                 "terrain/tile_000002.h5", "terrain/index.h5"})
    ASSERT_TRUE(std::filesystem::remove(folder / ("out/" + lost))) << lost;
  EXPECT_EQ(testing::run(options).fingerprint, expected.fingerprint);
  EXPECT_TRUE(check_dataset(options.output.dir, 0).ok);
  // Another limit, then the first again: nothing of the other stays.
  PipelineOptions other = options;
  other.thin.vertical_error_m = 1.0;
  EXPECT_LT(testing::run(other).vertices, expected.vertices);
  EXPECT_EQ(testing::run(options).fingerprint, expected.fingerprint);
}

TEST(ThinnedRun, WhatIsNotThinnedHasNoUnitsOfIt) {
  const TemporaryFolder folder;
  const Survey survey = survey_of(folder, CloudKind::uniform, 3, 2'000);
  PipelineOptions options = testing::options_for(survey.files, folder / "out");
  const PlanSummary plan = plan_run(options);
  for (const Phase phase : {Phase::survey, Phase::thin, Phase::verify})
    EXPECT_EQ(plan.units[static_cast<std::size_t>(phase)], 0U);
  EXPECT_TRUE(testing::run(options).ok);
  EXPECT_TRUE(report_of(options).at("thinning").is_null());
}

// Reference points of one's own are judged by themselves; then only the Delaunay triangulation promises the limit.
TEST(ThinnedRun, ReferencePointsAreThoseAskedFor) {
  const TemporaryFolder folder;
  const Survey survey = survey_of(folder, CloudKind::uniform, 4);
  const Survey held_out = survey_of(folder, CloudKind::uniform, 5, 1'000);
  const auto with = [&](bool removed, bool files, int k) {
    PipelineOptions options = options_of(survey, folder / "out", k, 3'000);
    if (files)
      options.triangulation.reference =
          testing::write_files(folder, held_out.points.position, held_out.points.height, 1, "held_out_");
    options.triangulation.removed_reference = removed;
    std::filesystem::remove_all(folder / "out");
    EXPECT_TRUE(testing::run(options).ok);
    EXPECT_TRUE(check_dataset(folder / "out").ok);
    return report_of(options);
  };
  const std::uint64_t removed = with(true, false, 2).at("thinning").at("removed");
  const nlohmann::json both = with(true, true, 2), files = with(false, true, 2), delaunay = with(false, true, 0);
  EXPECT_EQ(both.at("triangulation").at("reference").at("points"), removed + 1'040);
  EXPECT_TRUE(both.at("thinning").at("guaranteed_m").is_null());
  EXPECT_EQ(files.at("triangulation").at("reference").at("points"), 1'040);
  EXPECT_TRUE(files.at("thinning").at("guaranteed_m").is_null());
  EXPECT_EQ(files.at("thinning").at("beyond_guarantee"), 0);
  EXPECT_NEAR(delaunay.at("thinning").at("guaranteed_m"), kLimit, 1e-12);
  EXPECT_LE(delaunay.at("thinning").at("max_error_m"), kLimit + 1e-12);
}

TEST(ThinnedRun, ImpossibleOptionsAreConfigErrors) {
  const TemporaryFolder folder;
  const Survey survey = survey_of(folder, CloudKind::uniform, 4, 1'000);
  const auto says = [&](auto change, const std::string& text) {
    PipelineOptions options = options_of(survey, folder / "out", 2, 3'000);
    change(options);
    const std::string got = testing::error_of([&] { (void)testing::run(options); }, ErrorKind::config);
    EXPECT_NE(got.find(text), std::string::npos) << got;
  };
  says([](PipelineOptions& o) { o.thin.vertical_error_m = -1; }, "thin.vertical_error_m");
  says([](PipelineOptions& o) { o.thin.vertical_error_m = 1e30; }, "thin.vertical_error_m");
  says([](PipelineOptions& o) { o.thin.cell_m = 0; }, "thin.cell_m");
  says([](PipelineOptions& o) { o.thin.cell_m = 1e9; }, "thin.cell_m");
  says(
      [](PipelineOptions& o) {
        o.thin = {};
        o.triangulation.objectives = {Objective::local_minima};
        o.triangulation.removed_reference = true;
      },
      "triangulation.reference: no point is removed");
}

// A terrain whose removed points do not fit it does not pass.
TEST(ThinnedRun, CheckMeasuresTheRemovedPointsAgain) {
  const TemporaryFolder folder;
  const Survey survey = survey_of(folder, CloudKind::uniform, 6, 4'000);
  const PipelineOptions options = options_of(survey, folder / "out", 2, 2'000);
  (void)testing::run(options);
  const auto state = [&](const std::string& attribute, auto value) {
    const std::string path = folder / "out/terrain/index.h5";
    testing::set_attribute(path, attribute, value);
    const DatasetSummary summary = check_dataset(folder / "out");
    std::string all;
    for (const std::string& p : summary.problems) all += p + "\n";
    EXPECT_EQ(summary.ok, summary.problems.empty());
    return all;
  };
  const std::int64_t removed = store::Reader(folder / "out/terrain/index.h5").integer("removed");
  EXPECT_NE(state("removed_limit_millionths", std::int64_t{20'000'000}).find("farther from the terrain than promised"),
            std::string::npos);
  EXPECT_EQ(state("removed_limit_millionths", std::int64_t{30'000'000}), "");
  EXPECT_NE(state("removed", removed + 1).find("points removed, but the files hold"), std::string::npos);
  EXPECT_EQ(state("removed", removed), "");
  EXPECT_NE(state("removed_max_error", 1.5).find("another largest error"), std::string::npos);
}

TEST(ThinnedRun, DefaultCellsAreTheSameForEveryTilingOfRealGround) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  std::optional<std::string> fingerprint;
  for (const std::uint64_t target : {1'000'000, 60'000}) {
    PipelineOptions options = testing::options_for({testing::shared_path("quickstart/fusa.laz")}, folder / "out");
    options.thin.vertical_error_m = 0.1;
    options.tiles.target_points = target;
    const DatasetSummary summary = testing::run(options);
    EXPECT_TRUE(summary.ok);
    if (!fingerprint) fingerprint = summary.fingerprint;
    EXPECT_EQ(summary.fingerprint, *fingerprint);
    EXPECT_LT(summary.vertices, summary.points / 8);
    EXPECT_TRUE(check_dataset(folder / "out").ok);
    std::filesystem::remove_all(folder / "out");
  }
}

}  // namespace
}  // namespace hydrotin
