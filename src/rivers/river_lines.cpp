#include "hydrotin/river_lines.h"

#include <algorithm>
#include <numeric>

namespace hydrotin {
namespace {

std::vector<LatticePoint> sorted_nodes(const RiverLines& lines) {
  std::vector<LatticePoint> nodes;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    nodes.push_back(lines.line(i).front());
    nodes.push_back(lines.line(i).back());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

std::uint32_t find_root(std::vector<std::uint32_t>& parent, std::uint32_t v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

}  // namespace

void RiverLines::add(std::span<const LatticePoint> chain, std::uint32_t from) {
  point.insert(point.end(), chain.begin(), chain.end());
  begin.push_back(point.size());
  source.push_back(from);
}

RiverLines without_repeats(const RiverLines& lines) {
  RiverLines clean;
  std::vector<LatticePoint> chain;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto line = lines.line(i);
    chain.assign(line.begin(), line.end());
    chain.erase(std::unique(chain.begin(), chain.end()), chain.end());
    if (chain.size() > 1) clean.add(chain, lines.source[i]);
  }
  return clean;
}

RiverLines split_at_nodes(const RiverLines& lines) {
  const auto nodes = sorted_nodes(lines);
  RiverLines reaches;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto line = lines.line(i);
    std::size_t first = 0;
    for (std::size_t k = 1; k < line.size(); ++k) {
      if (k + 1 < line.size() && !std::binary_search(nodes.begin(), nodes.end(), line[k])) continue;
      reaches.add(line.subspan(first, k + 1 - first), lines.source[i]);
      first = k;
    }
  }
  return reaches;
}

LineNetworks connect_lines(const RiverLines& lines) {
  const auto nodes = sorted_nodes(lines);
  std::vector<std::uint32_t> parent(nodes.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto find_node = [&](LatticePoint p) {
    const auto at = std::lower_bound(nodes.begin(), nodes.end(), p);
    return at != nodes.end() && *at == p ? static_cast<std::uint32_t>(at - nodes.begin())
                                         : static_cast<std::uint32_t>(nodes.size());
  };
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::uint32_t root = find_root(parent, find_node(lines.line(i).front()));
    for (const LatticePoint p : lines.line(i)) {
      const std::uint32_t node = find_node(p);
      if (node == nodes.size()) continue;
      const std::uint32_t other = find_root(parent, node);
      parent[std::max(root, other)] = std::min(root, other);  // the smallest node is the root
      root = std::min(root, other);
    }
  }
  LineNetworks networks;
  std::vector<std::uint32_t> number(nodes.size(), 0);
  for (std::uint32_t node = 0; node < nodes.size(); ++node)
    if (parent[node] == node) number[node] = networks.num_networks++;
  for (std::size_t i = 0; i < lines.size(); ++i)
    networks.network.push_back(number[find_root(parent, find_node(lines.line(i).front()))]);
  return networks;
}

RiverLines turned(const RiverLines& lines, std::span<const std::uint8_t> is_turned) {
  RiverLines result = lines;
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (is_turned[i] != 0)
      std::reverse(result.point.begin() + static_cast<std::ptrdiff_t>(lines.begin[i]),
                   result.point.begin() + static_cast<std::ptrdiff_t>(lines.begin[i + 1]));
  return result;
}

}  // namespace hydrotin
