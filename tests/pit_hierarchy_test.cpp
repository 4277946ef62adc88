#include "hydrotin/pit_hierarchy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "grid_terrain.h"
#include "hydrotin/lifting.h"
#include "hydrotin/pit_choice.h"
#include "oracle/pit_oracle.h"

namespace hydrotin {
namespace {

using testing::make_outlet_terrain;
using testing::OutletTerrain;
using testing::Random;

VertexGraph graph_of(const OutletTerrain& t) {
  return make_vertex_graph(t.grid.num_vertices(), t.grid.triangle);
}

std::vector<PitBasin> hierarchy_of(const OutletTerrain& t) {
  return pit_hierarchy(graph_of(t), t.grid.triangle, t.grid.height, t.grid.position, t.is_outlet);
}

TEST(PitHierarchy, EqualsItsDefinition) {
  std::size_t num_nested = 0, num_endless = 0;
  for (std::uint64_t seed = 0; seed < 700; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = make_outlet_terrain(seed);
    const auto& grid = t.grid;
    const auto around = oracle::neighbors(grid.num_vertices(), grid.triangle);
    const auto pits = oracle::pits(around, grid.height, grid.position, t.is_outlet);
    const auto found = hierarchy_of(t);
    ASSERT_EQ(found.size(), pits.size());
    for (std::size_t i = 0; i < pits.size(); ++i) {
      const PitBasin& pit = found[i];
      EXPECT_EQ(pit.pit, (Pit{pits[i].representative, pits[i].vertex, pits[i].height, pits[i].num_vertices}));
      const auto basin = oracle::basin(around, grid.height, grid.position, t.is_outlet, pits[i].vertex);
      ASSERT_EQ(pit.spill_vertex, basin.spill_vertex);
      if (basin.spill_vertex == kNoPit) {
        EXPECT_EQ(pit.spill_level, kNoLevel);
        ++num_endless;
        continue;
      }
      EXPECT_EQ(pit.spill_level, basin.spill_level);
      EXPECT_EQ(pit.spill_position, grid.position[basin.spill_vertex]);
      EXPECT_EQ(pit.parent == kNoPit, !basin.has_parent);
      if (basin.has_parent) {
        EXPECT_EQ(found[pit.parent].pit.vertex, basin.parent);
        ++num_nested;
      }
      EXPECT_EQ(pit.num_vertices, basin.vertices.size());
      std::int64_t displacement = 0;
      for (const std::uint32_t v : basin.vertices) displacement += basin.spill_level - grid.height[v];
      EXPECT_EQ(pit.displacement, displacement);
      double area = 0, volume = 0, num_triangles = 0;
      for (std::size_t j = 0; j < grid.triangle.size(); j += 3) {
        std::array<LatticePoint, 3> corner;
        std::array<std::int32_t, 3> height{};
        bool is_wet = false;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t v = grid.triangle[j + k];
          corner[k] = grid.position[v];
          height[k] = grid.height[v];
          is_wet |= basin.vertices.contains(v);
        }
        if (!is_wet) continue;
        const auto [a, v] = oracle::water_on(corner, height, basin.spill_level);
        area += a;
        volume += v;
        ++num_triangles;
      }
      EXPECT_NEAR(static_cast<double>(pit.doubled_area), 2 * area, num_triangles / 2 + 1e-6);
      EXPECT_NEAR(pit.volume, volume, num_triangles / 12 + 1e-6);
    }
  }
  EXPECT_GT(num_nested, 100u);
  EXPECT_GT(num_endless, 100u);
}

TEST(PitHierarchy, FloodedPartOfOneTriangle) {
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    std::array<LatticePoint, 3> corner;
    std::array<std::int32_t, 3> height{};
    const std::int32_t range = random.below(2) == 0 ? 3 : 1000;
    for (std::size_t i = 0; i < 3; ++i) {
      corner[i] = {random.between(-1000, 1000), random.between(-1000, 1000)};
      height[i] = random.between(-range, range);
    }
    const std::int32_t level = random.between(-range - 1, range + 1);
    const FloodedPart part = flooded_part(corner, height, level);
    const auto [area, volume] = oracle::water_on(corner, height, level);
    EXPECT_NEAR(static_cast<double>(part.doubled_area), 2 * area, 0.501);
    EXPECT_NEAR(static_cast<double>(part.sixfold_volume), 6 * volume, 0.501 + 1e-9 * volume);
    std::swap(corner[0], corner[2]);
    std::swap(height[0], height[2]);
    EXPECT_EQ(flooded_part(corner, height, level).doubled_area, part.doubled_area);
    EXPECT_EQ(flooded_part(corner, height, level).sixfold_volume, part.sixfold_volume);
  }
}

// Volumes beyond 64 bits: wide triangles of fine lattices, a cone cut at each share of its height.
TEST(PitHierarchy, VolumesOfTheLargestTriangles) {
  const std::array<LatticePoint, 3> corner{
      LatticePoint{-500'000'000, -500'000'000}, {500'000'000, -499'999'999}, {3, 500'000'000}};
  const std::array<std::int32_t, 3> height{-1'000'000'000, 1'000'000'000, 1'000'000'000};
  for (const double share : {0.001, 0.25, 0.5, 1.0}) {
    const auto level = static_cast<std::int32_t>(-1'000'000'000 + share * 2e9);
    const FloodedPart part = flooded_part(corner, height, level);
    const double rise = level + 1e9, area = 1e18 * (rise / 2e9) * (rise / 2e9);
    EXPECT_NEAR(static_cast<double>(part.doubled_area), area, 1e-6 * area);
    EXPECT_NEAR(static_cast<double>(part.sixfold_volume), area * rise, 1e-6 * area * rise);
  }
}

std::int64_t cost_of_removing(const OutletTerrain& t, const VertexGraph& graph, const std::vector<PitBasin>& pits,
                              const std::vector<std::uint8_t>& is_kept) {
  const auto outlets = outlets_and_kept_pits(graph, t.grid.height, t.is_outlet, pits, is_kept);
  const auto level = lift(graph, t.grid.height, outlets);
  std::int64_t cost = 0;
  for (std::size_t v = 0; v < level.size(); ++v) {
    if (level[v] == kNoLevel) return std::numeric_limits<std::int64_t>::max();
    cost += std::int64_t{level[v]} - t.grid.height[v];
  }
  return cost;
}

// All subsets of up to ten pits.
TEST(PitChoice, PricesGiveTheCheapestPitsForEveryNumber) {
  std::size_t num_terrains = 0;
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    SCOPED_TRACE(seed);
    OutletTerrain t = make_outlet_terrain(seed);
    for (auto& z : t.grid.height) z = z * 7 + static_cast<std::int32_t>(seed % 3);
    const VertexGraph graph = graph_of(t);
    const auto pits = hierarchy_of(t);
    if (pits.size() < 2 || pits.size() > 9) continue;
    ++num_terrains;
    std::vector<std::int64_t> best(pits.size() + 1, std::numeric_limits<std::int64_t>::max());
    for (std::uint32_t set = 0; set < (1u << pits.size()); ++set) {
      std::vector<std::uint8_t> is_kept(pits.size());
      for (std::size_t i = 0; i < pits.size(); ++i) is_kept[i] = (set >> i & 1) == 0;
      auto& b = best[static_cast<std::size_t>(std::popcount(set))];
      b = std::min(b, cost_of_removing(t, graph, pits, is_kept));
    }
    for (std::size_t m = 0; m <= pits.size(); ++m) {
      if (best[m] == std::numeric_limits<std::int64_t>::max()) break;
      const auto is_kept = keep_all_but_cheapest(pits, m);
      EXPECT_EQ(std::count(is_kept.begin(), is_kept.end(), 0), static_cast<std::ptrdiff_t>(m));
      EXPECT_EQ(cost_of_removing(t, graph, pits, is_kept), best[m]) << m;
    }
  }
  EXPECT_GT(num_terrains, 200u);
}

TEST(PitChoice, KeptPitsStayAndAllOthersGo) {
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = make_outlet_terrain(seed);
    const VertexGraph graph = graph_of(t);
    const auto pits = hierarchy_of(t);
    Random random(seed);
    std::vector<std::uint8_t> marked(pits.size());
    for (auto& mark : marked) mark = random.below(3) == 0;
    const KeepClause clauses[] = {{3, 100, 20, false}, {1, -1, -1, true}};
    const auto is_kept = pits_to_keep(pits, clauses, marked);
    for (std::size_t i = 0; i < pits.size(); ++i) {
      const PitBasin& p = pits[i];
      const bool endless = p.spill_vertex == kNoPit;
      const bool deep = endless || p.spill_level - p.pit.height > 3, wide = endless || p.doubled_area > 200,
                 full = endless || p.volume > 20;
      EXPECT_EQ(is_kept[i] != 0, (deep && wide && full) || (marked[i] && (endless || p.depth() > 1)));
    }
    const auto outlets = outlets_and_kept_pits(graph, t.grid.height, t.is_outlet, pits, is_kept);
    const auto level = lift(graph, t.grid.height, outlets);
    std::vector<std::int32_t> lifted = level;
    for (std::size_t v = 0; v < level.size(); ++v)
      if (level[v] == kNoLevel) lifted[v] = t.grid.height[v];
    const auto around = oracle::neighbors(t.grid.num_vertices(), t.grid.triangle);
    std::set<std::uint32_t> left;
    for (const auto& pit : oracle::pits(around, lifted, t.grid.position, t.is_outlet)) left.insert(pit.vertex);
    for (std::size_t i = 0; i < pits.size(); ++i) {
      const auto v = static_cast<std::uint32_t>(pits[i].pit.vertex);
      EXPECT_EQ(left.contains(v), is_kept[i] || level[v] == kNoLevel);
    }
    EXPECT_TRUE(pits_to_keep(pits, {}, {}) == std::vector<std::uint8_t>(pits.size(), 0));
  }
}

}  // namespace
}  // namespace hydrotin
