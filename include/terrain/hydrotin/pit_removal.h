#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/drainage_problem.h"
#include "hydrotin/pit_components.h"

/// Removing all pits of a terrain, by any method and measure. (To keep some, make them outlets: pit_choice.h.)
///
/// Source   thesis, Chapter 6: Theorem 6.1 (lift), Theorem 6.2 and Algorithm 6.1 (breach), Section 6.2.5 (measures),
///          Section 6.3 (both together).
/// Symbols  n = vertices, p = pits that can drain.
/// Properties
///   (1) No pit is left, but for pieces of the terrain without outlet, which stay as they are; outlets never move.
///   (2) Heights are integers of the lattice; the result is as free of pits as written.
///   (3) The result lies nowhere above that of `lift`; for `breach` and `greedy_breach` nowhere above the terrain
///       either, except at pits that cannot be breached within the limits, or not inside their square of a component
///       that is cut (`BreachLimits::max_group`), which are lifted.
///   (4) `least_change` costs no more than `lift` nor than `breach`.
///   (5) A terrain without pits is not changed.
///   (6) The result does not depend on the numbering of vertices.
///   (7) `bound` is no more than the cost of any surface that the method could give.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

enum class RemovalMethod : std::uint8_t {
  lift,           ///< raise only: optimal in all measures at once
  breach,         ///< lower only: single pits by Theorem 6.2, then one after the other
  greedy_breach,  ///< lower only: Algorithm 6.1, within 2 ln m of the optimum where clusters are small enough; for the
                  ///< measure max the same as breach, which is optimal then
  least_change,   ///< raise and lower
};

struct RemovalOptions {
  RemovalMethod method = RemovalMethod::least_change;
  ChangeMeasure measure = ChangeMeasure::total;
  BreachLimits limits;
  int max_rounds = 3;       ///< see LeastChangeOptions
  bool thorough = false;    ///< least_change: looks at all vertices where breaches could meet, and starts from
                            ///< Algorithm 6.1 too where the component is small enough: for small terrains
  bool with_bound = false;  ///< find `Removal::bound`, which takes about as long as a flood for each pit's basin
};

struct Removal {
  std::vector<std::int32_t> height;    ///< [n] final heights
  PitComponents components;            ///< what was solved, with the levels of `lift`; for pit_edits.h
  std::int64_t cost = 0;               ///< in the measure; for volume: sum of weight times displacement
  std::int64_t bound = 0;              ///< no surface that the method could give costs less; 0 if it was not asked for
  bool is_optimal = false;             ///< proven: cost == bound, or no better surface exists for another reason
  std::uint64_t num_pits = 0;          ///< removed
  std::uint64_t num_unbreached = 0;    ///< pits without a breach within the limits
  std::uint64_t num_unguaranteed = 0;  ///< greedy_breach: clusters too large for Algorithm 6.1, breached like `breach`
};

/// @param terrain  its weights are used by total and volume; see `star_weights`.
/// Complexity: lift: a flood. Others: `find_pit_components` and the method on each component (least_change.h,
/// greedy_breach.h); at its peak about 60 bytes per vertex beside the input.
/// Fails: never on data; std::bad_alloc. Preconditions are asserted.
[[nodiscard]] Removal remove_pits(const ChangeableTerrain& terrain, const RemovalOptions& options);

/// The same; for least_change on a small terrain the cheaper result of searches that run to their end and of searches
/// as long as `kScalableVisits`. (Longer searches find breaches for deeper pits, but in larger components, where the
/// descent that follows may end at a worse surface.) Other methods search to the end where the terrain is small.
///
/// @param options  its `limits.max_visits` is not read.
[[nodiscard]] Removal remove_pits_by_best_search(const ChangeableTerrain& terrain, RemovalOptions options);

/// How far members are sought for a method and a measure.
[[nodiscard]] MemberReach reach_of(const RemovalOptions& options);

/// Solves components one by one: the part of `remove_pits` that moves vertices.
///
/// @param height  [n] in: heights; out: the members of all components at their new heights.
/// @return        number of components that are too large for Algorithm 6.1 (see `Removal::num_unguaranteed`).
/// Complexity: that of the method on each component.
std::uint64_t solve_components(const ChangeableTerrain& terrain, const PitComponents& components,
                               const RemovalOptions& options, std::span<std::int32_t> height);

/// The weights of the measure `volume`: doubled area of the star of each vertex; the change of volume is a sixth of the
/// sum of weight times displacement. At least 1.
[[nodiscard]] std::vector<std::int64_t> star_weights(std::span<const LatticePoint> position,
                                                     std::span<const std::uint32_t> triangle_vertex);

}  // namespace hydrotin
