#include "hydrotin/contour_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "grid_terrain.h"
#include "oracle/contour_oracle.h"
#include "oracle/terrain_oracle.h"

namespace hydrotin {
namespace {

using testing::GridTerrain;
using testing::make_grid;
using testing::Random;
using Arcs = std::multiset<std::pair<std::uint32_t, std::uint32_t>>;

GridTerrain tiny_terrain(std::uint64_t seed) {
  Random random(seed);
  GridTerrain grid = make_grid(seed, 2 + random.below(6), 2 + random.below(6), 10, random.below(2) == 0 ? 0 : 4);
  constexpr std::int32_t kRanges[] = {1, 2, 3, 5, 9, 1000};
  grid.height = testing::random_heights(seed, grid.num_vertices(), kRanges[random.below(6)]);
  if (random.below(4) == 0) grid.height = testing::relief_heights(seed, grid.position, 40, 30);
  return grid;
}

Arcs arcs_of(const ContourTree& tree) {
  std::vector<std::uint32_t> rank(tree.ascending.size());
  for (std::uint32_t i = 0; i < rank.size(); ++i) rank[tree.ascending[i]] = i;
  Arcs arcs;
  for (std::uint32_t v = 0; v < rank.size(); ++v)
    if (const std::uint32_t w = tree.other[v]; w != kNoVertex)
      arcs.insert(rank[v] < rank[w] ? std::pair(v, w) : std::pair(w, v));
  return arcs;
}

TEST(ContourTree, EqualsTheContoursFollowedFromLevelToLevel) {
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    SCOPED_TRACE(seed);
    const GridTerrain grid = tiny_terrain(seed);
    const auto tree = contour_tree(make_vertex_graph(grid.num_vertices(), grid.triangle), grid.height, grid.position);
    ASSERT_TRUE(tree.has_value());
    const Arcs arcs = arcs_of(*tree);
    EXPECT_EQ(arcs, oracle::contour_arcs(grid.triangle, grid.height, grid.position));
    EXPECT_EQ(arcs.size(), grid.num_vertices() - 1);
    const ContourDegrees degrees = contour_degrees(*tree);
    for (std::uint32_t v = 0; v < grid.num_vertices(); ++v) {
      EXPECT_EQ(degrees.below[v], std::count_if(arcs.begin(), arcs.end(), [&](auto arc) { return arc.second == v; }));
      EXPECT_EQ(degrees.above[v], std::count_if(arcs.begin(), arcs.end(), [&](auto arc) { return arc.first == v; }));
    }
  }
}

/// For each vertex the first above it such that the vertices up to there connect the two.
std::vector<std::uint32_t> join_by_definition(const GridTerrain& grid, const std::vector<std::uint32_t>& ascending) {
  const auto around = oracle::neighbors(grid.num_vertices(), grid.triangle);
  std::vector<std::uint32_t> next(grid.num_vertices(), kNoVertex);
  for (std::size_t i = 0; i < ascending.size(); ++i)
    for (std::size_t j = i + 1; j < ascending.size() && next[ascending[i]] == kNoVertex; ++j) {
      std::set<std::uint32_t> reached{ascending[i]};
      for (bool grown = true; grown;) {
        grown = false;
        for (std::size_t k = 0; k <= j; ++k)
          for (const std::uint32_t w : around[ascending[k]])
            if (reached.contains(w)) grown |= reached.insert(ascending[k]).second;
      }
      if (reached.contains(ascending[j])) next[ascending[i]] = ascending[j];
    }
  return next;
}

TEST(ContourTree, JoinAndSplitTreesEqualTheirDefinition) {
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    GridTerrain grid = tiny_terrain(seed);
    if (seed % 3 == 0) grid.triangle.resize(grid.triangle.size() / 6 * 3);  // leaves vertices alone
    const VertexGraph graph = make_vertex_graph(grid.num_vertices(), grid.triangle);
    const auto ascending = ascending_vertices(grid.height, grid.position);
    EXPECT_TRUE(std::is_sorted(ascending.begin(), ascending.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(grid.height[a], grid.position[a]) < std::pair(grid.height[b], grid.position[b]);
    }));
    EXPECT_EQ(join_tree(graph, ascending), join_by_definition(grid, ascending));
    const std::vector<std::uint32_t> descending(ascending.rbegin(), ascending.rend());
    EXPECT_EQ(split_tree(graph, ascending), join_by_definition(grid, descending));
  }
}

TEST(ContourTree, PiecesGiveAForestAndNothingANothing) {
  GridTerrain a = tiny_terrain(4), b = tiny_terrain(5);
  const std::uint32_t shift = a.num_vertices();
  for (const std::uint32_t v : b.triangle) a.triangle.push_back(v + shift);
  a.height.insert(a.height.end(), b.height.begin(), b.height.end());
  for (const LatticePoint p : b.position) a.position.push_back({p.x + 1000, p.y});
  const auto tree = contour_tree(make_vertex_graph(a.num_vertices(), a.triangle), a.height, a.position);
  ASSERT_TRUE(tree.has_value());
  EXPECT_EQ(arcs_of(*tree).size(), a.num_vertices() - 2);
  EXPECT_EQ(arcs_of(*tree), oracle::contour_arcs(a.triangle, a.height, a.position));
  ASSERT_TRUE(contour_tree(make_vertex_graph(0, {}), {}, {}).has_value());
}

TEST(ContourTree, HolesEndInATreeOrInNone) {
  std::size_t num_trees = 0, num_none = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    const auto terrain = testing::make_outlet_terrain(seed).grid;
    const VertexGraph graph = make_vertex_graph(terrain.num_vertices(), terrain.triangle);
    const auto tree = contour_tree(graph, terrain.height, terrain.position);
    if (!tree) {
      ++num_none;
      continue;
    }
    ++num_trees;
    std::size_t roots = 0;
    for (const std::uint32_t w : tree->other) roots += w == kNoVertex;
    EXPECT_EQ(arcs_of(*tree).size() + roots, terrain.num_vertices());
  }
  EXPECT_GT(num_trees, 100u);
  RecordProperty("without_tree", static_cast<int>(num_none));
}

TEST(ContourTree, DoesNotDependOnTheNumbering) {
  GridTerrain grid = make_grid(3, 60, 50, 100, 30);
  grid.height = testing::relief_heights(3, grid.position, 1500, 60, 4);
  const auto tree = contour_tree(make_vertex_graph(grid.num_vertices(), grid.triangle), grid.height, grid.position);
  ASSERT_TRUE(tree.has_value());
  std::vector<std::uint32_t> to(grid.num_vertices());
  std::iota(to.begin(), to.end(), 0u);
  testing::shuffle(5, to);
  GridTerrain moved = grid;
  for (std::uint32_t v = 0; v < to.size(); ++v) {
    moved.height[to[v]] = grid.height[v];
    moved.position[to[v]] = grid.position[v];
  }
  for (auto& v : moved.triangle) v = to[v];
  const auto other = contour_tree(make_vertex_graph(grid.num_vertices(), moved.triangle), moved.height, moved.position);
  ASSERT_TRUE(other.has_value());
  Arcs expected;
  for (const auto& [a, b] : arcs_of(*tree)) expected.insert({to[a], to[b]});
  EXPECT_EQ(arcs_of(*other), expected);
}

}  // namespace
}  // namespace hydrotin
