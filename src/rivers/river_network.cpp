#include "hydrotin/river_network.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "terrain_links.h"

namespace hydrotin {
namespace {

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

// Removes edges whose origin no other edge reaches, until only cycles and what lies below them are left.
std::vector<std::uint8_t> peel(std::uint32_t num_vertices, std::span<const RiverEdge> rivers,
                               const std::vector<std::uint32_t>& begin, const std::vector<std::uint32_t>& out) {
  std::vector<std::uint32_t> inflows(num_vertices, 0), open;
  for (const auto& edge : rivers) ++inflows[edge.to];
  for (std::uint32_t v = 0; v < num_vertices; ++v)
    if (inflows[v] == 0 && begin[v] < begin[v + 1]) open.push_back(v);
  std::vector<std::uint8_t> is_left(rivers.size(), 1);
  while (!open.empty()) {
    const std::uint32_t v = open.back();
    open.pop_back();
    for (std::uint32_t i = begin[v]; i < begin[v + 1]; ++i) {
      is_left[out[i]] = 0;
      if (--inflows[rivers[out[i]].to] == 0) open.push_back(rivers[out[i]].to);
    }
  }
  return is_left;
}

// Walks upstream along edges that are left: each vertex with such an edge below it has one above it.
std::vector<std::uint32_t> find_cycle(std::uint32_t num_vertices, std::span<const RiverEdge> rivers,
                                      const std::vector<std::uint8_t>& is_left) {
  constexpr auto kNone = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> above(num_vertices, kNone);
  std::uint32_t first = kNone;
  for (std::uint32_t e = 0; e < rivers.size(); ++e) {
    if (is_left[e] == 0) continue;
    above[rivers[e].to] = std::min(above[rivers[e].to], e);
    first = std::min(first, e);
  }
  if (first == kNone) return {};
  std::vector<std::uint8_t> is_visited(num_vertices, 0);
  std::uint32_t v = rivers[first].from;
  while (is_visited[v] == 0) {
    is_visited[v] = 1;
    v = rivers[above[v]].from;
  }
  std::vector<std::uint32_t> cycle;
  for (std::uint32_t w = v; cycle.empty() || w != v; w = rivers[cycle.back()].from) cycle.push_back(above[w]);
  std::reverse(cycle.begin(), cycle.end());
  return cycle;
}

}  // namespace

NetworkCheck check_network(const RiverTerrain& terrain, std::span<const RiverEdge> rivers) {
  const std::uint32_t n = terrain.num_vertices();
  for (std::uint32_t e = 0; e < rivers.size(); ++e)
    if (rivers[e].from >= n || rivers[e].to >= n || rivers[e].from == rivers[e].to)
      return {NetworkFault::no_vertex, {e}};
  const TerrainLinks links = link_terrain(terrain);
  for (std::uint32_t e = 0; e < rivers.size(); ++e)
    if (wingtips(terrain, links, rivers[e].from, rivers[e].to).count == 0) return {NetworkFault::no_edge, {e}};
  std::vector<std::uint32_t> order(rivers.size()), begin(std::size_t{n} + 1, 0);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return std::pair(rivers[a], a) < std::pair(rivers[b], b); });
  for (std::size_t i = 1; i < order.size(); ++i)
    if (rivers[order[i]] == rivers[order[i - 1]]) return {NetworkFault::repeated, {order[i - 1], order[i]}};
  for (const auto& edge : rivers) ++begin[edge.from + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  auto cycle = find_cycle(n, rivers, peel(n, rivers, begin, order));
  if (!cycle.empty()) return {NetworkFault::directed_cycle, std::move(cycle)};
  return {};
}

RiverNetworks connect_networks(const RiverTerrain& terrain, std::span<const RiverEdge> rivers) {
  std::vector<std::uint32_t> parent(terrain.num_vertices());
  std::iota(parent.begin(), parent.end(), 0u);
  for (const auto& edge : rivers) {
    std::uint32_t a = find_root(parent, edge.from), b = find_root(parent, edge.to);
    if (a == b) continue;
    if (terrain.position[b] < terrain.position[a]) std::swap(a, b);
    parent[b] = a;  // the root is the smallest vertex in (x, y) order
  }
  RiverNetworks networks;
  std::vector<std::uint32_t> roots, order(rivers.size());
  for (const auto& edge : rivers) networks.network.push_back(find_root(parent, edge.from));
  roots = networks.network;
  const auto by_place = [&](std::uint32_t a, std::uint32_t b) { return terrain.position[a] < terrain.position[b]; };
  std::sort(roots.begin(), roots.end(), by_place);
  roots.erase(std::unique(roots.begin(), roots.end()), roots.end());
  networks.num_networks = static_cast<std::uint32_t>(roots.size());
  for (auto& network : networks.network)
    network =
        static_cast<std::uint32_t>(std::lower_bound(roots.begin(), roots.end(), network, by_place) - roots.begin());
  networks.length.assign(roots.size(), 0);
  networks.drop.assign(roots.size(), 0);
  // Sums in (x, y) order: the last bit must not depend on the order of the input.
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(terrain.position[rivers[a].from], terrain.position[rivers[a].to]) <
           std::pair(terrain.position[rivers[b].from], terrain.position[rivers[b].to]);
  });
  for (const std::uint32_t e : order) {
    const auto &p = terrain.position[rivers[e].from], &q = terrain.position[rivers[e].to];
    networks.length[networks.network[e]] += std::hypot(q[0] - p[0], q[1] - p[1]);
    networks.drop[networks.network[e]] += terrain.height[rivers[e].from] - terrain.height[rivers[e].to];
  }
  return networks;
}

}  // namespace hydrotin
