#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "part.h"
#include "phases.h"

/// What became of rivers in the final heights of a tile's part: each number so that the parts of all tiles add up to
/// the terrain, whatever the tiling.

namespace hydrotin {

struct RiverState {
  std::vector<RiverEdge> edge;        ///< river edges of the part's triangles; vertices of the part, ascending
  std::vector<RiverEdge> invalid;     ///< of them, in the triangles of this part: by the constraints asked for
  std::vector<RiverEdge> no_valley;   ///< of them, in the triangles of this part: a wingtip is too low
  std::vector<std::uint32_t> source;  ///< vertices with a river edge down, ascending; any part may have the edge
  std::vector<double> steepest;       ///< the steepest way down from each in this part; all parts: the largest counts
  /// Edges whose slope the rivers left within their limit, and pit removal did not.
  std::uint64_t slopes_beyond_limit = 0;
};

/// @param height  [n] final, lattice. Precondition: the context has rivers.
/// Complexity: O(T log R).
[[nodiscard]] RiverState river_state(const RunContext& context, const Part& part, std::span<const std::int32_t> height);

}  // namespace hydrotin
