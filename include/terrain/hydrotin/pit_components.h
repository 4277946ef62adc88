#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "hydrotin/drainage_problem.h"
#include "hydrotin/lattice.h"
#include "hydrotin/vertex_graph.h"

/// What hangs together around pits: the vertices that pit removal may move, in components that can be solved alone.
///
/// Members are (a) the vertices that lifting raises; (b) the vertices that a breach of some pit by itself lowers
/// (thesis, Theorem 6.2), or where it lies below all that drains in reach, that a breach of the water raised to the
/// lowest of it lowers; (c) flats that drain through members only. Two members are in one component if edges join them
/// through members. Outlets are never members.
///
/// Why components are independent. Let f be the levels of `lift`; f = h outside the members. By (c) each vertex r
/// outside that touches members, unless it is an outlet, is joined by a flat of vertices outside to a vertex w with
/// f(w) < f(r), or to an outlet. Let each component get a surface x <= f that drains to its exits, the vertices outside
/// next to it. Water in a component comes to an exit without rising; from there over its flat, and down to w, strictly;
/// w lies outside (go on) or in a component, at x(w) <= f(w). Each round descends strictly, so it ends at an outlet.
/// Nothing of this depends on how other components were solved. And x <= f is no loss: min(x, f) drains if x does, and
/// is nearer to h.
///
/// Source   thesis, Theorem 6.2 and Section 6.3 (lift and breach together); FINDINGS C5.
/// Symbols  n = vertices, E = edges, M = members, C = components.
/// Properties
///   (1) Components and problems do not depend on the numbering of vertices: members ascend by (x, y), components by
///       their smallest member.
///   (2) Surfaces x <= f that drain, one for each component, together with h outside, leave no pit in the terrain.
///   (3) Members of a component are found from f and from the paths of its own pits alone.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

/// Limits of one breach; a pit without a breach within them is lifted.
///
/// `max_visits` bounds the work for terrains with deep lakes, where the search of Theorem 6.2 looks at a whole lake for
/// each of its pits (lake_breaches.h). Of the pits of a lake (a connected set of raised vertices) whose searches would
/// look at more, the lowest is searched for as far as the size of the lake allows; the others are breached along the
/// forest by which the flood drains the lake. The costs of these are not the least.
inline constexpr std::uint64_t kScalableVisits = 1000;  ///< for terrains of millions of pits
inline constexpr std::size_t kSmallTerrain = 200'000;   ///< vertices up to which searches may take their time
struct BreachLimits {
  std::int32_t max_depth = std::numeric_limits<std::int32_t>::max();  ///< of lowering a vertex [z lattice units]
  double max_length =
      std::numeric_limits<double>::infinity();   ///< horizontally, from the pit to the goal [lattice units]
  std::uint64_t max_visits = ~std::uint64_t{0};  ///< vertices cheaper to reach than the goal
  std::uint64_t max_lake = ~std::uint64_t{0};    ///< vertices of a lake; larger ones are filled (see PitComponents)
  std::uint64_t max_group = ~std::uint64_t{0};   ///< members of a component; larger ones are cut (see group_cut.h)
};

/// The terrain and what may be done to it. Spans may be empty where noted.
struct ChangeableTerrain {
  const VertexGraph* graph = nullptr;
  std::span<const std::int32_t> height;     ///< [n], each below kNoLevel
  std::span<const LatticePoint> position;   ///< [n] distinct
  std::span<const std::uint8_t> is_outlet;  ///< [n] outlets never move
  std::span<const std::int64_t> weight;     ///< [n] or empty: 1
  std::span<const std::int32_t> lower;      ///< [n] or empty: no bounds; lower <= level <= upper of `lift` is required
  std::span<const std::int32_t> upper;      ///< [n] or empty
};

/// One breach: how the water of a pit leaves it.
struct BreachPath {
  std::uint32_t pit = 0;              ///< smallest vertex of its plateau by (x, y)
  std::int32_t level = 0;             ///< height of the pit: vertices of the path are lowered to it
  std::int64_t cost = 0;              ///< in terms of the measure, on the terrain as it was
  std::int32_t max_depth = 0;         ///< largest displacement
  double length = 0;                  ///< [lattice units], horizontally
  std::vector<std::uint32_t> vertex;  ///< from the pit's plateau to the goal, which is strictly lower or drains itself
};

/// The cheapest breach of one pit by itself; ties: fewest vertices, then positions.
///
/// Goals are vertices strictly lower than the pit, outlets not higher, and vertices of its height that drain. Outlets
/// that are higher cannot be lowered and block the way.
///
/// @param level    [n] of `lift`.
/// @param pit      any vertex of its plateau.
/// @param measure  total and volume: sum of weights times displacements; count: vertices lowered; max: the smallest sum
///                 among the paths whose largest displacement is least.
/// @return         a path with an empty list of vertices if the pit cannot be breached, or only beyond the limits. (The
///                 length is that of the cheapest path; a shorter, costlier one is not sought.)
/// Complexity: O(r log r), r = edges at vertices that cost less to reach than the goal.
[[nodiscard]] BreachPath breach_one(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
                                    std::uint32_t pit, ChangeMeasure measure, const BreachLimits& limits);

/// Lakes of more than `BreachLimits::max_lake` vertices are *filled*: they keep the level of `lift`, are no members,
/// and for the components they are outlets of that height. No pit comes of that: if P were one, at height t, it would
/// contain an exit of a component or some other vertex that is not solved, at f = t; from there the flat of f = t leads
/// to an outlet or to a vertex w with f(w) < t, and as x <= f everywhere all of it, and w, would belong to P. So what
/// must be in memory together does not grow with the largest lake.
struct PitComponents {
  std::vector<std::uint32_t> begin;      ///< [C + 1]
  std::vector<std::uint32_t> member;     ///< [M] vertices; component i: member[begin[i] .. begin[i + 1])
  std::vector<std::int32_t> level;       ///< [n] of `lift`; kNoLevel where no outlet can be reached: left alone
  std::vector<std::int32_t> breached;    ///< [n] the least of height and levels of the breach paths through a vertex
  std::uint64_t num_pits = 0;            ///< of those that can drain
  std::int64_t dearest_breach = 0;       ///< cost of the dearest of the breaches by themselves
  std::uint64_t num_unfinished = 0;      ///< pits whose search was ended by `max_visits`
  std::uint64_t num_unbreached = 0;      ///< of these, pits without a breach within the limits
  std::uint64_t num_cut = 0;             ///< components that were cut before (group_cut.h)
  std::vector<std::uint32_t> pit_begin;  ///< [C + 1] pits of component i: pit[pit_begin[i] .. pit_begin[i + 1])
  std::vector<std::uint32_t> pit;        ///< smallest vertices of plateaus by (x, y), ascending by (height, x, y)
  std::vector<std::uint32_t> filled;     ///< vertices of filled lakes; their pits are not in the lists

  [[nodiscard]] std::size_t size() const { return begin.size() - 1; }
};

/// How far around the pits members are sought.
enum class MemberReach : std::uint8_t {
  lifted,   ///< (a) only
  paths,    ///< (a) and (b)
  centers,  ///< also every vertex at which a breach of the pit could meet others and cost less than by itself
};

/// Finds all components.
/// Complexity: a flood, the searches of `breach_one` for all pits, and O(M log M); at its peak about 45 bytes per
/// vertex.
[[nodiscard]] PitComponents find_pit_components(const ChangeableTerrain& terrain, MemberReach reach,
                                                ChangeMeasure measure, const BreachLimits& limits);

/// [n] the heights, and at filled lakes their levels.
[[nodiscard]] std::vector<std::int32_t> filled_heights(const ChangeableTerrain& terrain,
                                                       const PitComponents& components);

/// Flats outside the members that reach the rim of a part: other parts have a say. F = such flats.
struct OpenFlats {
  std::vector<std::uint32_t> begin;   ///< [F + 1]
  std::vector<std::uint32_t> vertex;  ///< of flat i: vertex[begin[i] .. begin[i + 1])
  std::vector<std::uint8_t> touches;  ///< [F] nonzero: has a neighbour in this part that is a member
  std::vector<std::uint8_t> drains;   ///< [F] nonzero: has an outlet, or a neighbour in this part whose level is lower
};

/// Completes members by (c): makes members of the flats that touch members and do not drain. Of a part of a terrain,
/// those that reach its rim are returned instead; they are members if some part sees them touch members and none sees
/// them drain.
///
/// @param level      [n] of `lift`.
/// @param is_rim     [n] nonzero where another part may have the vertex too; empty: nowhere.
/// @param is_member  [n] changed.
/// Complexity: O(n + E).
[[nodiscard]] OpenFlats add_flats_without_descent(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
                                                  std::span<const std::uint8_t> is_rim,
                                                  std::span<std::uint8_t> is_member);

/// Fills the lists of components: connected sets of members.
///
/// @param is_member   [n]
/// @param pits        smallest vertices of the plateaus of their pits, all of them members.
/// @param components  `begin`, `member`, `pit_begin` and `pit` are set, the others kept.
/// Complexity: O(n + M log M).
void collect_components(const ChangeableTerrain& terrain, std::span<const std::uint8_t> is_member,
                        std::vector<std::uint32_t> pits, PitComponents& components);

/// Cuts one component out.
///
/// @param terrain  with filled lakes at their levels.
/// @param number  scratch of n entries, all kNoVertexNumber before and after.
inline constexpr std::uint32_t kNoVertexNumber = 0xffffffffu;
void make_problem(const ChangeableTerrain& terrain, const PitComponents& components, std::size_t component,
                  std::span<std::uint32_t> number, DrainageProblem& problem);

}  // namespace hydrotin
