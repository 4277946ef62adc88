#include "hydrotin/river_statistics.h"

#include <algorithm>
#include <cmath>

#include "exact_edges.h"
#include "hydrotin/pits.h"
#include "hydrotin/vertex_graph.h"
#include "terrain_links.h"

namespace hydrotin {
namespace {

using Plane = std::array<double, 2>;

Plane operator-(const Plane& a, const Plane& b) {
  return {a[0] - b[0], a[1] - b[1]};
}
double cross(const Plane& a, const Plane& b) {
  return a[0] * b[1] - a[1] * b[0];
}
double dot(const Plane& a, const Plane& b) {
  return a[0] * b[0] + a[1] * b[1];
}

bool is_below(const RiverTerrain& terrain, std::span<const double> height, const RiverEdge& edge, std::uint32_t w,
              double tolerance) {
  const Plane &a = terrain.position[edge.from], &b = terrain.position[edge.to], &c = terrain.position[w];
  if (tolerance == 0) return valley_sign(a, b, c, height[edge.from], height[edge.to], height[w]) < 0;
  const Plane along = b - a;
  const double t = dot(c - a, along) / dot(along, along), scale = std::max({1.0, std::abs(t), std::abs(1 - t)});
  return height[w] - height[edge.from] - t * (height[edge.to] - height[edge.from]) < -tolerance * scale;
}

// The steepest way down from the vertex of a corner over its triangle; negative where all ways rise.
double steepest_descent(const RiverTerrain& terrain, std::span<const double> height, std::uint32_t corner) {
  const std::uint32_t v = terrain.triangle[corner];
  const auto [u, w] = opposite(terrain, corner);
  const Plane a = terrain.position[u] - terrain.position[v], b = terrain.position[w] - terrain.position[v];
  const double hu = height[u] - height[v], hw = height[w] - height[v], area = cross(a, b);
  const Plane descent = {-(hu * b[1] - hw * a[1]) / area, -(a[0] * hw - b[0] * hu) / area};
  if (cross(descent, b) / area > 0 && cross(a, descent) / area > 0) return std::hypot(descent[0], descent[1]);
  return std::max(-hu / std::hypot(a[0], a[1]), -hw / std::hypot(b[0], b[1]));
}

double steepest_way(const RiverTerrain& terrain, const TerrainLinks& links, std::span<const double> height,
                    std::uint32_t v) {
  double most = -HUGE_VAL;
  for (const std::uint32_t corner : links.corners(v)) most = std::max(most, steepest_descent(terrain, height, corner));
  return most;
}

std::vector<std::uint32_t> find_leaks(const RiverTerrain& terrain, const TerrainLinks& links,
                                      std::span<const RiverEdge> rivers, std::span<const double> height,
                                      double tolerance) {
  std::vector<std::uint32_t> sources;
  std::vector<double> steepest(terrain.num_vertices(), -HUGE_VAL), shortest(terrain.num_vertices(), HUGE_VAL);
  for (const auto& [from, to] : rivers) {
    const Plane along = terrain.position[to] - terrain.position[from];
    const double length = std::hypot(along[0], along[1]);
    sources.push_back(from);
    steepest[from] = std::max(steepest[from], (height[from] - height[to]) / length);
    shortest[from] = std::min(shortest[from], length);
  }
  std::sort(sources.begin(), sources.end());
  sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
  std::vector<std::uint32_t> leaks;
  for (const std::uint32_t v : sources)
    if (is_leak(steepest_way(terrain, links, height, v), steepest[v], shortest[v], tolerance)) leaks.push_back(v);
  return leaks;
}

std::uint64_t count_minima(const RiverTerrain& terrain, std::span<const double> height, double tolerance) {
  const VertexGraph graph = make_vertex_graph(terrain.num_vertices(), terrain.triangle);
  // Heights that differ by less than the tolerance count as one level.
  std::vector<std::uint32_t> order(height.size());
  for (std::uint32_t v = 0; v < order.size(); ++v) order[v] = v;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return height[a] < height[b]; });
  std::vector<std::int32_t> level(height.size(), 0);
  for (std::size_t i = 1; i < order.size(); ++i)
    level[order[i]] = level[order[i - 1]] + (height[order[i]] - height[order[i - 1]] > tolerance ? 1 : 0);
  std::vector<std::uint8_t> is_outlet(height.size(), 0);
  for (std::uint32_t v = 0; v < is_outlet.size(); ++v) is_outlet[v] = graph.neighbors(v).empty() ? 1 : 0;
  return count_pits(graph, level, is_outlet);
}

}  // namespace

std::vector<double> steepest_ways(const RiverTerrain& terrain, std::span<const double> height,
                                  std::span<const std::uint32_t> vertices) {
  const TerrainLinks links = link_terrain(terrain);
  std::vector<double> out;
  for (const std::uint32_t v : vertices) out.push_back(steepest_way(terrain, links, height, v));
  return out;
}

bool is_leak(double steepest_way, double steepest_river, double shortest, double tolerance) {
  const double slack = (tolerance > 0 ? tolerance : 1e-9) / shortest + 1e-9 * std::abs(steepest_river);
  return steepest_way > 0 && steepest_way > steepest_river + slack;
}

RiverFaults river_faults(const RiverTerrain& terrain, std::span<const RiverEdge> rivers, std::span<const double> height,
                         double tolerance) {
  const TerrainLinks links = link_terrain(terrain);
  RiverFaults faults;
  for (const RiverEdge& edge : rivers) {
    const double drop = height[edge.from] - height[edge.to];
    faults.wrong_flow.push_back(drop < -tolerance ? 1 : 0);
    faults.flat.push_back(std::abs(drop) <= tolerance ? 1 : 0);
    const Wingtips tips = wingtips(terrain, links, edge.from, edge.to);
    bool is_valley = true;
    for (int i = 0; i < tips.count; ++i)
      if (is_below(terrain, height, edge, tips.vertex[i], tolerance)) is_valley = false;
    faults.not_valley.push_back(is_valley ? 0 : 1);
  }
  faults.leak_vertex = find_leaks(terrain, links, rivers, height, tolerance);
  return faults;
}

RiverStatistics river_statistics(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                 std::span<const double> height, double tolerance) {
  const RiverFaults faults = river_faults(terrain, rivers, height, tolerance);
  const auto count = [](const std::vector<std::uint8_t>& flags) {
    return static_cast<std::uint64_t>(std::count(flags.begin(), flags.end(), 1));
  };
  RiverStatistics statistics;
  statistics.wrong_flow = count(faults.wrong_flow);
  statistics.not_valley = count(faults.not_valley);
  statistics.flat_edges = count(faults.flat);
  statistics.leak_vertices = faults.leak_vertex.size();
  statistics.local_minima = count_minima(terrain, height, tolerance);
  return statistics;
}

HeightChange height_change(std::span<const double> before, std::span<const double> after, double tolerance) {
  HeightChange change;
  for (std::size_t v = 0; v < before.size(); ++v) {
    const double moved = std::abs(after[v] - before[v]);
    if (!(moved > tolerance)) continue;
    ++change.moved;
    change.total += moved;
    change.largest = std::max(change.largest, moved);
  }
  if (change.moved > 0) change.average = change.total / static_cast<double>(change.moved);
  return change;
}

}  // namespace hydrotin
