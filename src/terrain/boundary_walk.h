#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/vertex_graph.h"
#include "hydrotin/wide.h"

namespace hydrotin {

struct Direction {
  std::int64_t x, y;
};

inline Wide cross(Direction a, Direction b) {
  return Wide{a.x} * b.y - Wide{a.y} * b.x;
}

/// The order of directions met when turning counter-clockwise from `from`, which itself comes last.
struct CounterClockwiseFrom {
  Direction from;

  [[nodiscard]] int half(Direction d) const {
    const Wide side = cross(from, d);
    if (side != 0) return side > 0 ? 0 : 2;
    return Wide{from.x} * d.x + Wide{from.y} * d.y < 0 ? 1 : 3;
  }
  bool operator()(Direction a, Direction b) const {
    const int p = half(a), q = half(b);
    return p != q ? p < q : cross(a, b) > 0;
  }
};

/// For each boundary edge (ascending) the next one of its walk round the same part of the outside.
inline std::vector<std::uint32_t> next_on_walk(std::span<const DirectedEdge> edge,
                                               std::span<const LatticePoint> position) {
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

}  // namespace hydrotin
