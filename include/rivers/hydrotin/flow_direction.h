#pragma once

#include <cstdint>
#include <vector>

#include "hydrotin/line_walk.h"
#include "hydrotin/river_lines.h"

/// Which way the water of river lines runs: each connected network votes against the terrain.
///
/// Files are drawn downstream or upstream as a whole, so one vote turns a network or leaves it: the sum over its lines
/// of the drop from first to last point inside the terrain. Where it is negative, the lines were drawn upstream.
///
/// Source   FINDINGS D6. Properties
///   (1) A network and the same network with all lines turned round end with the same directions, unless the vote is 0.
///   (2) Sums are taken in (x, y) order: the order of the lines does not matter.
/// Threads  Pure.

namespace hydrotin {

struct FlowVote {
  std::vector<std::uint8_t> is_turned;   ///< [L] the line has to be turned round to run downstream
  std::vector<double> drop;              ///< [L] along the line in the direction chosen, by the terrain; 0 outside it
  std::vector<std::uint32_t> disagrees;  ///< lines that rise in the direction chosen
  std::uint32_t num_networks = 0, num_turned = 0;  ///< networks
};

/// Complexity: O(P log P + L log T).
[[nodiscard]] FlowVote vote_on_flow(const TerrainLocator& locator, const RiverLines& lines);

/// The drop of each line from its first to its last point inside the terrain; 0 with fewer than two such points.
[[nodiscard]] std::vector<double> drops_along(const TerrainLocator& locator, const RiverLines& lines);

/// The height of the terrain at a place.
[[nodiscard]] double height_at(const LatticeTerrain& terrain, Place place, LatticePoint p);

}  // namespace hydrotin
