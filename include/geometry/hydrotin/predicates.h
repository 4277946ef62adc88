#pragma once

#include <cstdint>

#include "hydrotin/lattice.h"
#include "hydrotin/wide.h"

/// Exact predicates on the lattice, with the tie rule.
///
/// Source   in-circle: Guibas and Stolfi 1985; ties: Devillers and Teillaud, "Perturbations for Delaunay and weighted
///          Delaunay 3D triangulations", 2011: points are lifted by infinitesimals that grow in (x, y) order, so that
///          of cocircular points the largest is the first to fall outside. The same rule as in CGAL.
/// Properties
///   (1) `orientation` changes sign when two arguments are exchanged.
///   (2) `in_circle` of a counter-clockwise triangle does not depend on which vertex comes first.
///   (3) For four distinct points `in_circle` always decides, and moving all points by one vector changes nothing.
/// Exact for every pair of 32-bit coordinates. Complexity: O(1). Threads: pure.

namespace hydrotin {

/// +1: c lies left of the line from a to b; -1: right of it; 0: on it.
[[nodiscard]] inline int orientation(LatticePoint a, LatticePoint b, LatticePoint c) {
  const std::int64_t bx = std::int64_t{b.x} - a.x, by = std::int64_t{b.y} - a.y;
  const std::int64_t cx = std::int64_t{c.x} - a.x, cy = std::int64_t{c.y} - a.y;
  const Wide left = static_cast<Wide>(bx) * cy, right = static_cast<Wide>(by) * cx;
  return left > right ? 1 : left < right ? -1 : 0;
}

/// Whether d lies inside the circle through a, b, c, with ties broken by the perturbation.
/// Preconditions: a, b, c counter-clockwise, d different from each of them.
[[nodiscard]] bool in_circle(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d);

/// The sign of the in-circle determinant without perturbation: +1 inside, 0 on the circle, -1 outside.
[[nodiscard]] int in_circle_sign(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d);

/// Whether the open segments ab and cd cross in one point interior to both.
[[nodiscard]] inline bool properly_cross(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d) {
  return orientation(a, b, c) * orientation(a, b, d) < 0 && orientation(c, d, a) * orientation(c, d, b) < 0;
}

}  // namespace hydrotin
