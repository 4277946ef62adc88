#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <utility>
#include <vector>

#include "grid_terrain.h"
#include "hydrotin/pit_removal.h"
#include "hydrotin/vertex_graph.h"
#include "oracle/terrain_oracle.h"

/// Terrains for tests of pit removal, with what the oracles want to know about them.
namespace hydrotin::testing {

inline constexpr RemovalMethod kMethods[] = {RemovalMethod::lift, RemovalMethod::breach, RemovalMethod::greedy_breach,
                                             RemovalMethod::least_change};
inline constexpr ChangeMeasure kMeasures[] = {ChangeMeasure::total, ChangeMeasure::max, ChangeMeasure::count,
                                              ChangeMeasure::volume};

/// A terrain given by its graph; positions only tell vertices apart.
struct Sample {
  VertexGraph graph;
  std::vector<std::int32_t> height;
  std::vector<LatticePoint> position;
  std::vector<std::uint8_t> is_outlet;
  std::vector<std::int64_t> weight;
  oracle::Neighbors around;

  [[nodiscard]] ChangeableTerrain view(ChangeMeasure measure) const {
    ChangeableTerrain terrain{&graph, height, position, is_outlet, {}, {}, {}};
    if (measure == ChangeMeasure::volume) terrain.weight = weight;
    return terrain;
  }
  [[nodiscard]] Removal remove(RemovalMethod method, ChangeMeasure measure = ChangeMeasure::total,
                               bool thorough = false) const {
    RemovalOptions options;
    options.thorough = thorough;
    options.method = method;
    options.measure = measure;
    options.with_bound = true;
    return remove_pits(view(measure), options);
  }
};

inline Sample sample_of(const GridTerrain& grid, const std::vector<std::uint8_t>& is_outlet) {
  return {make_vertex_graph(grid.num_vertices(), grid.triangle),
          grid.height,
          grid.position,
          is_outlet,
          star_weights(grid.position, grid.triangle),
          oracle::neighbors(grid.num_vertices(), grid.triangle)};
}

inline Sample sample_of(const std::vector<std::int32_t>& height,
                        const std::vector<std::pair<std::uint32_t, std::uint32_t>>& edges,
                        const std::vector<std::uint32_t>& outlets) {
  Sample s;
  s.height = height;
  s.around.resize(height.size());
  for (const auto& [a, b] : edges) {
    s.around[a].insert(b);
    s.around[b].insert(a);
  }
  s.graph.begin.push_back(0);
  for (const auto& list : s.around) {
    s.graph.neighbor.insert(s.graph.neighbor.end(), list.begin(), list.end());
    s.graph.begin.push_back(static_cast<std::uint32_t>(s.graph.neighbor.size()));
  }
  for (std::uint32_t v = 0; v < height.size(); ++v) s.position.push_back({static_cast<std::int32_t>(v), 0});
  s.is_outlet.assign(height.size(), 0);
  for (const std::uint32_t v : outlets) s.is_outlet[v] = 1;
  s.weight.assign(height.size(), 1);
  return s;
}

/// A terrain with its vertices numbered anew.
struct Renumbered {
  GridTerrain grid;
  std::vector<std::uint8_t> is_outlet;
  std::vector<std::uint32_t> number;  ///< of each vertex before
};

inline Renumbered renumber(const GridTerrain& grid, const std::vector<std::uint8_t>& is_outlet, std::uint64_t seed) {
  Renumbered out{grid, is_outlet, std::vector<std::uint32_t>(grid.num_vertices())};
  std::iota(out.number.begin(), out.number.end(), 0u);
  shuffle(seed, out.number);
  for (std::uint32_t v = 0; v < out.number.size(); ++v) {
    out.grid.height[out.number[v]] = grid.height[v];
    out.grid.position[out.number[v]] = grid.position[v];
    out.is_outlet[out.number[v]] = is_outlet[v];
  }
  for (auto& v : out.grid.triangle) v = out.number[v];
  return out;
}

inline std::int64_t cost_of(const Sample& s, const std::vector<std::int32_t>& x, ChangeMeasure measure) {
  std::int64_t cost = 0;
  for (std::size_t v = 0; v < x.size(); ++v) {
    const std::int64_t moved = std::abs(std::int64_t{x[v]} - s.height[v]);
    if (measure == ChangeMeasure::max) cost = std::max(cost, moved);
    if (measure == ChangeMeasure::count) cost += moved != 0;
    if (measure == ChangeMeasure::total) cost += moved;
    if (measure == ChangeMeasure::volume) cost += moved * s.weight[v];
  }
  return cost;
}

}  // namespace hydrotin::testing
