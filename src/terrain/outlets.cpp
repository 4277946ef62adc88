#include "hydrotin/outlets.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdlib>
#include <numeric>
#include <tuple>

#include "boundary_walk.h"
#include "hydrotin/rasterize.h"

namespace hydrotin {
namespace {

std::vector<std::uint32_t> sorted_by_position(std::span<const LatticePoint> position) {
  std::vector<std::uint32_t> order(position.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return position[a] < position[b]; });
  return order;
}

}  // namespace

std::vector<std::uint8_t> hull_outlets(const VertexGraph& graph, std::span<const LatticePoint> position,
                                       VoidOutlets voids) {
  assert(position.size() == graph.num_vertices() && "one entry per vertex");
  std::vector<std::uint8_t> is_outlet(position.size(), 0);
  for (std::uint32_t v = 0; v < graph.num_vertices(); ++v) is_outlet[v] = graph.neighbors(v).empty();
  if (voids == VoidOutlets::draining) {
    for (const DirectedEdge e : graph.boundary) is_outlet[e.origin] = is_outlet[e.target] = 1;
    return is_outlet;
  }
  const std::vector<std::uint32_t> next = next_on_walk(graph.boundary, position);
  std::vector<bool> is_seen(next.size());
  for (std::uint32_t seed = 0; seed < next.size(); ++seed) {
    if (is_seen[seed]) continue;
    Wide doubled_area = 0;
    const LatticePoint origin = position[graph.boundary[seed].origin];
    for (std::uint32_t i = seed; !is_seen[i]; i = next[i]) {
      is_seen[i] = true;
      const LatticePoint a = position[graph.boundary[i].origin], b = position[graph.boundary[i].target];
      doubled_area += cross({std::int64_t{a.x} - origin.x, std::int64_t{a.y} - origin.y},
                            {std::int64_t{b.x} - origin.x, std::int64_t{b.y} - origin.y});
    }
    if (doubled_area <= 0) continue;
    std::uint32_t i = seed;
    do {
      is_outlet[graph.boundary[i].origin] = 1;
      i = next[i];
    } while (i != seed);
  }
  return is_outlet;
}

std::vector<std::uint32_t> pieces_of(const VertexGraph& graph, std::span<const LatticePoint> position) {
  assert(position.size() == graph.num_vertices() && "one entry per vertex");
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> piece(position.size(), kNone), open;
  std::uint32_t num_pieces = 0;
  for (const std::uint32_t seed : sorted_by_position(position)) {
    if (piece[seed] != kNone) continue;
    piece[seed] = num_pieces;
    open.assign(1, seed);
    while (!open.empty()) {
      const std::uint32_t v = open.back();
      open.pop_back();
      for (const std::uint32_t w : graph.neighbors(v)) {
        if (piece[w] != kNone) continue;
        piece[w] = num_pieces;
        open.push_back(w);
      }
    }
    ++num_pieces;
  }
  return piece;
}

std::vector<std::uint8_t> lowest_outlets(const VertexGraph& graph, std::span<const std::int32_t> height,
                                         std::span<const LatticePoint> position) {
  assert(height.size() == position.size() && "one entry per vertex");
  const std::vector<std::uint32_t> piece = pieces_of(graph, position);
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> lowest;
  for (std::uint32_t v = 0; v < piece.size(); ++v) {
    if (piece[v] >= lowest.size()) lowest.resize(std::size_t{piece[v]} + 1, kNone);
    std::uint32_t& best = lowest[piece[v]];
    if (best == kNone || std::tie(height[v], position[v]) < std::tie(height[best], position[best])) best = v;
  }
  std::vector<std::uint8_t> is_outlet(height.size(), 0);
  for (const std::uint32_t v : lowest) is_outlet[v] = 1;
  return is_outlet;
}

std::vector<std::uint32_t> pieces_without_outlet(const VertexGraph& graph, std::span<const LatticePoint> position,
                                                 std::span<const std::uint8_t> is_outlet) {
  assert(is_outlet.size() == position.size() && "one entry per vertex");
  const std::vector<std::uint32_t> piece = pieces_of(graph, position);
  std::vector<std::uint8_t> drains;
  std::vector<std::uint32_t> smallest;
  for (std::uint32_t v = 0; v < piece.size(); ++v) {
    if (piece[v] >= smallest.size()) {
      smallest.resize(std::size_t{piece[v]} + 1, 0xffffffffu);
      drains.resize(smallest.size(), 0);
    }
    std::uint32_t& best = smallest[piece[v]];
    if (best == 0xffffffffu || position[v] < position[best]) best = v;
    drains[piece[v]] |= is_outlet[v];
  }
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < smallest.size(); ++i)
    if (!drains[i]) result.push_back(smallest[i]);
  return result;
}

void mark_void_corners(std::span<const LatticePoint> position, std::span<const std::uint32_t> triangle_vertex,
                       std::uint64_t max_squared_edge, std::span<std::uint8_t> is_outlet) {
  for (std::size_t t = 0; t < triangle_vertex.size(); t += 3)
    for (std::size_t i = 0; i < 3; ++i) {
      const LatticePoint a = position[triangle_vertex[t + i]], b = position[triangle_vertex[t + (i + 1) % 3]];
      const auto dx = static_cast<std::uint64_t>(std::abs(std::int64_t{a.x} - b.x));
      const auto dy = static_cast<std::uint64_t>(std::abs(std::int64_t{a.y} - b.y));
      const bool is_long =
          std::max(dx, dy) >> 31 ? max_squared_edge != kNoEdgeLimit : dx * dx + dy * dy > max_squared_edge;
      for (std::size_t j = 0; is_long && j < 3; ++j) is_outlet[triangle_vertex[t + j]] = 1;
    }
}

}  // namespace hydrotin
