#include "hydrotin/lifting.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "grid_terrain.h"
#include "hydrotin/vertex_graph.h"
#include "oracle/terrain_oracle.h"

namespace hydrotin {
namespace {

using testing::GridTerrain;
using testing::make_grid;
using testing::make_outlet_terrain;
using testing::OutletTerrain;
using testing::Random;

VertexGraph graph_of(const GridTerrain& grid) {
  return make_vertex_graph(grid.num_vertices(), grid.triangle);
}

TEST(VertexGraph, EqualsDefinition) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    const GridTerrain grid = make_outlet_terrain(seed).grid;
    const VertexGraph graph = graph_of(grid);
    const auto expected = oracle::neighbors(grid.num_vertices(), grid.triangle);
    ASSERT_EQ(graph.num_vertices(), grid.num_vertices());
    for (std::uint32_t v = 0; v < grid.num_vertices(); ++v) {
      const auto got = graph.neighbors(v);
      EXPECT_EQ(std::vector(got.begin(), got.end()), std::vector(expected[v].begin(), expected[v].end()));
    }
    std::set<std::pair<std::uint32_t, std::uint32_t>> boundary;
    for (const DirectedEdge e : graph.boundary) boundary.insert({e.origin, e.target});
    EXPECT_EQ(boundary, oracle::edges_without_twin(grid.triangle));
    EXPECT_TRUE(std::is_sorted(graph.boundary.begin(), graph.boundary.end()));
    EXPECT_EQ(boundary.size(), graph.boundary.size());
  }
}

TEST(VertexGraph, DoesNotDependOnTheOrderOfTrianglesNorOnTheirFirstVertex) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    const GridTerrain grid = make_outlet_terrain(seed).grid;
    std::vector<std::uint32_t> order(grid.num_triangles()), shuffled;
    std::iota(order.begin(), order.end(), 0u);
    testing::shuffle(seed, order);
    Random random(seed);
    for (const std::uint32_t t : order) {
      const std::uint32_t first = random.below(3);
      for (std::uint32_t i = 0; i < 3; ++i) shuffled.push_back(grid.triangle[3 * t + (first + i) % 3]);
    }
    const VertexGraph a = graph_of(grid), b = make_vertex_graph(grid.num_vertices(), shuffled);
    EXPECT_EQ(a.begin, b.begin);
    EXPECT_EQ(a.neighbor, b.neighbor);
    EXPECT_EQ(a.boundary, b.boundary);
  }
}

TEST(VertexGraph, HubRepeatedAndReversedTrianglesAndNothing) {
  std::vector<std::uint32_t> fan;
  for (std::uint32_t i = 1; i < 5000; ++i) fan.insert(fan.end(), {0, i, i + 1});
  const VertexGraph hub = make_vertex_graph(5001, fan);
  EXPECT_EQ(hub.neighbors(0).size(), 5000u);
  EXPECT_EQ(hub.boundary.size(), 5001u);

  const std::vector<std::uint32_t> odd{0, 1, 2, 0, 1, 2, 0, 2, 1, 1, 3, 2, 1, 3, 2};
  const VertexGraph soup = make_vertex_graph(5, odd);
  const auto expected = oracle::neighbors(5, odd);
  for (std::uint32_t v = 0; v < 5; ++v) EXPECT_TRUE(std::ranges::equal(soup.neighbors(v), expected[v])) << v;

  EXPECT_EQ(make_vertex_graph(0, {}).num_vertices(), 0u);
  EXPECT_TRUE(make_vertex_graph(3, {}).neighbors(2).empty());
}

TEST(Lifting, EqualsTheGreatestFixedPoint) {
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = make_outlet_terrain(seed);
    const auto around = oracle::neighbors(t.grid.num_vertices(), t.grid.triangle);
    EXPECT_EQ(lift(graph_of(t.grid), t.grid.height, t.is_outlet), oracle::lift(around, t.grid.height, t.is_outlet));
  }
}

TEST(Lifting, LeavesNoPitAndIsIdempotent) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = make_outlet_terrain(seed);
    const VertexGraph graph = graph_of(t.grid);
    const auto level = lift(graph, t.grid.height, t.is_outlet);
    // Vertices without a way out keep their height here, so that they can be lifted again.
    std::vector<std::int32_t> lifted = level;
    for (std::size_t v = 0; v < level.size(); ++v) {
      EXPECT_GE(level[v], t.grid.height[v]);
      EXPECT_TRUE(!t.is_outlet[v] || level[v] == t.grid.height[v]);
      if (level[v] == kNoLevel) lifted[v] = t.grid.height[v];
    }
    EXPECT_EQ(lift(graph, lifted, t.is_outlet), level);
    const auto around = oracle::neighbors(t.grid.num_vertices(), t.grid.triangle);
    for (const auto& pit : oracle::pits(around, lifted, t.grid.position, t.is_outlet))
      EXPECT_EQ(level[pit.vertex], kNoLevel);
  }
}

TEST(Lifting, KnownLevelsOfAnyVerticesGiveTheRest) {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = make_outlet_terrain(seed);
    const VertexGraph graph = graph_of(t.grid);
    const auto level = lift(graph, t.grid.height, t.is_outlet);
    Random random(seed);
    const std::uint32_t share = random.below(11);
    std::vector<std::int32_t> known(level.size(), kNoLevel);
    for (std::size_t v = 0; v < level.size(); ++v)
      if (random.below(10) < share) known[v] = level[v];
    EXPECT_EQ(lift_from(graph, t.grid.height, t.is_outlet, known), level);
  }
}

TEST(Lifting, LargeTerrainsEqualAfterRenumbering) {
  GridTerrain grid = make_grid(3, 200, 150, 100, 30);
  grid.height = testing::relief_heights(3, grid.position, 4000, 3000, 200);
  const auto outlet = testing::hull_flags(grid);
  const auto level = lift(graph_of(grid), grid.height, outlet);
  EXPECT_EQ(level, oracle::lift(oracle::neighbors(grid.num_vertices(), grid.triangle), grid.height, outlet));
  EXPECT_GT(
      std::inner_product(level.begin(), level.end(), grid.height.begin(), 0, std::plus<>{}, std::not_equal_to<>{}),
      1000);

  std::vector<std::uint32_t> to(grid.num_vertices());
  std::iota(to.begin(), to.end(), 0u);
  testing::shuffle(5, to);
  std::vector<std::uint32_t> triangle = grid.triangle;
  for (auto& v : triangle) v = to[v];
  std::vector<std::int32_t> height(to.size());
  std::vector<std::uint8_t> moved(to.size());
  for (std::size_t v = 0; v < to.size(); ++v) height[to[v]] = grid.height[v], moved[to[v]] = outlet[v];
  const auto renumbered = lift(make_vertex_graph(grid.num_vertices(), triangle), height, moved);
  for (std::size_t v = 0; v < to.size(); ++v) ASSERT_EQ(renumbered[to[v]], level[v]);
}

TEST(Lifting, ExtremeHeights) {
  const std::vector<std::uint32_t> strip{0, 1, 2, 1, 3, 2, 2, 3, 4};
  const std::vector<std::int32_t> height{std::numeric_limits<std::int32_t>::min(), kNoLevel - 1, kNoLevel - 1, -5,
                                         std::numeric_limits<std::int32_t>::min()};
  const auto graph = make_vertex_graph(5, strip);
  EXPECT_EQ(lift(graph, height, std::vector<std::uint8_t>{1, 0, 0, 0, 0}),
            (std::vector<std::int32_t>{height[0], kNoLevel - 1, kNoLevel - 1, kNoLevel - 1, kNoLevel - 1}));
  EXPECT_EQ(lift(graph, height, std::vector<std::uint8_t>(5, 0)), std::vector<std::int32_t>(5, kNoLevel));
  EXPECT_TRUE(lift(make_vertex_graph(0, {}), {}, {}).empty());
}

TEST(Lifting, LowestVertexBreaksTiesByPosition) {
  const std::vector<LatticePoint> position{{5, 1}, {2, 9}, {2, 3}, {1, 1}};
  EXPECT_EQ(lowest_vertex(std::vector<std::int32_t>{7, 7, 7, 8}, position), 2u);
  EXPECT_EQ(lowest_vertex(std::vector<std::int32_t>{-1, 7, 7, 8}, position), 0u);
  EXPECT_EQ(lowest_vertex(std::vector<std::int32_t>{0, 0, 0, 0}, position), 3u);
}

}  // namespace
}  // namespace hydrotin
