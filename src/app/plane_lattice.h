#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hydrotin/lattice.h"

namespace hydrotin::app {

/// The lattice on which the points of a TIN lie: (base + integer) / denominator.
///
/// Decimals where the coordinates are decimals (centimetres at least, so that lines fit in between), else binary
/// fractions as fine as fit. Integers stay below 2^29, so that lines far outside still have a place.
struct PlaneLattice {
  std::int64_t base_x = 0, base_y = 0;
  double denominator = 1;
  bool is_exact = true;  ///< the points are on it, but for the last bits that a product with a scale leaves

  [[nodiscard]] std::array<double, 2> coordinates(LatticePoint p) const {
    return {static_cast<double>(base_x + p.x) / denominator, static_cast<double>(base_y + p.y) / denominator};
  }
  /// The nearest point of the lattice. Precondition: |p - base / denominator| < 2^30 / denominator.
  [[nodiscard]] LatticePoint nearest(double x, double y) const;
  /// How far from the middle a line may go, in units of the CRS.
  [[nodiscard]] double reach() const { return 1073741824.0 / denominator; }
};

/// @param refine  a power of ten: so many times finer if that fits.
[[nodiscard]] PlaneLattice find_lattice(std::span<const std::array<double, 2>> position, int refine = 1);

/// The part of a chain inside reach; where it leaves the reach it is cut, so there may be several.
[[nodiscard]] std::vector<std::vector<LatticePoint>> on_lattice(const PlaneLattice& lattice,
                                                                std::span<const std::array<double, 3>> chain);

}  // namespace hydrotin::app
