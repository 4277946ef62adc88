#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/river_constraints.h"

/// Lakes that rivers can flow through.
///
/// A lake is level. Where a river leaves a lake and comes back to it, all vertices in between must be at its level:
/// they join it. Where water can get from one lake to another and back, both are one. (Lines drawn along a shore do so
/// again and again.) Afterwards the rivers together with the lakes, each as one vertex, have no directed cycle.
///
/// Source   thesis, Section 7.1.2, elevation of lakes. Symbols  n = vertices, R = river edges.
/// Properties
///   (1) No vertex is in two lakes; the lakes are ascending by their smallest vertex in (x, y) order.
///   (2) A lake is given its level by the lakes that became it: the lowest of their levels.
/// Threads  Pure.

namespace hydrotin {

struct ClosedLakes {
  std::vector<Lake> lake;
  std::uint64_t joined_vertices = 0;  ///< of rivers
  std::uint64_t joined_lakes = 0;     ///< that became part of others
};

/// Complexity: O(n + R). Precondition: the rivers alone have no directed cycle, no vertex is in two lakes.
[[nodiscard]] ClosedLakes close_lakes(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                      std::span<const Lake> lakes);

/// [n] 0 = in no lake, otherwise the index of its lake plus one.
[[nodiscard]] std::vector<std::uint32_t> lake_numbers(std::uint32_t num_vertices, std::span<const Lake> lakes);

}  // namespace hydrotin
