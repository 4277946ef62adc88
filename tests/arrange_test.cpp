// Phases `ingest` and `arrange`: from files in any order to the points of each tile.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <thread>

#include "block_index.h"
#include "hydrotin/hilbert.h"
#include "phases.h"
#include "store.h"
#include "tiling_fixture.h"

namespace hydrotin {
namespace {

using testing::TemporaryFolder;

constexpr std::size_t kFiles = 6;

struct Cloud {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
};

// A third of the points at a place that another point has.
Cloud cloud_with_duplicates(std::uint64_t seed, std::size_t n) {
  testing::Random random(seed);
  Cloud cloud;
  cloud.position = testing::random_points(seed, n, testing::extent_for(n, 30.0));
  for (std::size_t i = 0; i < n / 3; ++i) cloud.position.push_back(cloud.position[random.below(n)]);
  for (std::size_t i = 0; i < cloud.position.size(); ++i) cloud.height.push_back(random.between(-500, 500));
  return cloud;
}

// `mixed`: each file has points everywhere; else each file is a strip along x.
std::vector<std::string> write_files(const TemporaryFolder& folder, const Cloud& cloud, bool mixed) {
  if (mixed) return testing::write_files(folder, cloud.position, cloud.height, kFiles);
  std::vector<std::size_t> order(cloud.position.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return cloud.position[a] < cloud.position[b]; });
  std::vector<std::string> paths;
  for (std::size_t f = 0; f < kFiles; ++f) {
    Cloud strip;
    for (std::size_t i = f * order.size() / kFiles; i < (f + 1) * order.size() / kFiles; ++i) {
      strip.position.push_back(cloud.position[order[i]]);
      strip.height.push_back(cloud.height[order[i]]);
    }
    paths.push_back(folder / ("strip_" + std::to_string(f) + ".las"));
    testing::write_cloud(paths.back(), strip.position, strip.height);
  }
  return paths;
}

class Arrange : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    cloud_ = cloud_with_duplicates(7, 12000);
    options_ = testing::options_for(write_files(folder_, cloud_, GetParam()), folder_ / "out");
    options_.tiles.target_points = 1000;
    run_pipeline(options_, {.until = Phase::ingest}, silent_);
  }

  // As a task of a job array knows it.
  [[nodiscard]] RunContext fresh_context() const {
    const Layout layout(options_);
    return {options_, layout, load_plan(layout.unit(Phase::plan, 0)), {}};
  }

  TemporaryFolder folder_;
  testing::Silent silent_;
  Cloud cloud_;
  PipelineOptions options_;
};

// Lowest height of each place, tile by tile, from the cloud alone.
TEST_P(Arrange, EachTileHoldsItsPlacesOnceWithTheLowestHeight) {
  const RunContext context = fresh_context();
  const Lattice& lattice = context.plan.lattice;
  std::vector<std::map<std::pair<std::int64_t, std::int64_t>, std::int32_t>> expected(context.plan.num_tiles());
  std::vector<std::int64_t> num_points(context.plan.num_tiles(), 0);
  for (std::size_t i = 0; i < cloud_.position.size(); ++i) {
    const LatticePoint p = cloud_.position[i];
    // The files' integers are the lattice's up to the base.
    const LatticePoint q{static_cast<std::int32_t>(p.x - lattice.base_x),
                         static_cast<std::int32_t>(p.y - lattice.base_y)};
    const auto z = static_cast<std::int32_t>(cloud_.height[i] - lattice.base_z);
    const std::uint32_t tile = context.plan.tile_of(q);
    ++num_points[tile];
    const auto [at, is_new] = expected[tile].try_emplace({q.x, q.y}, z);
    if (!is_new) at->second = std::min(at->second, z);
  }
  ASSERT_GT(context.plan.num_tiles(), 8U);
  for (std::uint32_t tile = 0; tile < context.plan.num_tiles(); ++tile) {
    arrange_tile(context, tile);
    const store::Reader in(context.layout.unit(Phase::arrange, tile));
    EXPECT_EQ(in.integer("points"), num_points[tile]);
    const TilePoints points = read_points(in, 0, in.size("x"));
    std::map<std::pair<std::int64_t, std::int64_t>, std::int32_t> got;
    for (std::size_t i = 0; i < points.position.size(); ++i) {
      got[{points.position[i].x, points.position[i].y}] = points.height[i];
      if (i > 0) {
        EXPECT_LT(hilbert_key(points.position[i - 1]), hilbert_key(points.position[i]));
      }
    }
    EXPECT_EQ(points.position.size(), got.size());
    EXPECT_EQ(got, expected[tile]);
  }
}

// A tile's files are all that it opens once the lists are known: the others are taken away.
TEST_P(Arrange, ATileOpensOnlyTheFilesThatHavePointsForIt) {
  const RunContext context = fresh_context();
  const auto files_of = [&](std::uint32_t tile) {
    const auto files = context.ingest_index->files_of(tile, context.layout, kFiles, context.plan.num_tiles());
    return std::set<std::uint32_t>(files.begin(), files.end());
  };
  std::size_t fewest = kFiles;
  for (std::uint32_t tile = 0; tile < context.plan.num_tiles(); ++tile) {
    const std::set<std::uint32_t> needed = files_of(tile);
    fewest = std::min(fewest, needed.size());
    const auto hidden = [&](std::uint32_t f) { return context.layout.unit(Phase::ingest, f) + ".hidden"; };
    for (std::uint32_t f = 0; f < kFiles; ++f)
      if (!needed.contains(f)) std::filesystem::rename(context.layout.unit(Phase::ingest, f), hidden(f));
    EXPECT_NO_THROW(arrange_tile(context, tile));
    for (std::uint32_t f = 0; f < kFiles; ++f)
      if (!needed.contains(f)) std::filesystem::rename(hidden(f), context.layout.unit(Phase::ingest, f));
  }
  EXPECT_EQ(fewest, GetParam() ? kFiles : 1);
}

TEST_P(Arrange, AMissingListIsAnErrorThatPassesWhenTheFileIsThere) {
  const RunContext context = fresh_context();
  const std::string path = context.layout.unit(Phase::ingest, 3);
  std::filesystem::rename(path, path + ".hidden");
  try {
    arrange_tile(context, 0);
    FAIL() << "a missing file went unnoticed";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::storage);
    EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
  }
  std::filesystem::rename(path + ".hidden", path);
  EXPECT_NO_THROW(arrange_tile(context, 0));
}

TEST_P(Arrange, RunsThatDoNotFitThePlanAreRefused) {
  const RunContext context = fresh_context();
  const std::string path = context.layout.unit(Phase::ingest, 2);
  for (const auto& tiles :
       {std::vector<std::uint32_t>{1, 0}, std::vector<std::uint32_t>{0, context.plan.num_tiles()}}) {
    {
      store::Writer out(path);
      out.append("run_tile", tiles);
      out.append("run_first", std::vector<std::uint64_t>{0, 0});
      out.append("run_count", std::vector<std::uint32_t>{0, 0});
      out.commit();
    }
    try {
      arrange_tile(context, 0);
      FAIL() << "wrong runs went unnoticed";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::storage);
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
  }
}

TEST_P(Arrange, TheListsAreMadeOnceForAllThreads) {
  const RunContext context = fresh_context();
  std::vector<std::thread> threads;
  for (std::uint32_t i = 0; i < 4; ++i)
    threads.emplace_back([&, i] {
      for (std::uint32_t tile = i; tile < context.plan.num_tiles(); tile += 4) arrange_tile(context, tile);
    });
  for (auto& thread : threads) thread.join();
  std::int64_t points = 0;
  for (std::uint32_t tile = 0; tile < context.plan.num_tiles(); ++tile)
    points += store::Reader(context.layout.unit(Phase::arrange, tile)).integer("points");
  EXPECT_EQ(points, static_cast<std::int64_t>(cloud_.position.size()));
}

INSTANTIATE_TEST_SUITE_P(Files, Arrange, ::testing::Bool(),
                         [](const auto& mixed) { return mixed.param ? "mixed" : "strips"; });

}  // namespace
}  // namespace hydrotin
