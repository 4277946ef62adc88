#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hydrotin/pit_components.h"

/// The breaches of the pits of one lake, each pit by itself.
///
/// A *lake* is a connected set of vertices that lifting raises; all of them come to one level. Lakes are independent of
/// each other here: what a lake finds depends on the lake and on the vertices that its searches look at. So a part of a
/// terrain can answer for a lake if these vertices have all their neighbours in the part (`is_known`); if not, the
/// vertices that lack some are named, and a larger part can try again.
///
/// With `BreachLimits::max_visits` the work for a lake is bounded: each pit's search looks at so many vertices; of the
/// pits for which these were too few, the lowest is searched for again, among the vertices not above the lake's level,
/// until as many were looked at as four times the lake has. If neither finds a breach, the water of the lowest pit
/// without one is treated as if it were raised to the lowest level at which any of these vertices drains, and the way
/// there is lowered to that level. (Without `max_visits`: the lowest of all outlets.) So a lake below all that is in
/// reach is not emptied, but sinks from its rim to that level.
///
/// Source   thesis, Theorem 6.2; FINDINGS C3.
/// Properties
///   (1) The result does not depend on the numbering of vertices, nor on the part that was asked, once it knows enough.
/// Threads  One object belongs to one thread; it keeps 4 to 6 bytes per vertex from call to call, and 28 for each
///          vertex that its largest search looked at.

namespace hydrotin {

/// What searches must know of the whole terrain.
struct OutletHeights {
  std::int32_t lowest_outlet = 0x7fffffff;  ///< of all outlets; kNoLevel: there are none
  std::int32_t lowest_inner = 0x7fffffff;   ///< of all other vertices; used without `max_visits` only
};

[[nodiscard]] OutletHeights outlet_heights(const ChangeableTerrain& terrain);

struct LakeBreaches {
  std::vector<std::uint32_t> vertex;   ///< members that breaches add; some may come more than once
  std::vector<std::int32_t> level;     ///< of each, the level a breach lowers it to; kNoLevel: it is only looked at
  std::vector<std::uint32_t> pit;      ///< smallest vertices of the plateaus, ascending by (height, x, y)
  std::int64_t dearest = 0;            ///< cost of the dearest breach
  std::uint64_t num_unfinished = 0;    ///< pits whose search was ended by `max_visits`
  std::uint64_t num_unbreached = 0;    ///< pits without a breach within the limits
  std::vector<std::uint32_t> unknown;  ///< looked at, but not known: if there are any, all the rest is void
};

class LakeBreacher {
 public:
  /// @param level     [n] of `lift`.
  /// @param is_known  [n] nonzero: the graph has all neighbours of the vertex; empty: of all of them.
  LakeBreacher(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
               std::span<const std::uint8_t> is_known, const OutletHeights& outlets, MemberReach reach,
               ChangeMeasure measure, const BreachLimits& limits);
  ~LakeBreacher();

  /// The vertices of the lake around a raised vertex, in order of discovery. Valid until the next call.
  [[nodiscard]] std::span<const std::uint32_t> lake_around(std::uint32_t seed);

  /// The breaches of the lake that `lake_around` returned last.
  void run(LakeBreaches& result);

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace hydrotin
