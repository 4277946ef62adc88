#include "clouds.h"

#include <gtest/gtest.h>

#include <set>

namespace hydrotin::testing {
namespace {

TEST(Clouds, SameSeedGivesTheSamePointsAndAnotherSeedOthers) {
  for (const CloudKind kind : kCloudKinds) {
    SCOPED_TRACE(name_of(kind));
    EXPECT_EQ(make_cloud(kind, 7, 500, 10), make_cloud(kind, 7, 500, 10));
    if (kind == CloudKind::lattice) continue;  // only its order depends on the seed
    EXPECT_NE(distinct(make_cloud(kind, 7, 500, 10)), distinct(make_cloud(kind, 8, 500, 10)));
  }
}

TEST(Clouds, NeighbouringSeedsShareNoPoints) {
  std::set<LatticePoint> seen;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    for (const LatticePoint p : distinct(random_points(seed, 500, 1 << 30))) EXPECT_TRUE(seen.insert(p).second) << seed;
}

TEST(Clouds, HaveTheSizeAskedForAndPositiveCoordinates) {
  for (const CloudKind kind : kCloudKinds)
    for (const std::size_t n : {0u, 1u, 2u, 3u, 10u, 1000u, 20000u}) {
      SCOPED_TRACE(::testing::Message() << name_of(kind) << " " << n);
      for (const std::int32_t spacing : {1, 7, 100}) {
        const auto points = make_cloud(kind, n + 3, n, spacing);
        if (kind != CloudKind::tiny) {
          EXPECT_EQ(points.size(), n);
        }
        for (const LatticePoint p : points)
          ASSERT_TRUE(p.x >= 0 && p.y >= 0 && p.x < (1 << 30) && p.y < (1 << 30)) << p.x << " " << p.y;
      }
    }
}

TEST(Clouds, HaveTheDegeneraciesTheyAreNamedFor) {
  EXPECT_EQ(distinct(lattice_points(1, 900, 10)).size(), 900u);
  EXPECT_EQ(distinct(lattice_points(1, 900, 10)).back(), (LatticePoint{290, 290}));
  EXPECT_EQ(distinct(jittered_lattice_points(1, 900, 10, 3)).size(), 900u);
  EXPECT_LT(distinct(duplicated_points(1, 900, 10000)).size(), 600u);
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto line = distinct(collinear_points(seed, 100));
    const LatticePoint a = line.front(), b = line.back();
    for (const LatticePoint p : line)
      EXPECT_EQ(std::int64_t{b.x - a.x} * (p.y - a.y), std::int64_t{b.y - a.y} * (p.x - a.x));
  }
  for (const LatticePoint p : l_shaped_points(1, 900, 1000)) EXPECT_TRUE(p.x < 250 || p.y < 250);
  std::set<std::size_t> sizes;
  for (std::uint64_t seed = 0; seed < 200; ++seed) sizes.insert(distinct(tiny_points(seed)).size());
  EXPECT_EQ(sizes, (std::set<std::size_t>{0, 1, 2, 3, 4, 5, 6}));
}

TEST(Clouds, ReliefStaysInItsRangeAndDependsOnPositionOnly) {
  const auto points = random_points(3, 5000, 3000);
  const auto heights = relief_heights(3, points, 500, 1000, 20);
  EXPECT_GE(*std::min_element(heights.begin(), heights.end()), 0);
  EXPECT_LE(*std::max_element(heights.begin(), heights.end()), 1020);
  EXPECT_GT(*std::max_element(heights.begin(), heights.end()) - *std::min_element(heights.begin(), heights.end()), 200);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(heights[i], relief_at(3, points[i], 500, 1000, 20));
  const auto flat = random_heights(1, 100, 1);
  EXPECT_EQ(flat, std::vector<std::int32_t>(100, 0));
}

}  // namespace
}  // namespace hydrotin::testing
