#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "group_parts.h"
#include "tiled_groups.h"

/// What is solved at once: a group, or where that is too large one square of it (group_cut.h), across tiles.
///
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

/// The parts of one tile, and which of them have vertices that other tiles have too.
struct TileParts {
  GroupParts parts;
  std::uint32_t first_piece = 0;         ///< in the joined groups
  std::vector<std::uint64_t> rim_point;  ///< these vertices
  std::vector<std::uint32_t> rim_part;   ///< [rim_point] 4294967295: none
};

struct GroupUnits {
  std::vector<std::vector<std::uint32_t>> unit;  ///< [tiles][parts]
  std::vector<std::uint32_t> owner;              ///< [units] the tile with most of its vertices (ties: the first)
  std::vector<std::uint64_t> size;               ///< [units] vertices; those that tiles share count once
  std::uint64_t num_cut = 0;                     ///< groups that were cut
};

/// Units of a group that is cut ascend with its squares.
/// @param most  members of a group that is not cut. Complexity: O(parts log parts).
[[nodiscard]] GroupUnits units_of(std::span<const TileParts> tiles, const JoinedGroups& groups, const CutGrid& grid,
                                  std::uint64_t most);

}  // namespace hydrotin
