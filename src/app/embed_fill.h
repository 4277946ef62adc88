#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "embed_input.h"

namespace hydrotin::app {

/// What removing the pits of an embedded terrain did.
struct RiverFill {
  std::vector<double> height;                     ///< [n]
  std::uint64_t pits_before = 0, pits_after = 0;  ///< by the outlets of the input
  std::uint64_t moved = 0, river_vertices_moved = 0;
  double total = 0, largest = 0;
  std::uint64_t slopes_beyond_limit = 0;  ///< edges whose slope now differs from the old one by more than the limit
};

/// Rivers first, pits last: vertices of rivers and outlet chains stay, wingtips keep what the valleys ask. Where the
/// embedded rivers hold their rows, lifting satisfies both by itself.
/// @param method  lift or least-change.
[[nodiscard]] RiverFill fill_rivers(const std::string& method, const EmbedInput& input,
                                    const RiverConstraints& constraints, const std::vector<double>& embedded,
                                    double tolerance);

}  // namespace hydrotin::app
