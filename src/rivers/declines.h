#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/river_constraints.h"
#include "hydrotin/river_network.h"

/// The least drops of river edges (T7.1.3: strict decline).

namespace hydrotin {

struct Declines {
  std::vector<double> drop;            ///< [R] in the unit of heights
  std::vector<std::uint32_t> clamped;  ///< networks that rise or are level: no fraction of their slope is a decline
};

/// O(R log R). Edges inside a lake are not left out.
[[nodiscard]] Declines find_declines(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                     const RiverConstraints& constraints);

}  // namespace hydrotin
