#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hydrotin/pit_components.h"

/// A lower bound on the cost of removing the pits of one lake, such that the bounds of all lakes add up.
///
/// As in change_bound.h, pieces of {h < t} without outlet are packed, here of one lake at a time (lake_breaches.h: a
/// connected set of raised vertices; all of a piece lies in one lake). A vertex around several lakes may be charged by
/// each: lowering it across a level pays for the pieces of all. So c lakes may charge it a c-th of its weight each. For
/// c stands the number of groups into which its raised neighbours fall, neighbours of each other being in one group:
/// there are not more lakes than groups, and all that is asked of the vertex are its own triangles. Hence a part of a
/// terrain can answer for a lake if it knows all neighbours of the vertices looked at.
///
/// total, volume  the sum over levels of the pieces in a packing
/// count          the pits in a packing, each with its neighbours
/// max            the measure is no sum; nothing: of all lakes, the deepest counts (change_bound.h)
///
/// Source   own.
/// Symbols  n = vertices.
/// Properties
///   (1) The sum over all lakes, divided by `kBoundShares`, is no more than the cost of any surface without pits.
///   (2) The result does not depend on the numbering of vertices, nor on the part that was asked, once it knows enough.
/// Threads  One object belongs to one thread; it keeps 14 bytes per vertex from call to call.

namespace hydrotin {

/// Bounds are in these parts of the unit of the measure, so that they are integers.
inline constexpr std::int64_t kBoundShares = 60;

class LakeBound {
 public:
  /// @param level     [n] of `lift`.
  /// @param is_known  [n] nonzero: the graph has all neighbours of the vertex; empty: of all of them.
  LakeBound(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
            std::span<const std::uint8_t> is_known, ChangeMeasure measure);
  ~LakeBound();

  /// @param lake     its vertices, each once.
  /// @param unknown  vertices looked at, but not known are added: if there are any, the result is void.
  /// @return         the bound times `kBoundShares`; at most 2^63 - 1.
  /// Complexity: O(l log l + sum over pits of b log b), l = vertices of the lake, b <= 4096 vertices looked at per pit.
  [[nodiscard]] std::int64_t run(std::span<const std::uint32_t> lake, std::vector<std::uint32_t>& unknown);

 private:
  class State;
  std::unique_ptr<State> state_;
};

/// The sum over all lakes of a terrain.
[[nodiscard]] std::int64_t sum_of_lake_bounds(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
                                              ChangeMeasure measure);

}  // namespace hydrotin
