#pragma once

#include <cstdint>

#include "hydrotin/lattice.h"

/// Regions on which decisions rest: discs, or open half planes in their place at the edge of the data. Regions are a
/// little too large rather than too small: all rounding errors are added to the radius.

namespace hydrotin {

struct Region {
  bool is_half_plane = false;
  double x = 0, y = 0, radius = 0;  ///< disc
  LatticePoint from, to;            ///< half plane right of the line from `from` to `to`

  [[nodiscard]] bool is_inside(const LatticeBox& box) const {
    return !is_half_plane && x - radius > box.min.x && x + radius < box.max.x && y - radius > box.min.y &&
           y + radius < box.max.y;
  }
  [[nodiscard]] bool meets(const LatticeBox& box) const;
};

/// The closed disc through three points that are not collinear.
[[nodiscard]] Region disc_through(LatticePoint a, LatticePoint b, LatticePoint c);

[[nodiscard]] Region half_plane_right_of(LatticePoint from, LatticePoint to);

/// Squared distance from a point to a closed box.
[[nodiscard]] double distance2(LatticePoint p, const LatticeBox& box);

}  // namespace hydrotin
