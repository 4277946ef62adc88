#pragma once

#include <cstdint>

#include "phases.h"

/// What rivers will need, before the long work.
///
/// Matching holds all triangles near lines, lakes and preserved edges in memory, at most `kBytesPerRiverTriangle` bytes
/// for each with all that is made of them; the groups of the embedding take parts of the same. So the need follows the
/// length of the lines in mean spacings, not the terrain.

namespace hydrotin {

/// Measured, with all that matching and embedding make of them; windows on the terrain check it again.
inline constexpr std::uint64_t kBytesPerRiverTriangle = 400;

struct RiverNeed {
  std::uint64_t edges = 0;      ///< river edges expected: length of the lines over the mean spacing
  std::uint64_t triangles = 0;  ///< of the first window
  std::uint64_t bytes = 0;
  double seconds = 0;  ///< rough, of one thread
};

/// By the vertices counted, if the context has its outline; by the points expected otherwise (with thinning and filters
/// these are more). Without rivers all is 0. O(points of the lines + cells that they meet).
[[nodiscard]] RiverNeed river_need(const RunContext& context);

/// Fails: Error(resource) if the need is more than the budget, with what can be done.
void require_river_memory(const RunContext& context);

}  // namespace hydrotin
