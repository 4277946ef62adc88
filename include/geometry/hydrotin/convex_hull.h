#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"

namespace hydrotin {

/// Indices of the strict convex hull, counter-clockwise from the smallest by (x, y); fewer than three if collinear.
/// O(n log n), but most points are discarded in O(n) first. Positions are distinct. Pure.
[[nodiscard]] std::vector<std::uint32_t> convex_hull(std::span<const LatticePoint> position);

}  // namespace hydrotin
