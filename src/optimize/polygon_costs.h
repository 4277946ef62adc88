#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/exact_sum.h"
#include "polygon_graph.h"

/// What a search minimises: a vector of sums over triangles, compared from the first slot on. One slot may count
/// vertices that want a lower neighbour instead.
///
/// Sums are integers (fixed point), so that they do not depend on the order of addition and ties are ties.

namespace hydrotin {

inline constexpr int kMaxSlots = 8;

struct PolygonCosts {
  int num_slots = 1;
  int minima_slot = -1;                   ///< the slot that counts served vertices, as negative gains
  bool counts_foreign = false;            ///< two slots: local minima, then sides that are no Delaunay edges
  std::vector<Wide> cost;                 ///< [triangles * num_slots], or empty where foreign sides are counted
  std::span<const std::uint8_t> foreign;  ///< [triangles] of the graph

  /// What a vertex that wants a lower neighbour is worth if it gets one, by `wants_lower`.
  static constexpr std::array<Wide, 3> kGain{0, 1, Wide{1} << 40};

  [[nodiscard]] Wide of(std::uint32_t triangle, int slot) const {
    if (counts_foreign) return slot == 1 ? foreign[triangle] : 0;
    return cost[std::size_t{triangle} * static_cast<std::size_t>(num_slots) + static_cast<std::size_t>(slot)];
  }
};

/// The value of an answer, slot by slot.
using SlotValues = std::array<Wide, kMaxSlots>;

/// Sums over the triangles of an answer; served vertices are counted from its edges.
[[nodiscard]] SlotValues value_of(const PolygonGraph& graph, const PolygonCosts& costs,
                                  const std::vector<std::uint32_t>& triangles);

/// 1 for each vertex that has a lower neighbour over an edge of `triangles` that is not a side of the polygon.
void mark_served(const PolygonGraph& graph, const std::vector<std::uint32_t>& triangles,
                 std::vector<std::uint8_t>& served);

}  // namespace hydrotin
