#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/river_network.h"

/// What river edges must satisfy in the end, decided on lattice heights in exact arithmetic.
///
/// A river edge is valid if water does not climb along it and no triangle at it falls below its line. Each triangle
/// decides for itself, so files can be looked at one by one: an edge is valid if it is in all of them.

namespace hydrotin {

/// @param river     edges of the triangles
/// @param triangle  [3T] vertices of position and height
/// Complexity: O(T + R log R). Returns the edges that are not valid, ascending.
[[nodiscard]] std::vector<RiverEdge> invalid_river_edges(std::span<const LatticePoint> position,
                                                         std::span<const std::int32_t> height,
                                                         std::span<const std::uint32_t> triangle,
                                                         std::vector<RiverEdge> river, bool flow, bool valley);

}  // namespace hydrotin
