#include "hydrotin/synthetic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <unordered_map>

namespace hydrotin {
namespace {

constexpr SyntheticKind kKinds[] = {SyntheticKind::fluvial, SyntheticKind::urban, SyntheticKind::lattice,
                                    SyntheticKind::scanline};

std::vector<SyntheticPoint> points_of(const SyntheticTerrain& terrain, std::uint32_t num_a, std::uint32_t num_b) {
  std::vector<SyntheticPoint> points;
  for (std::uint32_t a = 0; a < num_a; ++a)
    for (std::uint32_t b = 0; b < num_b; ++b) {
      const LatticeBox box = terrain.tile(a, num_a, b, num_b);
      terrain.points_in(box, [&](std::span<const SyntheticPoint> batch) {
        for (const auto& point : batch) EXPECT_TRUE(box.contains({point.x, point.y}));
        points.insert(points.end(), batch.begin(), batch.end());
      });
    }
  std::sort(points.begin(), points.end());
  return points;
}

TEST(Synthetic, Points_DoNotDependOnTheTiling) {
  for (const auto kind : kKinds) {
    SCOPED_TRACE(static_cast<int>(kind));
    const SyntheticTerrain terrain({.kind = kind, .num_points = 120'000, .seed = 3, .noise = 0.1, .voids = true});
    const auto whole = points_of(terrain, 1, 1);
    for (const auto& [a, b] : {std::pair{2U, 2U}, {3U, 1U}, {1U, 7U}, {13U, 11U}})
      EXPECT_EQ(points_of(terrain, a, b), whole);
    const SyntheticTerrain again({.kind = kind, .num_points = 120'000, .seed = 3, .noise = 0.1, .voids = true});
    EXPECT_EQ(points_of(again, 1, 1), whole);
    const SyntheticTerrain other({.kind = kind, .num_points = 120'000, .seed = 4, .noise = 0.1, .voids = true});
    EXPECT_NE(points_of(other, 1, 1), whole);
  }
}

TEST(Synthetic, Tiles_CoverTheDomainOnce) {
  const SyntheticTerrain terrain({.kind = SyntheticKind::lattice, .num_points = 1000});
  std::int64_t area = 0;
  for (std::uint32_t a = 0; a < 7; ++a)
    for (std::uint32_t b = 0; b < 3; ++b) {
      const auto box = terrain.tile(a, 7, b, 3);
      area += (std::int64_t{box.max.x} - box.min.x + 1) * (std::int64_t{box.max.y} - box.min.y + 1);
      if (a > 0) {
        EXPECT_EQ(terrain.tile(a - 1, 7, b, 3).max.x + 1, box.min.x);
      }
      if (b > 0) {
        EXPECT_EQ(terrain.tile(a, 7, b - 1, 3).max.y + 1, box.min.y);
      }
    }
  const auto whole = terrain.box();
  EXPECT_EQ(area, (std::int64_t{whole.max.x} - whole.min.x + 1) * (std::int64_t{whole.max.y} - whole.min.y + 1));
}

TEST(Synthetic, Density_IsOnePointPerSquareMetre) {
  for (const auto kind : {SyntheticKind::fluvial, SyntheticKind::lattice, SyntheticKind::scanline}) {
    SCOPED_TRACE(static_cast<int>(kind));
    const SyntheticTerrain terrain({.kind = kind, .num_points = 1'000'000});
    EXPECT_NEAR(static_cast<double>(points_of(terrain, 1, 1).size()), 1e6, 3e4);
  }
}

TEST(Synthetic, Lattice_IsAGrid) {
  const SyntheticTerrain terrain({.kind = SyntheticKind::lattice, .num_points = 10'000});
  const auto points = points_of(terrain, 3, 3);
  ASSERT_EQ(points.size(), 10'000U);
  for (const auto& point : points) {
    EXPECT_EQ(point.x % 100, 0);
    EXPECT_EQ(point.y % 100, 0);
  }
}

TEST(Synthetic, Scanline_SpacingDiffersAlongAndAcross) {
  const SyntheticTerrain terrain({.kind = SyntheticKind::scanline, .num_points = 40'000, .seed = 2});
  const auto points = points_of(terrain, 1, 1);
  // In the first swath lines are parallel: the neighbour along the line is nearest, at 0.6 m; none is near in y alone.
  std::vector<double> nearest;
  for (std::size_t i = 0; i < points.size(); i += 97) {
    if (points[i].x > 50'000'000 + 19'000) continue;
    double best = 1e9;
    for (const auto& other : points) {
      const double d = std::hypot(points[i].x - other.x, points[i].y - other.y);
      if (d > 0) best = std::min(best, d);
    }
    nearest.push_back(best);
  }
  std::nth_element(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2), nearest.end());
  EXPECT_NEAR(nearest[nearest.size() / 2], 60, 4);
}

TEST(Synthetic, Voids_HoldNoPoint) {
  for (const auto kind : kKinds) {
    SCOPED_TRACE(static_cast<int>(kind));
    const SyntheticTerrain terrain({.kind = kind, .num_points = 250'000, .seed = 9, .voids = true});
    const auto points = points_of(terrain, 2, 1);
    for (const auto& point : points) EXPECT_FALSE(terrain.is_void(point.x * 0.01, point.y * 0.01));
    const SyntheticTerrain whole({.kind = kind, .num_points = 250'000, .seed = 9});
    const auto covered = static_cast<double>(points.size()), all = static_cast<double>(points_of(whole, 1, 1).size());
    EXPECT_LT(covered, 0.98 * all);
    EXPECT_GT(covered, 0.8 * all);
  }
}

TEST(Synthetic, Noise_HasTheStatedDeviation) {
  const SyntheticTerrain plain({.kind = SyntheticKind::fluvial, .num_points = 200'000});
  const SyntheticTerrain noisy({.kind = SyntheticKind::fluvial, .num_points = 200'000, .noise = 0.25});
  const auto a = points_of(plain, 1, 1), b = points_of(noisy, 1, 1);
  ASSERT_EQ(a.size(), b.size());
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].x, b[i].x);
    const double difference = 0.01 * (b[i].z - a[i].z);
    sum += difference;
    squares += difference * difference;
    ASSERT_EQ(a[i].z, std::lround(100 * plain.height(a[i].x * 0.01, a[i].y * 0.01)));
  }
  const auto n = static_cast<double>(a.size());
  EXPECT_NEAR(sum / n, 0, 0.003);
  EXPECT_NEAR(std::sqrt(squares / n), 0.25, 0.005);
}

TEST(Synthetic, Fluvial_HasRelief) {
  const SyntheticTerrain terrain({.kind = SyntheticKind::fluvial, .num_points = 1'000'000, .seed = 5});
  double lowest = 1e9, highest = -1e9;
  std::size_t steep = 0, count = 0;
  for (double x = 500'001; x < 500'998; x += 5)
    for (double y = 4'600'001; y < 4'600'998; y += 5, ++count) {
      const double z = terrain.height(x, y);
      lowest = std::min(lowest, z);
      highest = std::max(highest, z);
      if (std::hypot(terrain.height(x + 1, y) - z, terrain.height(x, y + 1) - z) > 2) ++steep;
    }
  EXPECT_NEAR(highest - lowest, 200, 30);
  EXPECT_LT(static_cast<double>(steep), 0.02 * static_cast<double>(count)) << "mountains, not walls";
}

TEST(Synthetic, Rivers_DescendInDomainsOfAnySize) {
  for (const std::uint64_t n : {10'000, 60'000, 300'000, 60'000'000})
    for (const auto& river : SyntheticTerrain({.kind = SyntheticKind::fluvial, .num_points = n, .seed = 2}).rivers())
      for (std::size_t i = 0; i + 1 < river.line.size(); ++i) EXPECT_LT(river.line[i + 1][2], river.line[i][2]) << n;
}

TEST(Synthetic, Rivers_DescendInValleysToTheSouthernEdge) {
  const SyntheticTerrain terrain({.kind = SyntheticKind::fluvial, .num_points = 1'000'000, .seed = 6});
  const auto rivers = terrain.rivers();
  ASSERT_GE(rivers.size(), 5U);
  std::set<std::pair<double, double>> starts;
  int highest_order = 0;
  for (const auto& river : rivers) starts.insert({river.line.front()[0], river.line.front()[1]});
  std::size_t valley = 0, inner = 0;
  for (const auto& river : rivers) {
    highest_order = std::max(highest_order, river.strahler);
    ASSERT_GE(river.line.size(), 2U);
    for (std::size_t i = 0; i + 1 < river.line.size(); ++i) {
      EXPECT_LT(river.line[i + 1][2], river.line[i][2]);
      const auto& a = river.line[i];
      const auto& b = river.line[i + 1];
      const double x = 0.5 * (a[0] + b[0]), y = 0.5 * (a[1] + b[1]), length = std::hypot(b[0] - a[0], b[1] - a[1]);
      const double side_x = -(b[1] - a[1]) / length, side_y = (b[0] - a[0]) / length;
      const double z = terrain.height(x, y);
      ++inner;
      if (terrain.height(x + 3 * side_x, y + 3 * side_y) > z && terrain.height(x - 3 * side_x, y - 3 * side_y) > z)
        ++valley;
    }
    const auto& end = river.line.back();
    EXPECT_TRUE(end[1] == 4'600'000.0 || starts.contains({end[0], end[1]}))
        << "ends at the edge or where another begins";
  }
  EXPECT_GE(highest_order, 2);
  EXPECT_GT(static_cast<double>(valley), 0.97 * static_cast<double>(inner));
  EXPECT_TRUE(SyntheticTerrain({.kind = SyntheticKind::urban, .num_points = 1000}).rivers().empty());
}

TEST(Synthetic, SmallestDomains_Work) {
  for (const auto kind : kKinds)
    for (const std::uint64_t n : {16, 17, 100}) {
      const SyntheticTerrain terrain({.kind = kind, .num_points = n, .seed = 1});
      EXPECT_LE(points_of(terrain, 2, 3).size(), n + 20);
    }
}

TEST(Synthetic, LargeDomain_GivesTheSamePointsInAnyWindow) {
  const SyntheticTerrain terrain({.kind = SyntheticKind::scanline, .num_points = kMaxSyntheticPoints, .seed = 1});
  const auto all = terrain.box();
  const LatticeBox far{{all.max.x - 9'999, all.max.y - 9'999}, all.max};
  std::vector<SyntheticPoint> whole, halves;
  const auto add_to = [](std::vector<SyntheticPoint>& to) {
    return [&to](std::span<const SyntheticPoint> batch) { to.insert(to.end(), batch.begin(), batch.end()); };
  };
  terrain.points_in(far, add_to(whole));
  terrain.points_in({far.min, {far.min.x + 5'000, far.max.y}}, add_to(halves));
  terrain.points_in({{far.min.x + 5'001, far.min.y}, far.max}, add_to(halves));
  std::sort(whole.begin(), whole.end());
  std::sort(halves.begin(), halves.end());
  EXPECT_EQ(whole, halves);
  EXPECT_NEAR(static_cast<double>(whole.size()), 1e4, 1e3);
}

}  // namespace
}  // namespace hydrotin
