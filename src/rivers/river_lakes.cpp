#include "hydrotin/river_lakes.h"

#include <algorithm>
#include <numeric>

namespace hydrotin {
namespace {

constexpr auto kNone = static_cast<std::uint32_t>(-1);

/// Strongly connected components (Tarjan 1972), without recursion. Returns the component of each node.
std::vector<std::uint32_t> strong_components(const std::vector<std::uint32_t>& begin,
                                             const std::vector<std::uint32_t>& target) {
  const auto n = static_cast<std::uint32_t>(begin.size() - 1);
  std::vector<std::uint32_t> component(n, kNone), index(n, kNone), low(n, 0), next(begin.begin(), begin.end() - 1);
  std::vector<std::uint32_t> stack, path;
  std::uint32_t counter = 0, components = 0;
  for (std::uint32_t root = 0; root < n; ++root) {
    if (index[root] != kNone) continue;
    path.push_back(root);
    while (!path.empty()) {
      const std::uint32_t v = path.back();
      if (index[v] == kNone) {
        index[v] = low[v] = counter++;
        stack.push_back(v);
      }
      bool is_deeper = false;
      while (next[v] < begin[v + 1] && !is_deeper) {
        const std::uint32_t w = target[next[v]];
        if (index[w] == kNone) {
          path.push_back(w);
          is_deeper = true;
          continue;  // w is looked at again when it is done
        }
        if (component[w] == kNone) low[v] = std::min(low[v], low[w]);
        ++next[v];
      }
      if (is_deeper) continue;
      path.pop_back();
      if (low[v] != index[v]) continue;
      while (component[v] == kNone) {
        component[stack.back()] = components;
        stack.pop_back();
      }
      ++components;
    }
  }
  return component;
}

}  // namespace

std::vector<std::uint32_t> lake_numbers(std::uint32_t num_vertices, std::span<const Lake> lakes) {
  std::vector<std::uint32_t> number(num_vertices, 0);
  for (std::size_t i = 0; i < lakes.size(); ++i)
    for (const std::uint32_t v : lakes[i].vertex) number[v] = static_cast<std::uint32_t>(i + 1);
  return number;
}

ClosedLakes close_lakes(const RiverTerrain& terrain, std::span<const RiverEdge> rivers, std::span<const Lake> lakes) {
  // Nodes: the lakes, then the river vertices in none.
  const auto num_lakes = static_cast<std::uint32_t>(lakes.size());
  std::vector<std::uint32_t> node = lake_numbers(terrain.num_vertices(), lakes), vertex;
  for (std::uint32_t& i : node) i = i == 0 ? kNone : i - 1;
  for (const auto& [from, to] : rivers)
    for (const std::uint32_t v : {from, to})
      if (node[v] == kNone) {
        node[v] = num_lakes + static_cast<std::uint32_t>(vertex.size());
        vertex.push_back(v);
      }
  const std::size_t num_nodes = num_lakes + vertex.size();
  std::vector<std::uint32_t> begin(num_nodes + 1, 0), target(rivers.size());
  for (const auto& edge : rivers) ++begin[node[edge.from] + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (const auto& [from, to] : rivers) target[next[node[from]]++] = node[to];
  const auto component = strong_components(begin, target);
  // Rivers alone make no circle, so each component of several nodes has a lake: its first one takes in the others.
  std::vector<std::uint32_t> keeper(num_nodes, kNone);
  ClosedLakes closed;
  closed.lake.assign(lakes.begin(), lakes.end());
  for (std::uint32_t i = 0; i < num_lakes; ++i) {
    std::uint32_t& first = keeper[component[i]];
    if (first == kNone) {
      first = i;
      continue;
    }
    Lake &into = closed.lake[first], &from = closed.lake[i];
    into.vertex.insert(into.vertex.end(), from.vertex.begin(), from.vertex.end());
    if (from.has_level) into.level = into.has_level ? std::min(into.level, from.level) : from.level;
    into.has_level = into.has_level || from.has_level;
    from.vertex.clear();
    ++closed.joined_lakes;
  }
  for (std::uint32_t i = 0; i < vertex.size(); ++i) {
    const std::uint32_t first = keeper[component[num_lakes + i]];
    if (first == kNone) continue;
    closed.lake[first].vertex.push_back(vertex[i]);
    ++closed.joined_vertices;
  }
  std::erase_if(closed.lake, [](const Lake& lake) { return lake.vertex.empty(); });
  const auto by_place = [&](std::uint32_t a, std::uint32_t b) { return terrain.position[a] < terrain.position[b]; };
  for (Lake& lake : closed.lake) std::sort(lake.vertex.begin(), lake.vertex.end(), by_place);
  std::sort(closed.lake.begin(), closed.lake.end(),
            [&](const Lake& a, const Lake& b) { return by_place(a.vertex[0], b.vertex[0]); });
  return closed;
}

}  // namespace hydrotin
