#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/pit_hierarchy.h"
#include "hydrotin/vertex_graph.h"
#include "hydrotin/wide.h"

namespace hydrotin {

inline constexpr std::uint32_t kNone = 0xffffffffu;

/// A pool of rising water; its number is that of its bottom in ascending order.
struct Pool {
  std::uint32_t bottom = 0;      ///< vertex
  std::uint32_t leader = kNone;  ///< pool whose bottom is the pit with the last increment of those in here
  std::uint32_t first_triangle = kNone, last_triangle = kNone;  ///< reached ones that are not under water for certain
  std::int32_t top = 0;                                         ///< height of the highest vertex so far
  bool drains = false;
  std::uint64_t num_vertices = 0, num_at_top = 0;
  std::int64_t sum_of_heights = 0;
  std::int64_t spent = 0;         ///< sum of the increments given to its pits so far
  std::int64_t doubled_area = 0;  ///< of its triangles under water
  Wide weighted_height = 0;       ///< sum of doubled area times sum of corner heights of these
};

/// Pools of rising water with their vertices and triangles.
class PoolSweep {
 public:
  PoolSweep(const VertexGraph& graph, std::span<const std::uint32_t> triangle_vertex,
            std::span<const std::int32_t> height, std::span<const LatticePoint> position)
      : graph_(&graph), triangle_(triangle_vertex), height_(height), position_(position) {}

 protected:
  [[nodiscard]] std::array<std::int32_t, 3> heights_of(std::uint32_t t) const {
    return {height_[triangle_[3 * t]], height_[triangle_[3 * t + 1]], height_[triangle_[3 * t + 2]]};
  }
  [[nodiscard]] std::array<LatticePoint, 3> corners_of(std::uint32_t t) const {
    return {position_[triangle_[3 * t]], position_[triangle_[3 * t + 1]], position_[triangle_[3 * t + 2]]};
  }

  // Triangles by their lowest vertex: it brings them into its pool.
  void sort_triangles(const std::vector<std::uint32_t>& order) {
    const std::size_t num_triangles = triangle_.size() / 3;
    std::vector<std::uint32_t> rank(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
    first_.assign(order.size(), kNone);
    next_.assign(num_triangles, kNone);
    for (std::uint32_t t = 0; t < num_triangles; ++t) {
      std::uint32_t lowest = triangle_[3 * t];
      for (const std::size_t corner : {1, 2})
        if (rank[triangle_[3 * t + corner]] < rank[lowest]) lowest = triangle_[3 * t + corner];
      next_[t] = std::exchange(first_[lowest], t);
    }
  }

  std::uint32_t find(std::uint32_t pool) {
    while (parent_[pool] != pool) pool = parent_[pool] = parent_[parent_[pool]];
    return pool;
  }

  std::uint32_t make_pool(std::uint32_t v) {
    const auto pool = static_cast<std::uint32_t>(pools_.size());
    Pool& made = pools_.emplace_back();
    made.bottom = v;
    made.leader = pool;
    made.top = height_[v];
    parent_.push_back(pool);
    pit_of_.push_back(kNone);
    price_.push_back(0);
    return pool;
  }

  // Triangles found under water are summed up and leave the list.
  void measure_water(Pool& pool, std::int32_t level, std::int64_t& doubled_area, Wide& sixfold) {
    std::int64_t area = 0;
    sixfold = 0;
    std::uint32_t first = kNone, last = kNone;
    for (std::uint32_t t = pool.first_triangle; t != kNone;) {
      const std::uint32_t next = next_[t];
      const auto h = heights_of(t);
      if (std::max({h[0], h[1], h[2]}) <= level && std::min({h[0], h[1], h[2]}) < level) {
        const std::int64_t doubled = flooded_part(corners_of(t), h, level).doubled_area;
        pool.doubled_area += doubled;
        pool.weighted_height += Wide{doubled} * (std::int64_t{h[0]} + h[1] + h[2]);
      } else {
        const FloodedPart part = flooded_part(corners_of(t), h, level);
        area += part.doubled_area;
        sixfold += part.sixfold_volume;
        next_[t] = first;
        if (first == kNone) last = t;
        first = t;
      }
      t = next;
    }
    pool.first_triangle = first;
    pool.last_triangle = last;
    doubled_area = area + pool.doubled_area;
    sixfold += Wide{3} * pool.doubled_area * level - pool.weighted_height;
  }

  void absorb(std::uint32_t elder, std::uint32_t number) {
    Pool& into = pools_[elder];
    Pool& from = pools_[number];
    parent_[number] = elder;
    into.num_at_top = into.top == from.top ? into.num_at_top + from.num_at_top
                                           : (into.top > from.top ? into.num_at_top : from.num_at_top);
    into.top = std::max(into.top, from.top);
    into.num_vertices += from.num_vertices;
    into.sum_of_heights += from.sum_of_heights;
    into.spent += from.spent;
    into.doubled_area += from.doubled_area;
    into.weighted_height += from.weighted_height;
    const auto key = [&](std::uint32_t pool) { return std::tuple(price_[pool], pool); };
    if (from.leader != kNone && (into.leader == kNone || key(into.leader) < key(from.leader)))
      into.leader = from.leader;
    append(into, from.first_triangle, from.last_triangle);
  }

  void append(Pool& pool, std::uint32_t first, std::uint32_t last) {
    if (first == kNone) return;
    next_[last] = pool.first_triangle;
    if (pool.first_triangle == kNone) pool.last_triangle = last;
    pool.first_triangle = first;
  }

  void add_vertex(Pool& pool, std::uint32_t v) {
    ++pool.num_vertices;
    pool.sum_of_heights += height_[v];
    pool.num_at_top = pool.top == height_[v] ? pool.num_at_top + 1 : 1;
    pool.top = height_[v];
    if (pool.drains) return;
    for (std::uint32_t t = first_[v]; t != kNone;) {
      const std::uint32_t next = next_[t];
      append(pool, t, t);
      t = next;
    }
  }

  // Fetches what the sweep needs soon: vertices that follow each other in height lie anywhere in memory.
  void look_ahead(const std::vector<std::uint32_t>& order, std::size_t i) const {
    constexpr std::size_t kAhead = 4;
    if (i + 3 * kAhead >= order.size()) return;
    const std::uint32_t far = order[i + 3 * kAhead], soon = order[i + 2 * kAhead];
    __builtin_prefetch(&graph_->begin[far]);
    __builtin_prefetch(&first_[far]);
    __builtin_prefetch(&height_[far]);
    __builtin_prefetch(graph_->neighbor.data() + graph_->begin[soon]);
    if (first_[soon] != kNone) __builtin_prefetch(&next_[first_[soon]]);
    for (const std::uint32_t w : graph_->neighbors(order[i + kAhead])) __builtin_prefetch(&pool_of_[w]);
  }

  // The pools that neighbours of v belong to, ascending. Mostly one or two.
  void find_meeting(std::uint32_t v) {
    meeting_.clear();
    std::uint32_t last = kNone;
    for (const std::uint32_t w : graph_->neighbors(v)) {
      if (pool_of_[w] == kNone || pool_of_[w] == last) continue;
      last = pool_of_[w];
      const std::uint32_t pool = find(last);
      if (std::find(meeting_.begin(), meeting_.end(), pool) == meeting_.end()) meeting_.push_back(pool);
    }
    if (meeting_.size() > 1) std::sort(meeting_.begin(), meeting_.end());
  }

  void raise_prices(std::uint32_t number, std::int32_t level) {
    Pool& pool = pools_[number];
    const std::int64_t cost = static_cast<std::int64_t>(pool.num_vertices) * level - pool.sum_of_heights;
    if (pool.leader != kNone) price_[pool.leader] += cost - pool.spent;
    pool.spent = cost;
  }

  /// The pools that meet at v become one, `elder`, which drains or not. Those that overflow there are pits unless v is
  /// no higher than their bottoms: then they are parts of a plateau.
  /// @param add_pit(pool, into)  a basin for the pit at the bottom of a pool; into: the pool it spills into, or kNone
  template <class AddPit>
  std::uint32_t join(std::uint32_t elder, std::uint32_t v, bool drains, AddPit add_pit) {
    if (drains || meeting_.size() > 1) {
      for (const std::uint32_t pool : meeting_)
        if (!pools_[pool].drains) raise_prices(pool, height_[v]);
      for (const std::uint32_t pool : meeting_) {
        if (pools_[pool].drains || (!drains && pool == elder)) continue;
        if (height_[pools_[pool].bottom] == height_[v])
          pools_[pool].leader = kNone;
        else
          set_spill(pools_[pool], v, add_pit(pool, drains ? kNone : elder));
      }
      for (const std::uint32_t pool : meeting_)
        if (pool != elder) absorb(elder, pool);
    }
    pools_[elder].drains = drains;
    return elder;
  }

  void set_spill(Pool& pool, std::uint32_t v, PitBasin& pit) {
    const std::int32_t level = height_[v];
    pit.spill_position = position_[v];
    pit.spill_level = level;
    pit.num_vertices = pool.num_vertices - (pool.top == level ? pool.num_at_top : 0);
    pit.displacement = static_cast<std::int64_t>(pool.num_vertices) * level - pool.sum_of_heights;
    Wide sixfold = 0;
    measure_water(pool, level, pit.doubled_area, sixfold);
    pit.volume = static_cast<double>(sixfold) / 6;
  }

  const VertexGraph* graph_;
  std::span<const std::uint32_t> triangle_;
  std::span<const std::int32_t> height_;
  std::span<const LatticePoint> position_;
  std::vector<std::uint32_t> first_, next_;  // lists of triangles: by lowest vertex, later by pool
  std::vector<std::uint32_t> pool_of_;       // [n]
  std::vector<Pool> pools_;
  std::vector<std::uint32_t> parent_, pit_of_;  // [pools]
  std::vector<std::int64_t> price_;             // [pools] of the pit at the bottom
  std::vector<std::uint32_t> meeting_;
};

}  // namespace hydrotin
