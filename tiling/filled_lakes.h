#pragma once

#include <cstdint>
#include <vector>

#include "edits_file.h"
#include "phases.h"
#include "surface.h"

/// Lakes with more vertices than `pits.largest_lake`: they are raised before anything else is decided, and for the rest
/// of pit removal they are outlets of that height (see PitComponents::filled).

namespace hydrotin {

/// Raises the vertices that the tile has of such lakes to their levels, as `lakes` found them.
///
/// @param surface  of the tile; heights and outlets are changed.
/// @param figures  what was changed is added; of vertices that tiles share, the one that `rank` names counts them, and
///                 each the volume of its own triangles.
/// @return         [n] nonzero at these vertices.
/// Fails: Error(storage) naming the file.
[[nodiscard]] std::vector<std::uint8_t> fill_largest_lakes(const RunContext& context, std::uint32_t tile,
                                                           Surface& surface, ChangeFigures& figures);

}  // namespace hydrotin
