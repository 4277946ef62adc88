#include "hydrotin/outlets.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <numeric>
#include <tuple>

namespace hydrotin {
namespace {

__extension__ using Int128 = __int128;

struct Direction {
  std::int64_t x, y;
};

Int128 cross(Direction a, Direction b) {
  return Int128{a.x} * b.y - Int128{a.y} * b.x;
}

/// The order of directions met when turning counter-clockwise from `from`, which itself comes last.
struct CounterClockwiseFrom {
  Direction from;

  [[nodiscard]] int half(Direction d) const {
    const Int128 side = cross(from, d);
    if (side != 0) return side > 0 ? 0 : 2;
    return Int128{from.x} * d.x + Int128{from.y} * d.y < 0 ? 1 : 3;
  }
  bool operator()(Direction a, Direction b) const {
    const int p = half(a), q = half(b);
    return p != q ? p < q : cross(a, b) > 0;
  }
};

std::vector<std::uint32_t> sorted_by_position(std::span<const LatticePoint> position) {
  std::vector<std::uint32_t> order(position.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return position[a] < position[b]; });
  return order;
}

/// For each boundary edge the next one of its walk.
std::vector<std::uint32_t> next_on_walk(const VertexGraph& graph, std::span<const LatticePoint> position) {
  const auto& edge = graph.boundary;
  const auto towards = [&](std::uint32_t from, std::uint32_t to) {
    return Direction{std::int64_t{position[to].x} - position[from].x, std::int64_t{position[to].y} - position[from].y};
  };
  std::vector<std::uint32_t> next(edge.size());
  for (std::uint32_t i = 0; i < edge.size(); ++i) {
    const std::uint32_t v = edge[i].target;
    const auto first = std::lower_bound(edge.begin(), edge.end(), DirectedEdge{v, 0});
    assert(first != edge.end() && first->origin == v && "boundary edges form closed walks");
    const CounterClockwiseFrom before{towards(v, edge[i].origin)};
    auto best = first;
    for (auto e = first; e != edge.end() && e->origin == v; ++e)
      if (before(towards(v, e->target), towards(v, best->target))) best = e;
    next[i] = static_cast<std::uint32_t>(best - edge.begin());
  }
  return next;
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
  const std::vector<std::uint32_t> next = next_on_walk(graph, position);
  std::vector<bool> is_seen(next.size());
  for (std::uint32_t seed = 0; seed < next.size(); ++seed) {
    if (is_seen[seed]) continue;
    Int128 doubled_area = 0;
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

}  // namespace hydrotin
