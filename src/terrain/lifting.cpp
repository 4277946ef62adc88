#include "hydrotin/lifting.h"

#include <cassert>
#include <cstddef>
#include <tuple>

#include "flood.h"

namespace hydrotin {
namespace {

template <class SourceLevel>
std::vector<std::int32_t> flood_from(const VertexGraph& graph, std::span<const std::int32_t> height,
                                     SourceLevel source_level) {
  std::vector<std::int32_t> level(height.begin(), height.end());
  Flood flood(graph, level);
  for (std::uint32_t v = 0; v < graph.num_vertices(); ++v) {
    assert(height[v] != kNoLevel && "this height means no level");
    if (const std::int32_t l = source_level(v); l != kNoLevel) flood.add_source(v, l);
  }
  flood.run(NoVisitor());
  return level;
}

}  // namespace

std::vector<std::int32_t> lift(const VertexGraph& graph, std::span<const std::int32_t> height,
                               std::span<const std::uint8_t> is_outlet) {
  assert(height.size() == graph.num_vertices() && is_outlet.size() == height.size() && "one entry per vertex");
  return flood_from(graph, height, [&](std::uint32_t v) { return is_outlet[v] ? height[v] : kNoLevel; });
}

std::vector<std::int32_t> lift_from(const VertexGraph& graph, std::span<const std::int32_t> height,
                                    std::span<const std::uint8_t> is_outlet,
                                    std::span<const std::int32_t> source_level) {
  assert(height.size() == graph.num_vertices() && is_outlet.size() == height.size() && "one entry per vertex");
  assert(source_level.size() == height.size() && "one entry per vertex");
  return flood_from(graph, height, [&](std::uint32_t v) {
    assert(source_level[v] >= height[v] && "a level lies nowhere below its height");
    return is_outlet[v] ? height[v] : source_level[v];
  });
}

std::uint32_t lowest_vertex(std::span<const std::int32_t> height, std::span<const LatticePoint> position) {
  assert(!height.empty() && height.size() == position.size() && "one height and one position per vertex");
  std::uint32_t lowest = 0;
  for (std::uint32_t v = 1; v < height.size(); ++v)
    if (std::tie(height[v], position[v]) < std::tie(height[lowest], position[lowest])) lowest = v;
  return lowest;
}

}  // namespace hydrotin
