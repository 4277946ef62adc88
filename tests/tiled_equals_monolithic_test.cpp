#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>

#include "hydrotin/error.h"
#include "monolith.h"
#include "plan.h"
#include "schedule.h"
#include "shared_data.h"
#include "tiling_fixture.h"

/// tiled == monolithic: any tiling, number of workers, memory, order of the inputs and interruption gives what one
/// triangulation in memory gives.

namespace hydrotin {
namespace {

using testing::bytes_of;
using testing::CloudKind;
using testing::Monolith;
using testing::run;
using testing::TemporaryFolder;

// --- the factors ---------------------------------------------------------------------------------------------------

constexpr std::uint64_t kEverything = 1'000'000'000;
constexpr std::uint64_t kTargets[] = {kEverything, 50'000, 10'000, 3'000};
constexpr int kMaxOrder = 4;

/// One way to run one cloud at one order.
struct Cell {
  std::uint64_t target;
  int workers;
  bool scarce;    ///< memory for one tile at a time
  bool shuffled;  ///< the points in another order, in other files
};

std::ostream& operator<<(std::ostream& out, const Cell& c) {
  return out << "target " << c.target << " workers " << c.workers << (c.scarce ? " scarce" : " ample") << " memory"
             << (c.shuffled ? " shuffled" : "");
}

/// All cells of an order.
std::vector<Cell> cross_product() {
  std::vector<Cell> out;
  for (const std::uint64_t target : kTargets)
    for (const int workers : {1, 2})
      for (const bool scarce : {false, true})
        for (const bool shuffled : {false, true}) out.push_back({target, workers, scarce, shuffled});
  return out;
}

/// One cell for each tile size, such that over all orders any two values of any two factors meet.
std::vector<Cell> covering_cells(int k) {
  std::vector<Cell> out;
  for (int t = 0; t < 4; ++t)
    out.push_back({kTargets[t], 1 + (k + t) % 2, (k + t / 2) % 2 == 1, (t + t / 2 + k / 2) % 2 == 1});
  return out;
}

/// The complete product takes half a day: only where asked for (see README, "Tests").
bool is_soak() {
  const char* value = std::getenv("HYDROTIN_SOAK");
  return value != nullptr && std::string(value) == "1";
}

std::vector<Cell> cells(int k) {
  return is_soak() ? cross_product() : covering_cells(k);
}

TEST(CoveringCells, AnyTwoValuesOfAnyTwoFactorsMeet) {
  std::set<std::array<std::uint64_t, 4>> met, possible;  // factor, value, factor, value
  const auto add = [](auto& to, int k, const Cell& c) {
    const std::array<std::uint64_t, 5> value{static_cast<std::uint64_t>(k), c.target,
                                             static_cast<std::uint64_t>(c.workers), c.scarce, c.shuffled};
    for (std::uint64_t a = 0; a < value.size(); ++a)
      for (std::uint64_t b = a + 1; b < value.size(); ++b) to.insert({a, value[a], b, value[b]});
  };
  for (int k = 0; k <= kMaxOrder; ++k) {
    for (const Cell& c : covering_cells(k)) add(met, k, c);
    for (const Cell& c : cross_product()) add(possible, k, c);
  }
  EXPECT_EQ(met, possible);
}

// --- the clouds ----------------------------------------------------------------------------------------------------

/// Points, and two sets of files that hold them.
struct Survey {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  std::vector<std::string> files, shuffled;
  std::string crs;  ///< for files without
};

/// Calls back with all points in another order.
template <class Write>
void shuffle_points(const Survey& survey, Write write) {
  std::vector<std::size_t> order(survey.position.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  testing::shuffle(7, order);
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  for (const std::size_t i : order) {
    position.push_back(survey.position[i]);
    height.push_back(survey.height[i]);
  }
  write(position, height);
}

Survey synthetic_survey(const TemporaryFolder& folder, CloudKind kind, std::uint64_t seed, std::size_t n) {
  Survey out;
  out.position = testing::make_cloud(kind, seed, n, 100);
  for (std::size_t i = 0; i < n; ++i)
    out.height.push_back(testing::relief_at(3, out.position[i], 5000, 2000, 3) / 40 + static_cast<std::int32_t>(i % 3));
  out.files = testing::write_files(folder, out.position, out.height, 3);
  shuffle_points(out, [&](const auto& position, const auto& height) {
    out.shuffled = testing::write_files(folder, position, height, 2, "shuffled_");
  });
  return out;
}

struct RealCloud {
  const char* name;
  std::vector<std::string> files;
  std::uint64_t points_per_vertex = 1;  ///< tiles are sized by all points, few of which may be ground
};

const RealCloud kReal[] = {
    {"Blanca", {"quickstart/Blanca_in_Pozo_USGS_UTM11_NAD83_all_color_cl2_SC12.laz"}},
    {"fusa", {"quickstart/fusa.laz"}},
    {"lake", {"quickstart/lake.laz"}},
    {"bcts", {"tiles_bcts/bcts_1.laz", "tiles_bcts/bcts_2.laz", "tiles_bcts/bcts_3.laz", "tiles_bcts/bcts_4.laz"}, 20}};

/// At one order the tiles are as many as in a soak, 1,506 of bcts with a hundred vertices each; at the others they have
/// about as many vertices as those of the other clouds. (Soaks have the many tiles at every order.)
constexpr int kOrderWithManyTiles = 2;

std::uint64_t target_of(const RealCloud& cloud, int k, const Cell& cell) {
  const bool many = is_soak() || k == kOrderWithManyTiles || cell.target == kEverything;
  return many ? cell.target : cell.target * cloud.points_per_vertex;
}

Survey real_survey(const TemporaryFolder& folder, const RealCloud& cloud) {
  Survey out;
  for (const auto& file : cloud.files) out.files.push_back(testing::shared_path(file));
  testing::Cloud points = testing::read_cloud(out.files, 2);
  out.position = std::move(points.position);
  out.height = std::move(points.height);
  LasWriterOptions header = testing::cloud_header();
  // The box of all points, ground or not, spans the lattice: two points of another class stand at its ends.
  std::vector<LatticePoint> ends;
  std::vector<std::int32_t> end_heights;
  for (const auto& file : out.files) {
    const LasHeader h = read_las_header(file);
    header.scale = h.scale;
    header.offset = h.offset;
    header.crs = h.crs;
    for (const auto& corner : {h.min, h.max}) {
      std::array<std::int32_t, 3> at;
      for (std::size_t a = 0; a < 3; ++a)
        at[a] = static_cast<std::int32_t>(std::llround((corner[a] - h.offset[a]) / h.scale[a]));
      ends.push_back({at[0], at[1]});
      end_heights.push_back(at[2]);
    }
  }
  if (header.crs.empty()) out.crs = "none";
  shuffle_points(out, [&](auto& position, auto& height) {
    position.insert(position.begin(), ends.begin(), ends.end());
    height.insert(height.begin(), end_heights.begin(), end_heights.end());
    out.shuffled = {folder / "shuffled.las"};
    testing::write_cloud(out.shuffled[0], position, height, header, std::vector<std::uint8_t>(ends.size(), 1));
  });
  return out;
}

// --- runs ----------------------------------------------------------------------------------------------------------

Monolith monolith_of(const Survey& survey, const PipelineOptions& options) {
  const Plan plan = make_plan(options);
  return testing::run_monolith(
      survey.position, survey.height, options.triangulation.order, options.triangulation.objectives,
      options.pits.outlets == OutletPolicy::hull,
      {static_cast<std::int32_t>(plan.lattice.base_x), static_cast<std::int32_t>(plan.lattice.base_y)},
      static_cast<std::int32_t>(plan.lattice.base_z));
}

/// Memory that the largest tile takes alone.
std::uint64_t least_memory(const Survey& survey, const PipelineOptions& options) {
  const Plan plan = make_plan(options);
  std::vector<std::uint64_t> count(plan.num_tiles());
  for (const LatticePoint p : survey.position)
    ++count[plan.tile_of(
        {p.x - static_cast<std::int32_t>(plan.lattice.base_x), p.y - static_cast<std::int32_t>(plan.lattice.base_y)})];
  return tile_need_bytes(std::max(*std::max_element(count.begin(), count.end()),
                                  *std::max_element(plan.expected.begin(), plan.expected.end())));
}

PipelineOptions options_of(const Survey& survey, int k, const Cell& cell, const std::string& out) {
  PipelineOptions options = testing::options_for(cell.shuffled ? survey.shuffled : survey.files, out);
  options.input.crs = survey.crs;
  options.triangulation.order = k;
  options.tiles.target_points = cell.target;
  options.run.workers = cell.workers;
  if (cell.scarce) options.run.memory_bytes = least_memory(survey, options);
  return options;
}

void expect_equal(const DatasetSummary& got, const Monolith& expected) {
  EXPECT_EQ(got.fingerprint, expected.fingerprint);
  EXPECT_EQ(got.vertices, expected.vertices);
  EXPECT_EQ(got.duplicates, expected.duplicates);
  EXPECT_EQ(got.triangles, expected.triangles);
  EXPECT_EQ(got.pits, 0U);
  EXPECT_TRUE(got.ok);
}

/// Starts a run that kills itself. Returns whether it was killed before its end.
bool run_and_die(const PipelineOptions& options, std::uint64_t events, std::uint64_t delay_us) {
  std::vector<std::string> words{HYDROTIN_DYING_RUN,
                                 std::to_string(events),
                                 std::to_string(delay_us),
                                 options.output.dir,
                                 std::to_string(options.triangulation.order),
                                 std::to_string(options.tiles.target_points),
                                 std::to_string(options.run.workers),
                                 std::to_string(options.run.memory_bytes),
                                 options.input.crs.empty() ? "-" : options.input.crs};
  words.insert(words.end(), options.input.points.begin(), options.input.points.end());
  const pid_t child = ::fork();
  if (child == 0) {
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status) || (WIFEXITED(status) && WEXITSTATUS(status) == 0));
  return WIFSIGNALED(status);
}

/// Five times: killed at a seeded place, killed again while resuming, resumed; the files must be those of a whole run.
void expect_survives_kills(PipelineOptions options, const std::string& whole_dir, const Monolith& expected,
                           std::uint64_t seed) {
  std::uint64_t units = 0;
  for (const std::uint64_t n : plan_run(options).units) units += n;
  testing::Random random(seed);
  const std::string out = options.output.dir;
  int killed = 0;
  for (int round = 0; round < 5; ++round) {
    options.output.dir = out + std::to_string(round);
    for (int again = 0; again < 2; ++again)
      killed += run_and_die(options, 1 + random.below(units - 1), random.below(4000));
    expect_equal(run(options), expected);
    for (const auto& entry : std::filesystem::directory_iterator(whole_dir + "/terrain"))
      EXPECT_TRUE(bytes_of(entry.path().string()) ==
                  bytes_of(options.output.dir + "/terrain/" + entry.path().filename().string()))
          << entry.path();
    const DatasetSummary checked = check_dataset(options.output.dir, 2000);
    EXPECT_TRUE(checked.ok) << (checked.problems.empty() ? "" : checked.problems.front());
    std::filesystem::remove_all(options.output.dir);
  }
  EXPECT_GE(killed, 5);
}

/// All these cells of an order: the monolith's terrain; in a soak also when killed.
void expect_monolith_in_cells(const Survey& survey, int k, const std::vector<Cell>& these,
                              const TemporaryFolder& folder) {
  std::optional<Monolith> expected;
  std::uint64_t serial = 0;
  for (const Cell& cell : these) {
    SCOPED_TRACE(::testing::Message() << "k " << k << " " << cell);
    const PipelineOptions options =
        options_of(survey, k, cell, folder / ("k" + std::to_string(k) + "_" + std::to_string(serial++)));
    if (!expected) expected = monolith_of(survey, options);
    expect_equal(run(options), *expected);
    if (is_soak()) {
      PipelineOptions dying = options;
      dying.output.dir = options.output.dir + "_killed";
      expect_survives_kills(dying, options.output.dir, *expected, 100 * serial + static_cast<std::uint64_t>(k));
    }
    std::filesystem::remove_all(options.output.dir);
  }
}

// --- tests ---------------------------------------------------------------------------------------------------------

constexpr CloudKind kKinds[] = {CloudKind::uniform, CloudKind::lattice, CloudKind::scanlines, CloudKind::clustered,
                                CloudKind::voided};

class TiledEqualsMonolithic : public ::testing::TestWithParam<CloudKind> {};

INSTANTIATE_TEST_SUITE_P(Clouds, TiledEqualsMonolithic, ::testing::ValuesIn(kKinds),
                         [](const auto& cloud) { return testing::name_of(cloud.param); });

class TilingMatrix : public ::testing::TestWithParam<std::tuple<CloudKind, int>> {};

INSTANTIATE_TEST_SUITE_P(Clouds, TilingMatrix,
                         ::testing::Combine(::testing::ValuesIn(kKinds), ::testing::Range(0, kMaxOrder + 1)),
                         [](const auto& at) {
                           return std::string(testing::name_of(std::get<0>(at.param))) + "_k" +
                                  std::to_string(std::get<1>(at.param));
                         });

// 60,000 points: the second tile size makes two tiles of them.
TEST_P(TilingMatrix, EqualsMonolith) {
  const TemporaryFolder folder;
  const auto [kind, k] = GetParam();
  expect_monolith_in_cells(synthetic_survey(folder, kind, 1, 60'000), k, cells(k), folder);
}

class RealTilingMatrix : public ::testing::TestWithParam<std::tuple<std::size_t, int>> {};

INSTANTIATE_TEST_SUITE_P(Clouds, RealTilingMatrix,
                         ::testing::Combine(::testing::Range(std::size_t{0}, std::size(kReal)),
                                            ::testing::Range(0, kMaxOrder + 1)),
                         [](const auto& at) {
                           return std::string(kReal[std::get<0>(at.param)].name) + "_k" +
                                  std::to_string(std::get<1>(at.param));
                         });

TEST_P(RealTilingMatrix, EqualsMonolith) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  const auto [cloud, k] = GetParam();
  const Survey survey = real_survey(folder, kReal[cloud]);
  std::vector<Cell> these = cells(k);
  for (Cell& cell : these) cell.target = target_of(kReal[cloud], k, cell);
  expect_monolith_in_cells(survey, k, these, folder);
}

TEST_P(TiledEqualsMonolithic, OtherObjectivesAndOutlets) {
  const TemporaryFolder folder;
  const Survey survey = synthetic_survey(folder, GetParam(), 2, 12'000);
  for (const auto& [k, objective, outlets] : {std::tuple{1, Objective::min_weight, OutletPolicy::hull},
                                              std::tuple{2, Objective::min_weight, OutletPolicy::lowest},
                                              std::tuple{3, Objective::local_minima, OutletPolicy::lowest},
                                              std::tuple{4, Objective::min_weight, OutletPolicy::hull},
                                              std::tuple{2, Objective::delaunay, OutletPolicy::hull}}) {
    std::optional<Monolith> expected;
    for (const std::uint64_t target : {kEverything, std::uint64_t{3'000}}) {
      SCOPED_TRACE(::testing::Message() << "k " << k << " " << name(objective) << " target " << target);
      PipelineOptions options = options_of(survey, k, {target, 2, false, false}, folder / "out");
      options.triangulation.objectives = {objective};
      options.pits.outlets = outlets;
      if (!expected) expected = monolith_of(survey, options);
      expect_equal(run(options), *expected);
    }
  }
}

/// Orders and tile sizes at which runs are killed: each order and each size.
struct Killed {
  int k;
  Cell cell;
  std::size_t points;
};

constexpr Killed kKilled[] = {{0, {10'000, 2, true, false}, 15'000},
                              {1, {50'000, 2, false, true}, 60'000},
                              {2, {3'000, 2, false, false}, 15'000},
                              {3, {kEverything, 1, true, false}, 15'000},
                              {4, {3'000, 1, false, true}, 15'000}};

class KilledAndResumed : public ::testing::TestWithParam<std::tuple<CloudKind, std::size_t>> {};

INSTANTIATE_TEST_SUITE_P(Clouds, KilledAndResumed,
                         ::testing::Combine(::testing::ValuesIn(kKinds),
                                            ::testing::Range(std::size_t{0}, std::size(kKilled))),
                         [](const auto& at) {
                           const Killed& killed = kKilled[std::get<1>(at.param)];
                           return std::string(testing::name_of(std::get<0>(at.param))) + "_k" +
                                  std::to_string(killed.k) + "_tiles_of_" + std::to_string(killed.cell.target);
                         });

void expect_killed_equals_monolith(const Survey& survey, int k, const Cell& cell, const TemporaryFolder& folder,
                                   std::uint64_t seed) {
  PipelineOptions options = options_of(survey, k, cell, folder / "whole");
  const Monolith expected = monolith_of(survey, options);
  expect_equal(run(options), expected);
  options.output.dir = folder / "killed";
  expect_survives_kills(options, folder / "whole", expected, seed);
}

TEST_P(KilledAndResumed, EqualsMonolith) {
  const TemporaryFolder folder;
  const auto& [kind, index] = GetParam();
  const Killed& killed = kKilled[index];
  expect_killed_equals_monolith(synthetic_survey(folder, kind, 3, killed.points), killed.k, killed.cell, folder,
                                10 * static_cast<std::uint64_t>(kind) + index);
}

class RealKilledAndResumed : public ::testing::TestWithParam<std::size_t> {};

INSTANTIATE_TEST_SUITE_P(Clouds, RealKilledAndResumed, ::testing::Range(std::size_t{0}, std::size(kReal)),
                         [](const auto& cloud) { return kReal[cloud.param].name; });

TEST_P(RealKilledAndResumed, EqualsMonolith) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  constexpr Killed kHow[] = {{2, {50'000, 2, false, false}, 0},
                             {1, {10'000, 2, true, false}, 0},
                             {4, {10'000, 2, false, true}, 0},
                             {3, {50'000, 1, false, false}, 0}};
  const Killed& how = kHow[GetParam()];
  expect_killed_equals_monolith(real_survey(folder, kReal[GetParam()]), how.k, how.cell, folder, GetParam());
}

// Every phase as a job array of three tasks, the last task first; single-unit phases leave nothing to tasks 1 and 2.
TEST_P(TiledEqualsMonolithic, PhasesAsJobArrays) {
  const TemporaryFolder folder;
  const Survey survey = synthetic_survey(folder, GetParam(), 4, 10'000);
  const PipelineOptions options = options_of(survey, 2, {2'000, 2, false, false}, folder / "out");
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
  EXPECT_EQ(checked.fingerprint, monolith_of(survey, options).fingerprint);
}

TEST(CheckAfterRun, FindsAnyFlippedBitOfATile) {
  const TemporaryFolder folder;
  const Survey survey = synthetic_survey(folder, CloudKind::uniform, 5, 2'000);
  const PipelineOptions options = options_of(survey, 2, {1'000, 2, false, false}, folder / "out");
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

}  // namespace
}  // namespace hydrotin
