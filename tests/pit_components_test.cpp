#include "hydrotin/pit_components.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "clouds.h"
#include "grid_terrain.h"
#include "hydrotin/vertex_graph.h"

namespace hydrotin {
namespace {

using testing::GridTerrain;
using testing::Random;

/// Components by definition: sets of positions, so that sets and their members come in the order asked for.
std::set<std::vector<LatticePoint>> components_by_definition(const GridTerrain& grid, const VertexGraph& graph,
                                                             const std::vector<std::uint8_t>& is_member) {
  std::set<std::vector<LatticePoint>> components;
  std::vector<bool> is_seen(is_member.size());
  for (std::uint32_t seed = 0; seed < is_member.size(); ++seed) {
    if (!is_member[seed] || is_seen[seed]) continue;
    std::set<LatticePoint> component;
    std::vector<std::uint32_t> open{seed};
    is_seen[seed] = true;
    while (!open.empty()) {
      const std::uint32_t v = open.back();
      open.pop_back();
      component.insert(grid.position[v]);
      for (const std::uint32_t w : graph.neighbors(v))
        if (is_member[w] && !is_seen[w]) is_seen[w] = true, open.push_back(w);
    }
    components.emplace(component.begin(), component.end());
  }
  return components;
}

// From single members to sets of thousands, also with negative coordinates.
TEST(PitComponents, AreTheConnectedSetsOfMembersByPosition) {
  std::size_t largest = 0;
  for (const std::uint32_t side : {1u, 2u, 7u, 40u, 120u})
    for (const std::uint32_t percent : {0u, 20u, 50u, 70u, 100u}) {
      SCOPED_TRACE(std::to_string(side) + " " + std::to_string(percent));
      Random random(side + percent);
      GridTerrain grid = testing::make_grid(side, side, side, 10, 3);
      for (LatticePoint& p : grid.position) p.x -= 300, p.y -= 500;
      const VertexGraph graph = make_vertex_graph(grid.num_vertices(), grid.triangle);
      grid.height = testing::random_heights(side, grid.num_vertices(), 5);
      std::vector<std::uint8_t> is_member(grid.num_vertices());
      std::vector<std::uint32_t> pits;
      for (std::uint32_t v = 0; v < is_member.size(); ++v) {
        is_member[v] = random.below(100) < percent;
        if (is_member[v] && random.below(3) == 0) pits.push_back(v);
      }
      const std::vector<std::uint8_t> is_outlet(is_member.size(), 0);
      const ChangeableTerrain terrain{&graph, grid.height, grid.position, is_outlet, {}, {}, {}};
      PitComponents found;
      found.member.assign(3, 0);  // what was there before goes
      collect_components(terrain, is_member, pits, found);

      std::vector<std::vector<LatticePoint>> components;
      std::map<LatticePoint, std::size_t> component_of;
      for (std::size_t i = 0; i < found.size(); ++i) {
        auto& component = components.emplace_back();
        for (std::uint32_t j = found.begin[i]; j < found.begin[i + 1]; ++j) {
          component.push_back(grid.position[found.member[j]]);
          component_of[component.back()] = i;
        }
        largest = std::max(largest, component.size());
      }
      const auto expected = components_by_definition(grid, graph, is_member);
      EXPECT_EQ(components, std::vector(expected.begin(), expected.end()));

      const auto key = [&](std::uint32_t v) {
        return std::tuple(component_of[grid.position[v]], grid.height[v], grid.position[v]);
      };
      std::sort(pits.begin(), pits.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
      EXPECT_EQ(found.pit, pits);
      ASSERT_EQ(found.pit_begin.size(), found.size() + 1);
      EXPECT_EQ(found.pit_begin.front(), 0u);
      EXPECT_EQ(found.pit_begin.back(), pits.size());
      for (std::size_t i = 0; i < found.size(); ++i)
        for (std::uint32_t j = found.pit_begin[i]; j < found.pit_begin[i + 1]; ++j)
          EXPECT_EQ(component_of[grid.position[found.pit[j]]], i);
    }
  EXPECT_GT(largest, 10'000u);
}

}  // namespace
}  // namespace hydrotin
