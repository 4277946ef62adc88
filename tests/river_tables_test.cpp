#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <functional>
#include <map>

#include "hydrotin/river_embedding.h"
#include "hydrotin/river_profiles.h"
#include "hydrotin/valley_floor.h"
#include "oracle/full_river_program.h"
#include "river_terrains.h"

namespace hydrotin {
namespace {

using testing::TestTerrain;

std::vector<std::uint32_t> networks_of(const TestTerrain& terrain) {
  return connect_networks(terrain.view(), terrain.rivers).network;
}

TEST(RiverProfiles, RowsOfRiversAddUpToTheStatisticsOfAll) {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    TestTerrain terrain = testing::random_terrain(seed, 60, seed % 3 == 0);
    testing::add_rivers(terrain, seed, 4, 8, true);
    if (terrain.rivers.empty()) continue;
    const Embedding embedding = embed_rivers(terrain.view(), terrain.rivers, {});
    const auto river = networks_of(terrain);
    const std::uint32_t count = *std::max_element(river.begin(), river.end()) + 1;
    const auto table = river_table(terrain.view(), terrain.rivers, river, count, embedding.height, 1e-7);
    const auto before = river_statistics(terrain.view(), terrain.rivers, terrain.height, 1e-7);
    const auto after = river_statistics(terrain.view(), terrain.rivers, embedding.height, 1e-7);
    const auto change = height_change(terrain.height, embedding.height, 1e-7);
    RiverRow sum;
    for (const RiverRow& row : table) {
      sum.edges += row.edges;
      sum.wrong_flow_before += row.wrong_flow_before;
      sum.not_valley_before += row.not_valley_before;
      sum.leaks_before += row.leaks_before;
      sum.flat_after += row.flat_after;
      sum.leaks_after += row.leaks_after;
      sum.moved += row.moved;
      sum.total += row.total;
      sum.largest = std::max(sum.largest, row.largest);
      EXPECT_EQ(row.wrong_flow_after + row.not_valley_after, 0u);
      EXPECT_GE(row.drop_after, -1e-7);
    }
    EXPECT_EQ(sum.edges, terrain.rivers.size());
    EXPECT_EQ(sum.wrong_flow_before, before.wrong_flow);
    EXPECT_EQ(sum.not_valley_before, before.not_valley);
    EXPECT_EQ(sum.leaks_before, before.leak_vertices);
    EXPECT_EQ(sum.flat_after, after.flat_edges);
    EXPECT_EQ(sum.leaks_after, after.leak_vertices);
    EXPECT_EQ(sum.moved, change.moved);  // the program moves nothing that no row joins to a river
    EXPECT_NEAR(sum.total, change.total, 1e-6);
    EXPECT_EQ(sum.largest, change.largest);
  }
}

TEST(RiverProfiles, MainStemIsTheLongestWayDown) {
  for (std::uint32_t seed = 0; seed < 80; ++seed) {
    SCOPED_TRACE(seed);
    TestTerrain terrain = testing::random_terrain(seed, 40, false);
    testing::add_rivers(terrain, seed, 5, 8, false);
    if (terrain.rivers.empty()) continue;
    const auto river = networks_of(terrain);
    const std::uint32_t count = *std::max_element(river.begin(), river.end()) + 1;
    const MainStems stems = main_stems(terrain.view(), terrain.rivers, river, count);
    ASSERT_EQ(stems.begin.size(), count + 1u);
    const auto length = [&](const RiverEdge& e) {
      return std::hypot(terrain.position[e.to][0] - terrain.position[e.from][0],
                        terrain.position[e.to][1] - terrain.position[e.from][1]);
    };
    std::map<std::uint32_t, double> memo;  // longest way down from a vertex
    const std::function<double(std::uint32_t)> longest = [&](std::uint32_t v) {
      if (const auto found = memo.find(v); found != memo.end()) return found->second;
      double best = 0;
      for (const auto& e : terrain.rivers)
        if (e.from == v) best = std::max(best, length(e) + longest(e.to));
      return memo[v] = best;
    };
    for (std::uint32_t g = 0; g < count; ++g) {
      double best = 0, ours = 0;
      for (std::size_t e = 0; e < terrain.rivers.size(); ++e)
        if (river[e] == g) best = std::max(best, longest(terrain.rivers[e].from));
      for (std::size_t i = stems.begin[g] + 1; i < stems.begin[g + 1]; ++i) {
        const RiverEdge edge{stems.vertex[i - 1], stems.vertex[i]};
        const auto found = std::find(terrain.rivers.begin(), terrain.rivers.end(), edge);
        ASSERT_NE(found, terrain.rivers.end());
        EXPECT_EQ(river[static_cast<std::size_t>(found - terrain.rivers.begin())], g);
        ours += length(edge);
      }
      EXPECT_NEAR(ours, best, 1e-9);
    }
  }
}

/// Whether a wingtip at height h satisfies the rows of all river edges, exactly.
bool holds(const TestTerrain& terrain, std::uint32_t w, double h) {
  using Rational = boost::multiprecision::cpp_rational;
  const auto at = [&](std::uint32_t v, std::size_t axis) { return Rational(terrain.position[v][axis]); };
  for (const auto& [a, b] : terrain.rivers)
    for (std::size_t t = 0; t < terrain.triangle.size(); t += 3) {
      const auto* v = terrain.triangle.data() + t;
      if (w == a || w == b || std::count(v, v + 3, a) + std::count(v, v + 3, b) + std::count(v, v + 3, w) != 3)
        continue;
      const Rational x = at(b, 0) - at(a, 0), y = at(b, 1) - at(a, 1);
      const Rational share = ((at(w, 0) - at(a, 0)) * x + (at(w, 1) - at(a, 1)) * y) / (x * x + y * y);
      if (Rational(h) < (1 - share) * Rational(terrain.height[a]) + share * Rational(terrain.height[b])) return false;
    }
  return true;
}

TEST(ValleyFloor, IsTheLeastHeightThatTheDeterminantAllows) {
  std::size_t tips = 0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    TestTerrain terrain = testing::random_terrain(seed, 50, seed % 3 == 0);
    testing::add_rivers(terrain, seed, 4, 8, true);
    const auto floor = valley_floor(terrain.view(), terrain.rivers, 0, terrain.height);
    for (std::uint32_t w = 0; w < floor.size(); ++w) {
      double expected = -HUGE_VAL;
      for (const auto& [a, b] : terrain.rivers)
        for (std::size_t t = 0; t < terrain.triangle.size(); t += 3) {
          const auto* v = terrain.triangle.data() + t;
          if (std::count(v, v + 3, a) + std::count(v, v + 3, b) + std::count(v, v + 3, w) != 3) continue;
          if (w == a || w == b) continue;
          // The determinant of Section 7.1.1 is linear in the height of the wingtip: two values give its root.
          const auto value = [&](double h) {
            return oracle::thesis_determinant(terrain.position[a], terrain.position[b], terrain.position[w],
                                              terrain.height[a], terrain.height[b], h);
          };
          expected = std::max(expected, -value(0) / (value(1) - value(0)));
        }
      if (!std::isfinite(expected)) {
        EXPECT_EQ(floor[w], -HUGE_VAL);
        continue;
      }
      ++tips;
      EXPECT_NEAR(floor[w], expected, 1e-6);
      // In rationals: at the floor every row holds, just below it one does not.
      EXPECT_TRUE(holds(terrain, w, floor[w]));
      EXPECT_FALSE(holds(terrain, w, floor[w] - 1e-9 * (1 + std::abs(floor[w]))));
    }
  }
  EXPECT_GT(tips, 300u);
}

TEST(BindingLimits, AreTheRowsWithoutRoom) {
  std::size_t slopes = 0, largest = 0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    TestTerrain terrain = testing::random_terrain(seed, 60, false);
    testing::add_rivers(terrain, seed, 4, 8, true);
    if (terrain.rivers.empty()) continue;
    EmbeddingOptions options;
    options.constraints.max_change = 1.5;
    const Embedding e = embed_rivers(terrain.view(), terrain.rivers, options);
    std::set<std::pair<std::uint32_t, std::uint32_t>> tight;
    std::vector<std::uint8_t> is_river(terrain.height.size(), 0);
    for (const auto& [a, b] : terrain.rivers) is_river[a] = is_river[b] = 1;
    std::uint64_t beyond = 0;
    for (std::size_t t = 0; t < terrain.triangle.size(); t += 3)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto [a, b] = std::minmax(terrain.triangle[t + i], terrain.triangle[t + (i + 1) % 3]);
        if (is_river[a] || is_river[b]) continue;
        const double width = 0.5 * std::abs(terrain.height[a] - terrain.height[b]);
        const double used = std::abs((e.height[a] - e.height[b]) - (terrain.height[a] - terrain.height[b]));
        if (width > 0 && used > width - 1e-6 && (e.height[a] != terrain.height[a] || e.height[b] != terrain.height[b]))
          tight.insert({a, b});
        if (width > 0 && used > width + 1e-6) ++beyond;
      }
    EXPECT_EQ(beyond, 0u);
    EXPECT_EQ(count_beyond_slope_limit(terrain.view(), terrain.rivers, options.constraints, e.height, 1e-6), 0u);
    std::set<std::pair<std::uint32_t, std::uint32_t>> found;
    std::size_t capped = 0;
    for (const BindingLimit& limit :
         binding_limits(terrain.view(), terrain.rivers, options.constraints, e.height, 1e-6)) {
      if (limit.is_largest_change) {
        ++capped;
        EXPECT_NEAR(std::abs(e.height[limit.vertex[0]] - terrain.height[limit.vertex[0]]), 1.5, 1e-6);
      } else {
        found.insert(std::minmax(limit.vertex[0], limit.vertex[1]));
      }
    }
    EXPECT_EQ(found, tight);
    slopes += found.size();
    largest += capped;
    // Heights turned upside down break the limits: every edge that is not exempt nor flat, once.
    std::vector<double> flipped = terrain.height;
    std::set<std::pair<std::uint32_t, std::uint32_t>> turned;
    for (double& h : flipped) h = -h;
    for (std::size_t t = 0; t < terrain.triangle.size(); t += 3)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto [a, b] = std::minmax(terrain.triangle[t + i], terrain.triangle[t + (i + 1) % 3]);
        if (!is_river[a] && !is_river[b] && terrain.height[a] != terrain.height[b]) turned.insert({a, b});
      }
    EXPECT_EQ(count_beyond_slope_limit(terrain.view(), terrain.rivers, options.constraints, flipped, 1e-6),
              turned.size());
  }
  EXPECT_GT(slopes, 20u);
  EXPECT_GT(largest, 20u);
}

}  // namespace
}  // namespace hydrotin
