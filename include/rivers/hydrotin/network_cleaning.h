#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/line_snapping.h"
#include "hydrotin/river_network.h"

/// From paths that may touch, cross and repeat each other to a network of river edges without directed cycles.
///
/// Paths are the reaches of a graph whose nodes are their ends. Loops in a path are cut. Where reaches run in a circle
/// the reach that rises most is left out, and the circle is reported. Then, from the mouths upwards and larger rivers
/// first, each reach is laid from its source: up to the network, where it has reached it. If water gets from there to
/// the end of the reach the rest is left out (a tributary ends at the network); otherwise it goes on, and the river
/// parts there. No edge is laid against one that is there, or so that water could run in a circle.
///
/// Source   thesis, Section 7.2 ("duplicated vertices and loops were removed"), FINDINGS D6.
/// Symbols  R = river edges, P = vertices of all paths.
/// Properties
///   (1) `check_network` finds no fault in the result.
///   (2) Water that enters a path at its first vertex gets to its last one, unless a circle was cut, or part of the
///       path was left out for another reason that is counted.
///   (3) The result does not depend on the numbering of vertices nor on the order of the paths, save which of several
///       lines with the same edge gives it its name.
/// Threads  Pure.

namespace hydrotin {

struct CleaningCounts {
  std::uint64_t loop_edges = 0;      ///< in loops of single paths
  std::uint64_t repeated_edges = 0;  ///< that another path has
  std::uint64_t opposed_edges = 0;   ///< that another path has in the other direction
  std::uint64_t cycle_edges = 0;     ///< in reaches left out of circles, and edges that would close one
  std::uint64_t joined_edges = 0;    ///< of tributaries, beyond the first vertex of the network
  std::uint64_t shortcut_edges = 0;  ///< single edges between vertices that a longer way joins
};

struct CleanNetwork {
  std::vector<RiverEdge> edge;      ///< [R] ascending by (x, y) of `from`, then of `to`
  std::vector<std::uint32_t> line;  ///< [R] the line that each comes from
  std::vector<std::size_t> cycle_begin{0};
  std::vector<std::uint32_t> cycle;  ///< lines of each circle of reaches, in its order; the first was left out
  CleaningCounts counts;
};

/// @param position, height  [n]
/// Complexity: O(P log P) plus, for each contact of reaches, the length of the river below it.
[[nodiscard]] CleanNetwork clean_network(std::span<const LatticePoint> position, std::span<const double> height,
                                         const RiverPaths& paths);

}  // namespace hydrotin
