#include "hydrotin/network_cleaning.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "hydrotin/lifting.h"
#include "hydrotin/line_insertion.h"
#include "hydrotin/pits.h"
#include "hydrotin/river_embedding.h"
#include "hydrotin/river_lakes.h"
#include "hydrotin/river_mouths.h"
#include "hydrotin/river_statistics.h"
#include "hydrotin/vertex_graph.h"
#include "hydrotin/wingtip_clearing.h"
#include "line_terrains.h"

namespace hydrotin {
namespace {

struct Case {
  LatticeTerrain terrain;
  std::vector<std::array<double, 2>> place;
  [[nodiscard]] RiverTerrain view() {
    place.clear();
    for (const LatticePoint p : terrain.position) place.push_back({p.x / 4.0, p.y / 4.0});
    return {place, terrain.height, terrain.triangle};
  }
};

std::set<std::uint32_t> below(const std::vector<RiverEdge>& edges, std::uint32_t v) {
  std::set<std::uint32_t> seen{v};
  std::vector<std::uint32_t> open{v};
  while (!open.empty()) {
    const std::uint32_t u = open.back();
    open.pop_back();
    for (const auto& [from, to] : edges)
      if (from == u && seen.insert(to).second) open.push_back(to);
  }
  return seen;
}

TEST(NetworkCleaning, NoFaultIsLeftAndWaterGetsToTheEndOfItsPath) {
  std::size_t edges = 0, cycles = 0, whole = 0, joined = 0;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Case c{testing::lattice_terrain(seed, 15 + seed % 40, 100, seed % 3 == 0, false), {}};
    if (c.terrain.triangle.empty()) continue;
    const TerrainLocator locator(c.terrain);
    const RiverLines reaches =
        split_at_nodes(without_repeats(testing::random_lines(c.terrain, seed, 1 + seed % 6, 100)));
    const SnappedLines snapped = snap_lines(locator, reaches);
    const CleanNetwork network = clean_network(c.terrain.position, c.terrain.height, snapped.paths);
    ASSERT_EQ(check_network(c.view(), network.edge).fault, NetworkFault::none);
    edges += network.edge.size();
    cycles += network.cycle_begin.size() - 1;
    joined += network.counts.joined_edges;
    if (network.counts.cycle_edges + network.counts.opposed_edges == 0)
      for (std::size_t i = 0; i < snapped.paths.size(); ++i) {
        const auto path = snapped.paths.path(i);
        EXPECT_TRUE(below(network.edge, path.front()).contains(path.back()));
        ++whole;
      }
    // Other numbers for the vertices, another order of the paths: the same edges.
    std::mt19937 random(seed);
    std::vector<std::uint32_t> name(c.terrain.position.size()), order(snapped.paths.size());
    std::iota(name.begin(), name.end(), 0u);
    std::iota(order.begin(), order.end(), 0u);
    std::shuffle(name.begin(), name.end(), random);
    std::shuffle(order.begin(), order.end(), random);
    std::vector<LatticePoint> position(name.size());
    std::vector<double> height(name.size());
    for (std::uint32_t v = 0; v < name.size(); ++v) {
      position[name[v]] = c.terrain.position[v];
      height[name[v]] = c.terrain.height[v];
    }
    RiverPaths other;
    for (const std::uint32_t i : order) {
      for (const std::uint32_t v : snapped.paths.path(i)) other.vertex.push_back(name[v]);
      other.begin.push_back(other.vertex.size());
      other.line.push_back(snapped.paths.line[i]);
    }
    const CleanNetwork again = clean_network(position, height, other);
    ASSERT_EQ(again.edge.size(), network.edge.size());
    for (std::size_t e = 0; e < again.edge.size(); ++e)
      ASSERT_EQ(again.edge[e], (RiverEdge{name[network.edge[e].from], name[network.edge[e].to]}));
  }
  EXPECT_GT(edges, 2000u);
  EXPECT_GT(cycles, 50u);
  EXPECT_GT(whole, 80u);
  EXPECT_GT(joined, 100u);
}

TEST(NetworkCleaning, CirclesOfLinesAreNamedAndTheSteepestRiseIsLeftOut) {
  const std::vector<LatticePoint> position{{0, 0}, {10, 0}, {10, 10}, {20, 10}};
  RiverPaths paths;
  const auto add = [&](std::vector<std::uint32_t> path, std::uint32_t line) {
    paths.vertex.insert(paths.vertex.end(), path.begin(), path.end());
    paths.begin.push_back(paths.vertex.size());
    paths.line.push_back(line);
  };
  add({0, 1}, 7);
  add({1, 2}, 8);
  add({2, 0}, 9);
  add({2, 3}, 5);
  const CleanNetwork network = clean_network(position, std::vector<double>{5, 3, 1, 0}, paths);
  ASSERT_EQ(network.cycle_begin.size(), 2u);
  EXPECT_EQ(network.cycle, (std::vector<std::uint32_t>{9, 7, 8}));
  EXPECT_EQ(network.edge, (std::vector<RiverEdge>{{0, 1}, {1, 2}, {2, 3}}));
}

TEST(WingtipClearing, EveryStrictProgramIsFeasibleAfterwards) {
  std::size_t third = 0, points = 0, chains = 0, embedded = 0;
  for (std::uint32_t seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    const std::int32_t spread = 4000;
    Case c{testing::lattice_terrain(seed, 20 + seed % 60, spread, seed % 3 == 0, false), {}};
    if (c.terrain.triangle.empty()) continue;
    const TerrainLocator locator(c.terrain);
    const RiverLines reaches = split_at_nodes(without_repeats(testing::random_lines(c.terrain, seed, 4, spread)));
    CleanNetwork network;
    if (seed % 2 == 0) {
      network = clean_network(c.terrain.position, c.terrain.height, snap_lines(locator, reaches).paths);
      third += take_third_edges(c.terrain, network);
    } else {
      InsertedLines inserted = insert_lines(locator, reaches);
      c.terrain = std::move(inserted.terrain);
      network = clean_network(c.terrain.position, c.terrain.height, inserted.paths);
    }
    ASSERT_EQ(check_network(c.view(), network.edge).fault, NetworkFault::none);
    if (seed % 2 == 0) {  // no triangle calls for its third edge
      for (std::size_t t = 0; t < c.terrain.triangle.size(); t += 3)
        for (std::size_t i = 0; i < 3; ++i) {
          const std::uint32_t a = c.terrain.triangle[t + i], m = c.terrain.triangle[t + (i + 1) % 3],
                              b = c.terrain.triangle[t + (i + 2) % 3];
          std::size_t in = 0, out = 0, is_way = 0, has_third = 0;
          for (const auto& [from, to] : network.edge) {
            in += to == m;
            out += from == m;
            is_way +=
                (from == a && to == m) || (from == m && to == b) || (from == b && to == m) || (from == m && to == a);
            has_third += (from == a && to == b) || (from == b && to == a);
          }
          EXPECT_FALSE(in == 1 && out == 1 && is_way == 2 && has_third == 0);
        }
    }
    const OutletChains mouths = find_outlet_chains(c.view(), network.edge, rim_vertices(c.view()), {});
    chains += mouths.edge.size();
    const Case before = c;
    const ClearedWingtips cleared = clear_wingtips(c.terrain, network.edge, mouths.edge, {});
    points += cleared.num_points;
    ASSERT_EQ(c.terrain.position.size(), before.terrain.position.size() + cleared.num_points);
    ASSERT_EQ(find_bad_triangle(c.terrain.position, c.terrain.triangle), c.terrain.triangle.size() / 3);
    if (cleared.num_left > 0) continue;
    std::vector<std::uint8_t> is_way(c.terrain.position.size(), 0);
    for (const auto& list : {network.edge, mouths.edge})
      for (const auto& [from, to] : list) is_way[from] = is_way[to] = 1;
    for (std::size_t t = 0; t < c.terrain.triangle.size(); t += 3)
      for (const auto& [from, to] : network.edge) {
        const auto* v = c.terrain.triangle.data() + t;
        if (std::count(v, v + 3, from) + std::count(v, v + 3, to) == 2) {
          EXPECT_EQ(is_way[v[0] + v[1] + v[2] - from - to], 0);
        }
      }
    EmbeddingOptions options;
    options.constraints.decline_measure = DeclineMeasure::slope;
    options.constraints.decline = 0.01;
    options.constraints.side_slope = 0.01;
    options.constraints.chain = mouths.edge;
    options.quantum = 0.01;
    const Embedding embedding = embed_rivers(c.view(), network.edge, options);
    EXPECT_TRUE(embedding.broken.empty());
    ++embedded;
    for (const auto& [from, to] : mouths.edge) EXPECT_GE(embedding.height[from], embedding.height[to]);
    const auto after = river_statistics(c.view(), network.edge, embedding.height, 0);
    EXPECT_EQ(after.wrong_flow + after.not_valley + after.flat_edges, 0u);
    // Stopped at once, the heights hold the rows of rivers and chains all the same.
    options.stop = [] { return true; };
    const Embedding stopped = embed_rivers(c.view(), network.edge, options);
    for (const BrokenRow& row : stopped.broken)
      EXPECT_TRUE(row.kind != RowKind::flow && row.kind != RowKind::valley && row.kind != RowKind::chain);
    const auto burned = river_statistics(c.view(), network.edge, stopped.height, 0);
    EXPECT_EQ(burned.wrong_flow + burned.not_valley, 0u);
    // D5: lifting from the rim (and closed mouths) moves no river vertex, and every river edge stays as it should be.
    const VertexGraph graph = make_vertex_graph(c.terrain.num_vertices(), c.terrain.triangle);
    std::vector<std::int32_t> height;
    for (const double h : embedding.height) height.push_back(static_cast<std::int32_t>(std::lround(h * 1e4)));
    std::vector<std::uint8_t> outlets = rim_vertices(c.view());
    for (const RiverMouth& mouth : mouths.mouth)
      if (mouth.kind == MouthKind::closed) outlets[mouth.vertex] = 1;
    const auto level = lift(graph, height, outlets);
    for (std::size_t v = 0; v < level.size(); ++v) {
      if (is_way[v] != 0) {
        EXPECT_EQ(level[v], height[v]);
      }
    }
    EXPECT_EQ(count_pits(graph, level, outlets), 0u);
  }
  EXPECT_GT(third, 50u);
  EXPECT_GT(points, 200u);
  EXPECT_GT(chains, 50u);
  EXPECT_GT(embedded, 100u);
}

TEST(RiverMouths, ChainsClimbAsLittleAsAnyWayThatKeepsToTheRule) {
  std::size_t chained = 0, closed = 0;
  for (std::uint32_t seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    Case c{testing::lattice_terrain(seed, 20 + seed % 40, 100, seed % 3 == 0, false), {}};
    if (c.terrain.triangle.empty()) continue;
    const TerrainLocator locator(c.terrain);
    const RiverLines reaches = split_at_nodes(without_repeats(testing::random_lines(c.terrain, seed, 6, 60, {20, 20})));
    const auto rivers = clean_network(c.terrain.position, c.terrain.height, snap_lines(locator, reaches).paths).edge;
    const std::uint32_t n = c.terrain.num_vertices();
    std::vector<std::uint8_t> outlet(n, 0);
    for (std::uint32_t v = 0; v < n; v += 9) outlet[v] = 1;
    const OutletChains chains = find_outlet_chains(c.view(), rivers, outlet, {});
    std::set<std::uint32_t> has_down;
    std::set<std::pair<std::uint32_t, std::uint32_t>> is_down;
    for (const auto& [from, to] : rivers) {
      has_down.insert(from);
      is_down.insert({from, to});
    }
    // Bellman's equations, from above.
    std::vector<double> level(n, HUGE_VAL);
    for (std::uint32_t v = 0; v < n; ++v)
      if (outlet[v] != 0 && !has_down.contains(v)) level[v] = c.terrain.height[v];
    for (bool again = true; again;) {
      again = false;
      const auto offer = [&](std::uint32_t v, double from) {
        const double l = std::max(from, c.terrain.height[v]);
        again = again || l < level[v];
        level[v] = std::min(level[v], l);
      };
      for (std::uint32_t h = 0; h < c.terrain.triangle.size(); ++h)
        for (const auto& [v, w] :
             {std::pair(c.terrain.origin(h), c.terrain.target(h)), std::pair(c.terrain.target(h), c.terrain.origin(h))})
          if (outlet[v] == 0 && !has_down.contains(v)) offer(v, level[w]);
      for (const std::uint32_t v : has_down) {  // every branch must have a way out
        double most = 0;
        for (const auto& [from, to] : rivers)
          if (from == v) most = std::max(most, level[to]);
        offer(v, most);
      }
    }
    std::set<std::uint32_t> mouths;
    for (const auto& edge : rivers)
      if (!has_down.contains(edge.to)) mouths.insert(edge.to);
    ASSERT_EQ(chains.mouth.size(), mouths.size());
    std::vector<RiverEdge> all = rivers;
    all.insert(all.end(), chains.edge.begin(), chains.edge.end());
    const NetworkCheck check = check_network(c.view(), all);
    EXPECT_EQ(check.fault, NetworkFault::none);
    for (const RiverMouth& mouth : chains.mouth) {
      EXPECT_TRUE(mouths.contains(mouth.vertex));
      EXPECT_EQ(mouth.kind == MouthKind::outlet, outlet[mouth.vertex] != 0);
      EXPECT_EQ(mouth.kind == MouthKind::closed, level[mouth.vertex] == HUGE_VAL);
      if (mouth.kind == MouthKind::closed) ++closed;
      if (mouth.kind != MouthKind::chained) continue;
      ++chained;
      EXPECT_EQ(mouth.climb, level[mouth.vertex] - c.terrain.height[mouth.vertex]);
      bool drains = false;
      for (const std::uint32_t v : below(all, mouth.vertex)) drains = drains || outlet[v] != 0;
      EXPECT_TRUE(drains);
    }
  }
  EXPECT_GT(chained, 100u);
  EXPECT_GT(closed, 0u);
}

TEST(RiverLakes, WithLakesAsOneVertexEachNoWaterRunsInACircle) {
  std::uint64_t joined = 0, merged = 0, chained = 0, kept = 0;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Case c{testing::lattice_terrain(seed, 30 + seed % 60, 100, seed % 3 == 0, false), {}};
    if (c.terrain.triangle.empty()) continue;
    const TerrainLocator locator(c.terrain);
    const RiverLines reaches = split_at_nodes(without_repeats(testing::random_lines(c.terrain, seed, 6, 100)));
    const auto rivers = clean_network(c.terrain.position, c.terrain.height, snap_lines(locator, reaches).paths).edge;
    const std::uint32_t n = c.terrain.num_vertices();
    std::vector<Lake> lakes(3);
    std::vector<std::uint8_t> taken(n, 0);
    for (std::uint32_t i = 0; i < 3; ++i)
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t v = (seed * 7 + i * 11 + k * 5) % n;
        if (taken[v]++ == 0) lakes[i].vertex.push_back(v);
      }
    const ClosedLakes closed = close_lakes(c.view(), rivers, lakes);
    joined += closed.joined_vertices;
    merged += closed.joined_lakes;
    std::vector<std::uint32_t> number = lake_numbers(n, closed.lake);
    std::size_t members = 0;
    for (const Lake& lake : closed.lake) members += lake.vertex.size();
    EXPECT_EQ(members,
              static_cast<std::size_t>(n) - static_cast<std::size_t>(std::count(number.begin(), number.end(), 0u)));
    for (const Lake& lake : lakes)
      for (const std::uint32_t v : lake.vertex) EXPECT_EQ(number[v], number[lake.vertex[0]]);
    std::vector<std::uint8_t> outlet(n, 0);
    for (std::uint32_t v = 3; v < n; v += 17) outlet[v] = 1;
    const OutletChains chains = find_outlet_chains(c.view(), rivers, outlet, number);
    // Contracted, rivers and chains make no circle; every mouth that is not closed gets to an outlet or a last lake.
    std::vector<RiverEdge> all;
    const auto node = [&](std::uint32_t v) { return number[v] == 0 ? v : n + number[v]; };
    for (const auto& list : {rivers, chains.edge})
      for (const auto& [from, to] : list)
        if (node(from) != node(to)) all.push_back({node(from), node(to)});
    for (const auto& edge : all) ASSERT_FALSE(below(all, edge.to).contains(edge.from));
    for (const RiverMouth& mouth : chains.mouth) {
      if (mouth.kind != MouthKind::chained) continue;
      ++chained;
      bool drains = false;
      for (const std::uint32_t v : below(all, node(mouth.vertex))) drains = drains || v >= n || outlet[v] != 0;
      EXPECT_TRUE(drains);
    }
    kept += closed.lake.size();
  }
  EXPECT_GT(joined, 100u);
  EXPECT_GT(merged, 50u);
  EXPECT_GT(chained, 50u);
  EXPECT_GT(kept, 200u);
}

}  // namespace
}  // namespace hydrotin
