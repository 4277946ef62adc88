#pragma once

#include <cstdint>

#include "hydrotin/lattice.h"

/// Position of a lattice point on the Hilbert curve of the whole lattice: an order in which neighbours are near each
/// other, the same in every tile. Distinct points have distinct keys.
/// Source  Hilbert 1891; the curve of 32 levels over 2^32 x 2^32 cells.
/// Complexity: O(1), 32 table steps. Threads: pure.

namespace hydrotin {

[[nodiscard]] std::uint64_t hilbert_key(LatticePoint p);

}  // namespace hydrotin
