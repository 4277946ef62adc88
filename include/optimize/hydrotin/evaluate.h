#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "hydrotin/measure.h"
#include "hydrotin/objective.h"

/// The value of a given triangulation under an objective, from its triangles alone.
///
/// Units    lengths, areas and radii in lattice units; angles in degrees; counts as they are.
/// Source   thesis, Sections 3.1 and 3.2.
/// Complexity: O(n + T log T). Threads: pure.

namespace hydrotin {

/// A triangulation that is judged.
struct Surface {
  std::span<const LatticePoint> position;                   ///< [n]
  std::span<const std::int32_t> height;                     ///< [n] z lattice
  std::span<const std::array<std::uint32_t, 3>> triangles;  ///< [T] counter-clockwise
  double z_per_xy = 1;                                      ///< z lattice unit in x and y lattice units
};

/// 0 for delaunay and for a bottleneck over nothing.
/// Precondition: not an objective that needs reference points, nor min_max_order.
[[nodiscard]] double evaluate(Objective objective, const Surface& surface);

}  // namespace hydrotin
