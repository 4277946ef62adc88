#include <gtest/gtest.h>

#include <map>
#include <set>

#include "hydrotin/line_snapping.h"
#include "hydrotin/network_cleaning.h"
#include "hydrotin/river_embedding.h"
#include "hydrotin/river_mouths.h"
#include "line_terrains.h"

// Chains and heights found on parts of a terrain that grow where they have to are those of the whole terrain.

namespace hydrotin {
namespace {

using Plane = std::array<double, 2>;

/// All triangles at some vertices of a terrain, with numbers of their own.
struct Window {
  std::vector<Plane> position;
  std::vector<double> height;
  std::vector<std::uint32_t> triangle;
  std::vector<std::uint8_t> is_complete, outlet;
  std::vector<std::uint32_t> global;
  std::map<std::uint32_t, std::uint32_t> local;

  Window(const RiverTerrain& whole, std::span<const std::uint8_t> is_outlet, const std::set<std::uint32_t>& inside) {
    const auto number = [&](std::uint32_t v) {
      const auto [at, is_new] = local.emplace(v, static_cast<std::uint32_t>(global.size()));
      if (is_new) {
        global.push_back(v);
        position.push_back(whole.position[v]);
        height.push_back(whole.height[v]);
        is_complete.push_back(inside.contains(v));
        outlet.push_back(is_outlet[v]);
      }
      return at->second;
    };
    for (std::size_t t = whole.triangle.size(); t >= 3; t -= 3) {  // backwards: other numbers
      const std::uint32_t* v = whole.triangle.data() + t - 3;
      if (!inside.contains(v[0]) && !inside.contains(v[1]) && !inside.contains(v[2])) continue;
      for (int i = 0; i < 3; ++i) triangle.push_back(number(v[i]));
    }
  }
  [[nodiscard]] RiverTerrain view() const { return {position, height, triangle}; }
  [[nodiscard]] std::vector<RiverEdge> inward(const std::vector<RiverEdge>& edges) const {
    std::vector<RiverEdge> result;
    for (const auto& [from, to] : edges) result.push_back({local.at(from), local.at(to)});
    return result;
  }
  [[nodiscard]] std::vector<RiverEdge> outward(const std::vector<RiverEdge>& edges) const {
    std::vector<RiverEdge> result;
    for (const auto& [from, to] : edges) result.push_back({global[from], global[to]});
    return result;
  }
};

struct Case {
  LatticeTerrain terrain;
  std::vector<Plane> place;
  std::vector<RiverEdge> rivers;
  std::vector<std::uint8_t> outlet;
  [[nodiscard]] RiverTerrain view() const { return {place, terrain.height, terrain.triangle}; }
};

Case random_case(std::uint32_t seed) {
  Case c{testing::lattice_terrain(seed, 60 + seed % 240, 100, seed % 3 == 0, false), {}, {}, {}};
  for (const LatticePoint p : c.terrain.position) c.place.push_back({p.x / 4.0, p.y / 4.0});
  if (c.terrain.triangle.empty()) return c;
  const TerrainLocator locator(c.terrain);
  const RiverLines lines = testing::random_lines(c.terrain, seed, 4, 40, {20, 20});
  const RiverLines reaches = split_at_nodes(without_repeats(lines));
  c.rivers = clean_network(c.terrain.position, c.terrain.height, snap_lines(locator, reaches).paths).edge;
  c.outlet.assign(c.terrain.num_vertices(), 0);
  for (std::uint32_t v = seed % 7; v < c.outlet.size(); v += 23) c.outlet[v] = 1;
  return c;
}

std::set<std::uint32_t> ends_of(const std::vector<RiverEdge>& edges) {
  std::set<std::uint32_t> ends;
  for (const auto& [from, to] : edges) ends.insert({from, to});
  return ends;
}

TEST(RiverWindow, ChainsAreThoseOfTheWholeTerrain) {
  std::size_t chains = 0, grown = 0, smaller = 0;
  for (std::uint32_t seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    const Case c = random_case(seed);
    if (c.rivers.empty()) continue;
    const OutletChains whole = find_outlet_chains(c.view(), c.rivers, c.outlet, {});
    EXPECT_TRUE(whole.incomplete.empty());
    std::set<std::uint32_t> inside = ends_of(c.rivers);
    while (true) {
      const Window window(c.view(), c.outlet, inside);
      const OutletChains part =
          find_outlet_chains(window.view(), window.inward(c.rivers), window.outlet, {}, window.is_complete);
      for (const std::uint32_t v : part.incomplete) EXPECT_TRUE(inside.insert(window.global[v]).second);
      if (!part.incomplete.empty()) {
        ++grown;
        continue;
      }
      EXPECT_EQ(window.outward(part.edge), whole.edge);
      ASSERT_EQ(part.mouth.size(), whole.mouth.size());
      for (std::size_t i = 0; i < part.mouth.size(); ++i) {
        EXPECT_EQ(window.global[part.mouth[i].vertex], whole.mouth[i].vertex);
        EXPECT_EQ(part.mouth[i].kind, whole.mouth[i].kind);
        EXPECT_EQ(part.mouth[i].climb, whole.mouth[i].climb);
      }
      chains += whole.edge.size();
      smaller += window.global.size() < c.place.size();
      break;
    }
  }
  EXPECT_GT(chains, 200u);
  EXPECT_GT(grown, 100u);
  EXPECT_GT(smaller, 50u);
}

TEST(RiverWindow, HeightsAreThoseOfTheWholeTerrain) {
  std::size_t moved = 0, grown = 0, smaller = 0;
  for (std::uint32_t seed = 0; seed < 150; ++seed) {
    const Case c = random_case(seed);
    if (c.rivers.empty()) continue;
    for (const int variant : {0, 1, 2}) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << " variant " << variant);
      EmbeddingOptions options;
      options.quantum = 0.01;
      options.constraints.decline_measure = variant == 0 ? DeclineMeasure::fraction : DeclineMeasure::slope;
      options.constraints.decline = variant == 0 ? 0.1 : 0.02;
      options.constraints.contiguity = variant == 2 ? Contiguity::imaginary_points : Contiguity::none;
      const Embedding whole = embed_rivers(c.view(), c.rivers, options);
      EXPECT_TRUE(whole.incomplete.empty());
      std::set<std::uint32_t> inside = ends_of(c.rivers);
      while (true) {
        const Window window(c.view(), c.outlet, inside);
        options.is_complete = window.is_complete;
        const Embedding part = embed_rivers(window.view(), window.inward(c.rivers), options);
        for (const std::uint32_t v : part.incomplete) EXPECT_TRUE(inside.insert(window.global[v]).second);
        if (!part.incomplete.empty()) {
          ++grown;
          continue;
        }
        for (std::uint32_t v = 0; v < c.place.size(); ++v) {
          const auto at = window.local.find(v);
          const double h = at == window.local.end() ? c.terrain.height[v] : part.height[at->second];
          ASSERT_EQ(h, whole.height[v]) << v;
        }
        EXPECT_EQ(part.objective, whole.objective);
        EXPECT_EQ(part.rows, whole.rows);
        EXPECT_EQ(part.touched.size(), whole.touched.size());
        for (const std::uint32_t v : part.touched)
          EXPECT_TRUE(std::binary_search(whole.touched.begin(), whole.touched.end(), window.global[v]));
        moved += whole.touched.size();
        smaller += window.global.size() < c.place.size();
        break;
      }
    }
  }
  EXPECT_GT(moved, 2000u);
  EXPECT_GT(grown, 100u);
  EXPECT_GT(smaller, 50u);
}

}  // namespace
}  // namespace hydrotin
