#include "hydrotin/thinning.h"

#include <gtest/gtest.h>

#include <numeric>

#include "clouds.h"
#include "hydrotin/convex_hull.h"
#include "oracle/thinning_oracle.h"

namespace hydrotin {
namespace {

using testing::CloudKind;

struct Cloud {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  std::vector<std::uint32_t> hull;
};

Cloud cloud_of(CloudKind kind, std::uint64_t seed, std::size_t n, std::int32_t spacing, std::int32_t amplitude,
               std::int32_t noise = 0) {
  Cloud out;
  out.position = testing::distinct(testing::make_cloud(kind, seed, n, spacing));
  out.height = testing::relief_heights(seed, out.position, spacing * 12, amplitude, noise);
  out.hull = convex_hull(out.position);
  return out;
}

std::uint64_t count_kept(const Thinning& t) {
  return static_cast<std::uint64_t>(std::count_if(t.fate.begin(), t.fate.end(), is_kept));
}

TEST(Thinning, Definition_EqualsRoundsFromNothing) {
  std::uint64_t instances = 0, inserted = 0, pruned = 0, removed = 0, ties = 0;
  std::uint32_t most_rounds = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed)
    for (const CloudKind kind : testing::kCloudKinds) {
      SCOPED_TRACE(::testing::Message() << testing::name_of(kind) << " " << seed);
      const auto spacing = static_cast<std::int32_t>(1 + seed % 5 * 4);
      Cloud cloud = cloud_of(kind, seed, 20 + seed % 30, spacing, 60);
      if (seed % 3 == 1) cloud.height = testing::random_heights(seed, cloud.position.size(), seed % 2 == 0 ? 4 : 50);
      if (cloud.hull.size() < 3 || cloud.position.back().x > 1000) continue;
      ThinningOptions options;
      options.limit_millionths = static_cast<std::int64_t>(seed % 4) * 2'500'000;
      options.cell = static_cast<std::int32_t>(spacing * (1 + static_cast<std::int32_t>(seed % 4)));
      options.grid_x = -static_cast<std::int64_t>(seed % 7);
      options.grid_y = static_cast<std::int64_t>(seed % 3) * 1000;
      options.prune = seed % 5 != 0;
      const Thinning got = thin_together(cloud.position, cloud.height, cloud.hull, options);
      const oracle::NaiveThinning expected(cloud.position, cloud.height, {cloud.hull.begin(), cloud.hull.end()},
                                           options);
      ASSERT_EQ(got.fate, expected.fate);
      EXPECT_EQ(got.rounds, expected.rounds);
      EXPECT_EQ(got.pruning_rounds, expected.pruning_rounds);
      EXPECT_EQ(got.unsettled.empty(), expected.is_within());
      ThinningOptions stricter = options;
      stricter.limit_millionths /= 3;
      const Thinning settled = settle(cloud.position, cloud.height, got.fate, cloud.hull, stricter);
      const oracle::NaiveThinning slowly(cloud.position, cloud.height, {cloud.hull.begin(), cloud.hull.end()}, stricter,
                                         got.fate);
      ASSERT_EQ(settled.fate, slowly.fate);
      EXPECT_EQ(settled.unsettled.empty(), slowly.is_within());
      ++instances;
      most_rounds = std::max(most_rounds, got.rounds);
      for (const PointFate fate : got.fate) {
        inserted += fate == PointFate::inserted;
        pruned += fate == PointFate::pruned;
        removed += fate == PointFate::removed;
      }
      ties += kind == CloudKind::lattice;
    }
  EXPECT_GT(instances, 400U);
  EXPECT_GT(inserted, 1000U);
  EXPECT_GT(pruned, 200U);
  EXPECT_GT(removed, 1000U);
  EXPECT_GT(ties, 40U);
  EXPECT_GE(most_rounds, 4U);
}

TEST(Thinning, Guarantee_HoldsAndOrderOfPointsAndOriginDoNotMatter) {
  for (const CloudKind kind : {CloudKind::uniform, CloudKind::scanlines, CloudKind::clustered, CloudKind::voided,
                               CloudKind::lattice, CloudKind::l_shaped}) {
    SCOPED_TRACE(testing::name_of(kind));
    const Cloud cloud = cloud_of(kind, 7, 20'000, 100, 4'000, 20);
    ThinningOptions options;
    options.limit_millionths = 60'000'000;
    options.cell = 800;
    const Thinning first = thin(cloud.position, cloud.height, cloud.hull, options);
    EXPECT_TRUE(first.unsettled.empty());
    EXPECT_LE(first.max_error, 60);
    EXPECT_GT(first.max_error, 50);
    EXPECT_LT(count_kept(first), cloud.position.size() / 2);
    EXPECT_EQ(std::count(first.doubtful.begin(), first.doubtful.end(), 1), 0);

    std::vector<std::uint32_t> order(cloud.position.size());
    std::iota(order.begin(), order.end(), 0U);
    testing::shuffle(3, order);
    Cloud other;
    for (const std::uint32_t i : order) {
      const LatticePoint p = cloud.position[i];
      other.position.push_back({p.x - 123'456'789, p.y + 987'654'321});
      other.height.push_back(cloud.height[i]);
    }
    other.hull = convex_hull(other.position);
    options.grid_x -= 123'456'789;
    options.grid_y += 987'654'321;
    const Thinning moved = thin(other.position, other.height, other.hull, options);
    for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(moved.fate[i], first.fate[order[i]]);
    const Thinning unpruned =
        thin(cloud.position, cloud.height, cloud.hull, {options.limit_millionths, options.cell, 0, 0, false});
    EXPECT_LT(count_kept(first), count_kept(unpruned));
  }
}

TEST(Thinning, LargeCoordinatesAndHeightsAreExact) {
  Cloud cloud;
  testing::Random random(5);
  for (int i = 0; i < 300; ++i) {
    cloud.position.push_back({random.between(-2147483000, 2147483000), random.between(-2147483000, 2147483000)});
    cloud.height.push_back(random.between(-2147483000, 2147483000));
  }
  cloud.hull = convex_hull(cloud.position);
  ThinningOptions options;
  options.limit_millionths = std::int64_t{900'000'000} * 1'000'000;
  options.cell = 1 << 28;
  const Thinning got = thin(cloud.position, cloud.height, cloud.hull, options);
  EXPECT_TRUE(got.unsettled.empty());
  EXPECT_LE(got.max_error, 900'000'000);
  EXPECT_GT(got.max_error, 100'000'000);
  EXPECT_LT(count_kept(got), 300U);
}

TEST(Thinning, FlatGroundKeepsTheHullAndWhatLocalityAsksFor) {
  const Cloud cloud = cloud_of(CloudKind::jittered, 1, 40'000, 100, 0);
  const Thinning got = thin(cloud.position, cloud.height, cloud.hull, {0, 1000, 0, 0, true});
  EXPECT_EQ(got.max_error, 0);
  EXPECT_LT(count_kept(got), 400U + 1100U);  // cells, and the points of slivers along the rim
  EXPECT_TRUE(got.unsettled.empty());
}

// A block's points have the fates that the rounds give them with its margin, then all blocks are settled.
TEST(Thinning, Blocks_AreRoundsWithTheirMargins) {
  std::uint64_t blocks = 0, settled = 0;
  for (const CloudKind kind : {CloudKind::uniform, CloudKind::voided, CloudKind::scanlines, CloudKind::collinear}) {
    SCOPED_TRACE(testing::name_of(kind));
    const Cloud cloud = cloud_of(kind, 3, 30'000, 10, 900, 12);
    if (cloud.hull.size() < 3) continue;
    const ThinningOptions options{5'000'000, 10, 3, -7, true};
    LatticeBox all;
    for (const LatticePoint p : cloud.position) all.extend(p);
    const std::vector<PointFate> got = thin_blocks(cloud.position, cloud.height, options, all);
    const std::int64_t side = kBlockCells * options.cell, margin = kBlockMargin * options.cell;
    for (std::int64_t x = 3 - side; x <= all.max.x; x += side)
      for (std::int64_t y = -7 - side; y <= all.max.y; y += side) {
        const auto is_in = [&](LatticePoint p, std::int64_t more) {
          return p.x >= x - more && p.x < x + side + more && p.y >= y - more && p.y < y + side + more;
        };
        Cloud part;
        std::vector<std::size_t> from;
        for (std::size_t i = 0; i < cloud.position.size(); ++i) {
          if (!is_in(cloud.position[i], margin)) continue;
          part.position.push_back(cloud.position[i]);
          part.height.push_back(cloud.height[i]);
          from.push_back(i);
        }
        part.hull = convex_hull(part.position);
        std::vector<PointFate> expected(from.size(), PointFate::seed);
        if (part.hull.size() >= 3) expected = thin_together(part.position, part.height, part.hull, options).fate;
        ++blocks;
        for (std::size_t i = 0; i < from.size(); ++i)
          if (is_in(part.position[i], 0)) {
            ASSERT_EQ(got[from[i]], expected[i]);
          }
      }
    const Thinning whole = thin(cloud.position, cloud.height, cloud.hull, options);
    EXPECT_EQ(whole.fate, settle(cloud.position, cloud.height, got, cloud.hull, options).fate);
    EXPECT_TRUE(whole.unsettled.empty());
    settled += static_cast<std::uint64_t>(std::count(whole.fate.begin(), whole.fate.end(), PointFate::settled));
    // Any part of the points that holds what decides gives the same.
    const LatticeBox some{{400, 300}, {900, 500}};
    const LatticeBox reach = reach_of_blocks(some, options);
    Cloud near;
    std::vector<std::size_t> from;
    for (std::size_t i = 0; i < cloud.position.size(); ++i)
      if (reach.contains(cloud.position[i])) {
        near.position.push_back(cloud.position[i]);
        near.height.push_back(cloud.height[i]);
        from.push_back(i);
      }
    const std::vector<PointFate> here = thin_blocks(near.position, near.height, options, some);
    for (std::size_t i = 0; i < from.size(); ++i)
      if (some.contains(near.position[i])) {
        EXPECT_EQ(here[i], got[from[i]]);
      }
  }
  EXPECT_GT(blocks, 20U);
}

// What a window says without doubt is true of everything.
TEST(Thinning, Window_IsRightWhereItIsSure) {
  std::uint64_t sure = 0, doubtful = 0, sides = 0, changed = 0;
  for (std::uint64_t seed = 0; seed < 48; ++seed) {
    const CloudKind kind = testing::kCloudKinds[seed % 6];
    SCOPED_TRACE(::testing::Message() << testing::name_of(kind) << " " << seed);
    const Cloud cloud = cloud_of(kind, seed, 30'000, 20, static_cast<std::int32_t>(40 + seed % 5 * 80), 6);
    ThinningOptions options;
    options.limit_millionths = 4'000'000 + static_cast<std::int64_t>(seed % 3) * 6'000'000;
    options.cell = seed % 2 == 0 ? 100 : 157;
    options.grid_x = static_cast<std::int64_t>(seed) * 11;
    options.prune = seed % 4 != 3;
    ThinningOptions loose = options;  // leaves much to do
    loose.limit_millionths *= 4;
    const std::vector<PointFate> start = thin_together(cloud.position, cloud.height, cloud.hull, loose).fate;
    const Thinning whole = settle(cloud.position, cloud.height, start, cloud.hull, options);
    LatticeBox all;
    for (const LatticePoint p : cloud.position) all.extend(p);
    testing::Random random(seed);
    const auto cut = [&](std::int32_t low, std::int32_t high, std::int64_t corner, bool& open_low, bool& open_high) {
      const auto on_grid = [&](std::int64_t v) { return corner + grid_cell(v, corner, options.cell) * options.cell; };
      open_low = random.below(3) > 0;
      open_high = !open_low || random.below(3) > 0;
      const std::int64_t length = std::int64_t{high} - low;
      return std::pair{
          static_cast<std::int32_t>(on_grid(open_low ? low + random.below(length / 6) : low - 1000)),
          static_cast<std::int32_t>(on_grid(open_high ? high - random.below(length / 6) : high + 1000)) - 1};
    };
    ThinningWindow window;
    std::tie(window.box.min.x, window.box.max.x) =
        cut(all.min.x, all.max.x, options.grid_x, window.open_left, window.open_right);
    std::tie(window.box.min.y, window.box.max.y) =
        cut(all.min.y, all.max.y, options.grid_y, window.open_below, window.open_above);
    sides += window.open_left + window.open_right + window.open_below + window.open_above;
    Cloud part;
    std::vector<std::uint32_t> from;
    std::vector<PointFate> part_start;
    const auto add = [&](std::uint32_t i) {
      part_start.push_back(start[i]);
      part.position.push_back(cloud.position[i]);
      part.height.push_back(cloud.height[i]);
      from.push_back(i);
    };
    for (std::uint32_t i = 0; i < cloud.position.size(); ++i)
      if (window.box.contains(cloud.position[i])) add(i);
    for (const std::uint32_t v : cloud.hull)
      if (!window.box.contains(cloud.position[v])) add(v);
    for (const std::uint32_t v : cloud.hull)
      part.hull.push_back(static_cast<std::uint32_t>(std::find(from.begin(), from.end(), v) - from.begin()));
    const Thinning got = settle(part.position, part.height, part_start, part.hull, options, &window);
    for (std::size_t i = 0; i < from.size(); ++i) {
      doubtful += got.doubtful[i];
      if (got.doubtful[i] != 0) continue;
      ++sure;
      changed += whole.fate[from[i]] == PointFate::settled;
      ASSERT_EQ(got.fate[i], whole.fate[from[i]]) << cloud.position[from[i]].x << " " << cloud.position[from[i]].y;
      ASSERT_EQ(got.round[i], whole.round[from[i]]);
    }
  }
  EXPECT_GT(sure, 200'000U);
  EXPECT_GT(doubtful, 100'000U);
  EXPECT_GT(changed, 10'000U);
  EXPECT_GT(sides, 100U);
}

}  // namespace
}  // namespace hydrotin
