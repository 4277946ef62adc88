#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>

#include "grid_terrain.h"
#include "hydrotin/lifting.h"
#include "hydrotin/nested_pools.h"
#include "hydrotin/outlets.h"
#include "hydrotin/pits.h"
#include "hydrotin/spill_tree.h"
#include "hydrotin/vertex_graph.h"
#include "oracle/terrain_oracle.h"

// Pits, and the promise that a terrain cut into parts has the pits and levels of the whole.

namespace hydrotin {
namespace {

using testing::GridTerrain;
using testing::make_grid;
using testing::make_outlet_terrain;
using testing::OutletTerrain;
using testing::Random;

/// One part: its triangles with its own numbering of vertices.
struct Part {
  VertexGraph graph;
  std::vector<std::uint32_t> triangle;
  std::vector<std::uint64_t> global_id;
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  std::vector<std::uint8_t> is_outlet, is_rim;
};

std::uint64_t global_of(std::uint32_t v, std::uint64_t seed) {
  return (std::uint64_t{v % (1 + seed % 5)} << 32) | (v * 2654435761u);  // distinct, in no order of v
}

/// Cuts a terrain: part_of[t] is the part of triangle t. Vertices of a part are numbered in a random order.
std::vector<Part> cut(const OutletTerrain& whole, const std::vector<std::uint32_t>& part_of, std::uint32_t num_parts,
                      std::uint64_t seed) {
  const GridTerrain& grid = whole.grid;
  std::vector<std::set<std::uint32_t>> parts_of_vertex(grid.num_vertices());
  for (std::size_t c = 0; c < grid.triangle.size(); ++c) parts_of_vertex[grid.triangle[c]].insert(part_of[c / 3]);
  std::vector<Part> parts(num_parts);
  for (std::uint32_t p = 0; p < num_parts; ++p) {
    Part& part = parts[p];
    std::vector<std::uint32_t> member;
    for (std::uint32_t v = 0; v < grid.num_vertices(); ++v)
      if (parts_of_vertex[v].contains(p)) member.push_back(v);
    testing::shuffle(seed + p, member);
    std::map<std::uint32_t, std::uint32_t> local;
    Random random(seed + p);
    const bool has_extra_rim = random.below(3) == 0;
    for (const std::uint32_t v : member) {
      local[v] = static_cast<std::uint32_t>(part.global_id.size());
      part.global_id.push_back(global_of(v, seed));
      part.position.push_back(grid.position[v]);
      part.height.push_back(grid.height[v]);
      part.is_outlet.push_back(whole.is_outlet[v]);
      part.is_rim.push_back(parts_of_vertex[v].size() > 1 || (has_extra_rim && random.below(5) == 0));
    }
    for (std::size_t t = 0; t < grid.num_triangles(); ++t)
      if (part_of[t] == p)
        for (std::size_t i = 0; i < 3; ++i) part.triangle.push_back(local[grid.triangle[3 * t + i]]);
    part.graph = make_vertex_graph(static_cast<std::uint32_t>(part.global_id.size()), part.triangle);
  }
  return parts;
}

/// Triangles at random, in rectangles, or one part for each.
std::vector<std::uint32_t> random_parts(const GridTerrain& grid, std::uint64_t seed, std::uint32_t& num_parts) {
  Random random(seed ^ 0x9a17u);
  std::vector<std::uint32_t> part_of(grid.num_triangles());
  const std::uint32_t kind = random.below(4);
  num_parts = kind == 0 ? static_cast<std::uint32_t>(part_of.size()) : 1 + random.below(6);
  const std::int32_t side = random.between(10, 60);
  for (std::uint32_t t = 0; t < part_of.size(); ++t) {
    const LatticePoint p = grid.position[grid.triangle[3 * t]];
    if (kind == 0) part_of[t] = t;
    if (kind == 1) part_of[t] = random.below(num_parts);
    if (kind >= 2) part_of[t] = static_cast<std::uint32_t>((p.x + 10) / side + 3 * ((p.y + 10) / side)) % num_parts;
  }
  return part_of;
}

/// A terrain all of whose vertices are in some triangle: others belong to no part.
OutletTerrain terrain_of_triangles(std::uint64_t seed) {
  const OutletTerrain all = make_outlet_terrain(seed);
  std::vector<std::uint32_t> to(all.grid.num_vertices(), 0);
  for (const std::uint32_t v : all.grid.triangle) to[v] = 1;
  OutletTerrain used;
  for (std::uint32_t v = 0; v < to.size(); ++v) {
    if (!to[v]) continue;
    to[v] = used.grid.num_vertices();
    used.grid.position.push_back(all.grid.position[v]);
    used.grid.height.push_back(all.grid.height[v]);
    used.is_outlet.push_back(all.is_outlet[v]);
  }
  for (const std::uint32_t v : all.grid.triangle) used.grid.triangle.push_back(to[v]);
  return used;
}

VertexGraph graph_of(const GridTerrain& grid) {
  return make_vertex_graph(grid.num_vertices(), grid.triangle);
}

TEST(Pits, EqualDefinition) {
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = make_outlet_terrain(seed);
    const VertexGraph graph = graph_of(t.grid);
    const auto expected = oracle::pits(oracle::neighbors(t.grid.num_vertices(), t.grid.triangle), t.grid.height,
                                       t.grid.position, t.is_outlet);
    const auto pits = find_pits(graph, t.grid.height, t.grid.position, t.is_outlet);
    ASSERT_EQ(pits.size(), expected.size());
    for (std::size_t i = 0; i < pits.size(); ++i) {
      EXPECT_EQ(pits[i].representative, expected[i].representative);
      EXPECT_EQ(pits[i].vertex, expected[i].vertex);
      EXPECT_EQ(pits[i].height, expected[i].height);
      EXPECT_EQ(pits[i].num_vertices, expected[i].num_vertices);
    }
    EXPECT_EQ(count_pits(graph, t.grid.height, t.is_outlet), pits.size());
  }
}

TEST(Parts, PlateausResolveToThePitsOfTheWhole) {
  std::size_t num_open_pits = 0;
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = terrain_of_triangles(seed);
    std::uint32_t num_parts = 0;
    const auto part_of = random_parts(t.grid, seed, num_parts);
    std::vector<PlateauSummary> summaries;
    std::vector<Pit> pits;
    for (const Part& p : cut(t, part_of, num_parts, seed)) {
      summaries.push_back(summarize_plateaus(p.graph, p.height, p.position, p.is_outlet, p.global_id, p.is_rim));
      pits.insert(pits.end(), summaries.back().pit.begin(), summaries.back().pit.end());
      EXPECT_EQ(summaries.back().rim_vertex.size(),
                static_cast<std::size_t>(std::count(p.is_rim.begin(), p.is_rim.end(), 1)));
    }
    const auto resolved = resolve_plateaus(summaries);
    EXPECT_TRUE(std::is_sorted(resolved.begin(), resolved.end()));
    num_open_pits += resolved.size();
    pits.insert(pits.end(), resolved.begin(), resolved.end());
    std::sort(pits.begin(), pits.end());
    auto expected = find_pits(graph_of(t.grid), t.grid.height, t.grid.position, t.is_outlet);
    for (Pit& pit : expected) pit.vertex = global_of(static_cast<std::uint32_t>(pit.vertex), seed);
    EXPECT_EQ(pits, expected);
  }
  EXPECT_GT(num_open_pits, 1000u);
}

TEST(Parts, ReduceDrainFinishEqualsLiftingTheWhole) {
  std::size_t num_lifted = 0, num_without_rim = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = terrain_of_triangles(seed);
    const auto expected = lift(graph_of(t.grid), t.grid.height, t.is_outlet);
    std::map<std::uint64_t, std::int32_t> expected_of;
    for (std::uint32_t v = 0; v < expected.size(); ++v) expected_of[global_of(v, seed)] = expected[v];

    std::uint32_t num_parts = 0;
    const auto part_of = random_parts(t.grid, seed, num_parts);
    const auto parts = cut(t, part_of, num_parts, seed);
    std::vector<SpillTree> trees;
    std::vector<Catchments> catchments(parts.size());
    for (const Part& p : parts) {
      Catchments& kept = catchments[trees.size()];
      trees.push_back(reduce_to_rim(p.graph, p.height, p.global_id, p.is_rim, p.is_outlet, &kept));
      EXPECT_EQ(trees.back().edge, reduce_to_rim(p.graph, p.height, p.global_id, p.is_rim, p.is_outlet).edge);
      EXPECT_TRUE(is_valid(trees.back()));
      EXPECT_LE(trees.back().edge.size(), trees.back().rim.size());
      num_without_rim += trees.back().rim.empty();
    }
    const RimLevels rim = drain(trees);
    for (std::size_t i = 0; i < rim.vertex.size(); ++i) EXPECT_EQ(rim.level[i], expected_of.at(rim.vertex[i]));
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const Part& part = parts[p];
      const auto levels = rim.of(trees[p].rim);
      std::map<std::uint64_t, std::int32_t> level_of;
      for (std::size_t i = 0; i < levels.size(); ++i) level_of[trees[p].rim[i]] = levels[i];
      std::vector<std::int32_t> source(part.height.size(), kNoLevel);
      for (std::size_t v = 0; v < source.size(); ++v)
        if (part.is_rim[v]) source[v] = level_of.at(part.global_id[v]);
      const auto finished = lift_from(part.graph, part.height, part.is_outlet, source);
      EXPECT_EQ(lift_catchments(catchments[p], levels), finished);
      for (std::size_t v = 0; v < finished.size(); ++v) {
        EXPECT_EQ(finished[v], expected_of.at(part.global_id[v]));
        num_lifted += finished[v] != part.height[v];
      }
    }
  }
  EXPECT_GT(num_lifted, 10000u);
  EXPECT_GT(num_without_rim, 100u);
}

/// Minimax heights between all pairs of `terminals` and from each to the nearest outlet, by Floyd-Warshall.
std::vector<std::vector<std::int64_t>> minimax(const oracle::Neighbors& around, const std::vector<std::int32_t>& height,
                                               const std::vector<std::uint8_t>& is_outlet) {
  const std::size_t n = height.size();
  constexpr std::int64_t kFar = std::int64_t{1} << 40;
  std::vector<std::vector<std::int64_t>> d(n + 1, std::vector<std::int64_t>(n + 1, kFar));
  for (std::size_t v = 0; v < n; ++v) {
    for (const std::uint32_t w : around[v]) d[v][w] = std::max(height[v], height[w]);
    if (is_outlet[v]) d[v][n] = d[n][v] = height[v];
  }
  for (std::size_t k = 0; k <= n; ++k)
    for (std::size_t i = 0; i <= n; ++i)
      for (std::size_t j = 0; j <= n; ++j) d[i][j] = std::min(d[i][j], std::max(d[i][k], d[k][j]));
  return d;
}

TEST(SpillTree, KeepsTheMinimaxHeightOfEveryPairOfTerminals) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = make_outlet_terrain(seed);
    const std::size_t n = t.grid.num_vertices();
    Random random(seed);
    std::vector<std::uint8_t> is_rim(n);
    const std::uint32_t share = random.below(11);
    for (auto& flag : is_rim) flag = random.below(10) < share;
    std::vector<std::uint64_t> id(n);
    for (std::uint32_t v = 0; v < n; ++v) id[v] = global_of(v, seed);
    const SpillTree tree = reduce_to_rim(graph_of(t.grid), t.grid.height, id, is_rim, t.is_outlet);
    ASSERT_TRUE(is_valid(tree));
    const auto expected = minimax(oracle::neighbors(n, t.grid.triangle), t.grid.height, t.is_outlet);

    const std::size_t r = tree.rim.size();
    constexpr std::int64_t kFar = std::int64_t{1} << 40;
    std::vector<std::vector<std::int64_t>> d(r + 1, std::vector<std::int64_t>(r + 1, kFar));
    for (const SpillEdge& e : tree.edge) {
      const std::size_t b = e.b == kOutlet ? r : e.b;
      d[e.a][b] = d[b][e.a] = std::min(d[e.a][b], std::int64_t{e.height});
    }
    for (std::size_t k = 0; k <= r; ++k)
      for (std::size_t i = 0; i <= r; ++i)
        for (std::size_t j = 0; j <= r; ++j) d[i][j] = std::min(d[i][j], std::max(d[i][k], d[k][j]));
    std::vector<std::size_t> vertex(r + 1, n);
    for (std::size_t i = 0; i < r; ++i)
      vertex[i] = static_cast<std::size_t>(std::find(id.begin(), id.end(), tree.rim[i]) - id.begin());
    for (std::size_t i = 0; i <= r; ++i)
      for (std::size_t j = 0; j < i; ++j) ASSERT_EQ(d[i][j], expected[vertex[i]][vertex[j]]) << i << " " << j;
  }
}

TEST(SpillTree, DrainOfNothingAndInvalidTrees) {
  EXPECT_TRUE(drain({}).vertex.empty());
  EXPECT_TRUE(resolve_plateaus({}).empty());
  const std::vector<SpillTree> lonely{{{7, 9}, {}}, {{9, 12}, {{0, 1, 5}}}};
  const RimLevels levels = drain(lonely);
  EXPECT_EQ(levels.vertex, (std::vector<std::uint64_t>{7, 9, 12}));
  EXPECT_EQ(levels.level, std::vector<std::int32_t>(3, kNoLevel));
  EXPECT_TRUE(is_valid({{1, 2}, {{0, kOutlet, 3}, {0, 1, 3}}}));
  EXPECT_FALSE(is_valid({{2, 1}, {}}));
  EXPECT_FALSE(is_valid({{1, 1}, {}}));
  EXPECT_FALSE(is_valid({{1, 2}, {{0, 2, 3}}}));
  EXPECT_FALSE(is_valid({{1, 2}, {{kOutlet, 1, 3}}}));
  EXPECT_FALSE(is_valid({{1, 2}, {{0, 1, kNoLevel}}}));
  EXPECT_FALSE(is_valid({{1}, {{0, kOutlet, 3}, {0, kOutlet, 4}}}));
}

// A larger terrain in 1, 4, 25 and 400 square tiles against the whole.
TEST(Parts, LargeTerrainIsTheSameForEveryTiling) {
  OutletTerrain t;
  t.grid = make_grid(9, 160, 140, 100, 30);
  t.grid.height = testing::relief_heights(9, t.grid.position, 3000, 400, 60);
  for (const bool hull : {true, false}) {
    t.is_outlet = testing::hull_flags(t.grid);
    if (!hull) {
      t.is_outlet.assign(t.grid.num_vertices(), 0);
      t.is_outlet[lowest_vertex(t.grid.height, t.grid.position)] = 1;
    }
    const auto expected = lift(graph_of(t.grid), t.grid.height, t.is_outlet);
    for (const std::int32_t tiles : {1, 2, 5, 20}) {
      std::vector<std::uint32_t> part_of(t.grid.num_triangles());
      for (std::size_t i = 0; i < part_of.size(); ++i) {
        const LatticePoint p = t.grid.position[t.grid.triangle[3 * i]];
        part_of[i] = static_cast<std::uint32_t>((p.x + 50) * tiles / 16100 + tiles * ((p.y + 50) * tiles / 14100));
      }
      const auto parts = cut(t, part_of, static_cast<std::uint32_t>(tiles * tiles), 0);
      std::vector<SpillTree> trees;
      for (const Part& p : parts) trees.push_back(reduce_to_rim(p.graph, p.height, p.global_id, p.is_rim, p.is_outlet));
      const RimLevels rim = drain(trees);
      for (const Part& p : parts) {
        std::vector<std::int32_t> source(p.height.size(), kNoLevel);
        for (std::size_t v = 0; v < source.size(); ++v)
          if (p.is_rim[v]) source[v] = rim.of({&p.global_id[v], 1})[0];
        const auto finished = lift_from(p.graph, p.height, p.is_outlet, source);
        for (std::size_t v = 0; v < finished.size(); ++v) {
          const auto whole = static_cast<std::uint32_t>(p.global_id[v]) * 244002641u;  // inverse of the id's factor
          ASSERT_EQ(finished[v], expected[whole]) << tiles;
        }
      }
    }
  }
}

/// The hierarchy of a cut terrain, found part by part.
std::optional<std::vector<PitBasin>> nested_pits_of(const std::vector<Part>& parts, bool with_prices) {
  std::vector<ReducedPools> reduced;
  std::vector<PlateauSummary> summaries;
  std::vector<DecidedPit> decided;
  std::vector<Pit> plateaus;
  for (const Part& p : parts) {
    reduced.push_back(reduce_pools(p.graph, p.triangle, p.height, p.position, p.global_id, p.is_rim, p.is_outlet));
    decided.insert(decided.end(), reduced.back().pit.begin(), reduced.back().pit.end());
    summaries.push_back(summarize_plateaus(p.graph, p.height, p.position, p.is_outlet, p.global_id, p.is_rim));
    plateaus.insert(plateaus.end(), summaries.back().pit.begin(), summaries.back().pit.end());
  }
  const auto across = resolve_plateaus(summaries);
  plateaus.insert(plateaus.end(), across.begin(), across.end());
  RankedPools ranked = rank_pools(reduced, with_prices);
  if (!ranked.all_drain) return std::nullopt;
  std::set<std::uint64_t> counted;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Part& p = parts[i];
    std::vector<std::uint8_t> counts;
    for (const std::uint64_t id : p.global_id) counts.push_back(counted.insert(id).second);
    const auto answer = weigh_pools(p.graph, p.triangle, p.height, p.position, p.global_id, counts, ranked.query[i]);
    for (std::size_t q = 0; q < answer.size(); ++q) ranked.content[ranked.query[i][q].answer_to].add(answer[q]);
  }
  return nested_pits(decided, ranked, plateaus);
}

TEST(NestedPools, EveryCutGivesTheHierarchyOfTheWhole) {
  std::size_t num_pits = 0, num_nested = 0, num_decided_globally = 0;
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    SCOPED_TRACE(seed);
    OutletTerrain t = terrain_of_triangles(seed);
    if (t.grid.num_vertices() == 0) continue;
    std::uint32_t num_parts = 0;
    const auto part_of = random_parts(t.grid, seed, num_parts);
    const auto parts = cut(t, part_of, num_parts, seed);
    const VertexGraph graph = graph_of(t.grid);
    const auto expected = pit_hierarchy(graph, t.grid.triangle, t.grid.height, t.grid.position, t.is_outlet);
    const bool with_prices = seed % 2 == 0;
    const auto got = nested_pits_of(parts, with_prices);
    const bool all_drain = pieces_without_outlet(graph, t.grid.position, t.is_outlet).empty();
    ASSERT_EQ(got.has_value(), all_drain);
    if (!got) continue;
    ASSERT_EQ(got->size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const PitBasin &a = (*got)[i], &b = expected[i];
      EXPECT_EQ(a.pit.representative, b.pit.representative);
      EXPECT_EQ(a.pit.vertex, global_of(static_cast<std::uint32_t>(b.pit.vertex), seed));
      EXPECT_EQ(std::tuple(a.pit.height, a.pit.num_vertices, a.parent),
                std::tuple(b.pit.height, b.pit.num_vertices, b.parent));
      EXPECT_EQ(a.spill_position, b.spill_position);
      EXPECT_EQ(std::tuple(a.spill_level, a.num_vertices, a.displacement, a.doubled_area),
                std::tuple(b.spill_level, b.num_vertices, b.displacement, b.doubled_area));
      EXPECT_EQ(a.volume, b.volume);
      if (with_prices) {
        EXPECT_EQ(a.price, b.price);
      }
      num_nested += b.parent != kNoPit;
    }
    num_pits += expected.size();
    std::vector<ReducedPools> reduced;
    for (const Part& p : parts)
      reduced.push_back(reduce_pools(p.graph, p.triangle, p.height, p.position, p.global_id, p.is_rim, p.is_outlet));
    num_decided_globally += rank_pools(reduced, false).pit.size();
  }
  EXPECT_GT(num_pits, 2000u);
  EXPECT_GT(num_nested, 500u);
  EXPECT_GT(num_decided_globally, 500u);
  EXPECT_GT(num_pits - num_decided_globally, 200u);
}

}  // namespace
}  // namespace hydrotin
