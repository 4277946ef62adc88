#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/pit_hierarchy.h"
#include "hydrotin/pits.h"
#include "hydrotin/vertex_graph.h"

/// The pit hierarchy of a terrain that is cut into parts.
///
/// In each part the water rises as in `pit_hierarchy`. A pool is *open* once it has reached the rim: what it really is,
/// only all parts together know. Pits that end while all pools around them are closed, or known to drain, are decided
/// in the part. The rest is reduced to a tree: its leaves are closed pools that meet open ones, its inner nodes the
/// vertices at which pools meet and all vertices of the rim. The global pass replays the trees of all parts together,
/// which tells who overflows where into whom; then each part is asked how much water its share of a pool holds at such
/// a moment.
///
///     reduce_pools (part) -> rank_pools (all) -> weigh_pools (part) -> nested_pits (all)
///
/// Source   as pit_hierarchy.h.
/// Properties
///   (1) `nested_pits` returns what `pit_hierarchy` returns for the whole terrain, but for `Pit::vertex` and
///       `spill_vertex`, for every way of cutting it; prices only where they were asked for.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

inline constexpr std::uint64_t kNoPoint = ~std::uint64_t{0};

/// What a pool holds.
struct PoolContent {
  std::int64_t num_vertices = 0, num_below = 0;  ///< all; those lower than the level
  std::int64_t sum_of_heights = 0;
  std::int64_t doubled_area = 0;  ///< of the water at the level
  std::int64_t sixfold_high = 0;  ///< its sixfold volume, 128 bits
  std::uint64_t sixfold_low = 0;

  void add(const PoolContent& other);
  [[nodiscard]] std::int64_t displacement(std::int64_t level) const { return num_vertices * level - sum_of_heights; }
};

/// A vertex with its place in the order (z, x, y).
struct RankedVertex {
  std::int32_t height = 0;
  LatticePoint position;
  std::uint64_t vertex = kNoPoint;  ///< global id
  friend constexpr auto operator<=>(const RankedVertex&, const RankedVertex&) = default;
};

/// A pit decided in a part; `PitBasin::parent` is void.
struct DecidedPit {
  PitBasin basin;
  std::uint64_t parent = kNoPoint;  ///< bottom of the pool it overflows into; kNoPoint: it overflows for good
};

struct PoolNode {
  enum class Kind : std::uint8_t { leaf, meeting, drained_leaf, outlet };  ///< outlet: a meeting at one
  RankedVertex at;                                                         ///< leaf: the pool's bottom; else the vertex
  std::uint32_t parent = kNoPit;   ///< the node at which the pool meets others next, in this part
  std::uint32_t content = kNoPit;  ///< leaf: entry of the lists below
  Kind kind = Kind::leaf;
};

/// One part, reduced. L = leaves that do not drain.
struct ReducedPools {
  std::vector<DecidedPit> pit;
  std::vector<PoolNode> node;                     ///< leaves stand before their parents; meetings ascend
  std::vector<PoolContent> content;               ///< [L] at the height of the parent
  std::vector<std::int64_t> spent, leader_price;  ///< [L] see pit_choice.h: increments given so far, and the
                                                  ///< price of the pit with the last one
  std::vector<std::int64_t> bottom_price;         ///< [L] increments given to the leaf's own pit so far
  std::vector<RankedVertex> leader;               ///< [L] its bottom; no vertex: there is none
  bool all_drain = true;                          ///< false: some closed pool has no outlet, nor ever meets the rim
};

/// @param triangle_vertex  [3T] the triangles of the part's graph.
/// @param global_id, is_rim, is_outlet, height, position  [n] each, as for `reduce_to_rim`.
/// Complexity: as `pit_hierarchy`.
[[nodiscard]] ReducedPools reduce_pools(const VertexGraph& graph, std::span<const std::uint32_t> triangle_vertex,
                                        std::span<const std::int32_t> height, std::span<const LatticePoint> position,
                                        std::span<const std::uint64_t> global_id, std::span<const std::uint8_t> is_rim,
                                        std::span<const std::uint8_t> is_outlet);

/// What a part is asked: the content of its pool around a vertex when the water stands just before `moment`.
struct PoolQuery {
  std::uint64_t vertex = kNoPoint;
  RankedVertex moment;
  std::uint32_t answer_to = 0;  ///< entry of RankedPools::content
};

/// A pit that ends in the global pass.
struct EndedPit {
  RankedVertex bottom, spill;
  std::uint64_t parent = kNoPoint;
  std::uint32_t content = kNoPit;  ///< entry of RankedPools::content
};

/// One step of the prices, in the order of time.
struct PriceStep {
  enum class Kind : std::uint8_t { raise, end_without_pit, absorb };
  std::uint32_t pool = 0, other = 0;  ///< absorb: `other` becomes part of `pool`; raise: `other` = entry of content
  std::int32_t level = 0;
  Kind kind = Kind::raise;
};

struct RankedPools {
  std::vector<EndedPit> pit;
  std::vector<PoolContent> content;           ///< as far as the parts have said already
  std::vector<std::vector<PoolQuery>> query;  ///< [parts] ascending by moment
  std::vector<PriceStep> step;                ///< empty unless prices were asked for
  std::vector<RankedVertex> pool_leader;      ///< [pools] at their beginnings
  std::vector<std::int64_t> pool_price, pool_spent;
  std::vector<std::pair<std::uint64_t, std::int64_t>> bottom_price;  ///< of pits that do not lead
  bool all_drain = true;                                             ///< false: some pool never met an outlet
};

/// @param nodes        of all parts.
/// @param with_prices  adds what prices need: a query for each share of a pool at each meeting.
/// Complexity: O(N log N), N = nodes of all parts; about 120 bytes each.
[[nodiscard]] RankedPools rank_pools(std::span<const ReducedPools> parts, bool with_prices);

/// @param query   of this part, ascending by moment.
/// @param counts  [n] nonzero: the vertex counts for this part (a rim vertex must count for one part only).
/// @return        an answer for each query.
[[nodiscard]] std::vector<PoolContent> weigh_pools(
    const VertexGraph& graph, std::span<const std::uint32_t> triangle_vertex, std::span<const std::int32_t> height,
    std::span<const LatticePoint> position, std::span<const std::uint64_t> global_id,
    std::span<const std::uint8_t> counts, std::span<const PoolQuery> query);

/// All pits, sorted by representative. Spill vertices are 0.
///
/// @param decided   of all parts.
/// @param ranked    with all answers added to its contents.
/// @param plateaus  all pits of all parts with their numbers of vertices (`summarize_plateaus`, `resolve_plateaus`), in
///                  any order.
/// Complexity: O(p log p).
[[nodiscard]] std::vector<PitBasin> nested_pits(std::vector<DecidedPit> decided, const RankedPools& ranked,
                                                std::span<const Pit> plateaus);

}  // namespace hydrotin
