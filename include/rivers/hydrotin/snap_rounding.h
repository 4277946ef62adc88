#pragma once

#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/river_lines.h"

/// Lines that meet only in lattice points, near to lines that may cross anywhere.
///
/// Rounding a crossing to the lattice bends both lines, and bent lines may cross others that the straight ones did not.
/// Snap rounding is safe: the unit square around every end and around every crossing, rounded, is hot; each segment
/// goes through the middles of all hot squares that it meets. Then no two segments cross but in common ends, and none
/// has moved by more than half a unit in x and in y.
///
/// Source   Hobby, "Practical segment intersection with finite precision output", 1999; Guibas and Marimont 1998.
/// Symbols  S = segments, X = crossings.
/// Properties
///   (1) No two segments of the result cross properly.
///   (2) A square is closed to the west and south and open to the east and north, so that each point is in one.
///   (3) The result depends on the set of segments only; a segment turned round gives the same points, turned round.
///   (4) Lines that do not cross and pass through no hot square stay as they are.
/// Threads  Pure.

namespace hydrotin {

struct RoundedLines {
  RiverLines lines;                 ///< one for each line, no consecutive points equal; lines that shrink to a point go
  std::uint64_t num_crossings = 0;  ///< proper ones, each pair of segments once
  std::uint64_t num_bent = 0;       ///< points added inside segments
};

/// @param extra  points that are hot as well: vertices that are there.
/// Complexity: O((S + X) log S) where boxes of segments do not overlap much.
[[nodiscard]] RoundedLines snap_round(const RiverLines& lines, std::span<const LatticePoint> extra);

}  // namespace hydrotin
