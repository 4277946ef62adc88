#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hydrotin/lattice.h"

/// One lattice for inputs that may have different scales and offsets.
///
/// Scales and offsets are decimal fractions in practice. The common lattice has as unit the greatest one of which every
/// scale and every difference of offsets is a multiple, so that every point of every file is a point of the lattice
/// exactly. x and y share the unit.

namespace hydrotin {

struct FileLattice {
  std::string path;
  std::array<double, 3> scale, offset, min, max;
};

/// lattice = integer * factor + shift, per axis, before the 32-bit range is checked.
struct LatticeMap {
  std::array<std::int64_t, 3> factor{1, 1, 1}, shift{0, 0, 0};
};

struct CommonLattice {
  Lattice lattice;
  std::vector<LatticeMap> map;  ///< of each file
};

/// Independent of the order of the files, apart from the order of `map`.
/// Fails: Error(input) naming the files if no common lattice of at most 32 bits per axis exists.
[[nodiscard]] CommonLattice common_lattice(std::span<const FileLattice> files);

}  // namespace hydrotin
