#include "hydrotin/pit_hierarchy.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <tuple>
#include <utility>

#include "hydrotin/lifting.h"
#include "union_find.h"
#include "vertex_order.h"

namespace hydrotin {
namespace {

__extension__ using Int128 = __int128;

constexpr std::uint32_t kNone = 0xffffffffu;

std::int64_t rounded(Int128 numerator, Int128 denominator) {
  return static_cast<std::int64_t>((numerator + denominator / 2) / denominator);
}

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
  Int128 weighted_height = 0;     ///< sum of doubled area times sum of corner heights of these
};

class Hierarchy {
 public:
  Hierarchy(const VertexGraph& graph, std::span<const std::uint32_t> triangle_vertex,
            std::span<const std::int32_t> height, std::span<const LatticePoint> position)
      : graph_(&graph), triangle_(triangle_vertex), height_(height), position_(position) {}

  std::vector<PitBasin> run(std::span<const std::uint8_t> is_outlet) {
    const std::vector<std::uint32_t> order = order_vertices(height_, position_);
    sort_triangles(order);
    pool_of_.assign(height_.size(), kNone);
    for (const std::uint32_t v : order) {
      const std::uint32_t pool = join_at(v, is_outlet[v] != 0);
      pool_of_[v] = pool;
      add_vertex(pools_[pool], v);
    }
    for (std::uint32_t pool = 0; pool < pools_.size(); ++pool)
      if (parent_[pool] == pool && !pools_[pool].drains) end_without_spill(pool);
    return sorted();
  }

 private:
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

  // The pool that v belongs to, after the pools that meet at v have become one.
  std::uint32_t join_at(std::uint32_t v, bool is_outlet) {
    meeting_.clear();
    for (const std::uint32_t w : graph_->neighbors(v))
      if (pool_of_[w] != kNone) meeting_.push_back(find(pool_of_[w]));
    std::sort(meeting_.begin(), meeting_.end());
    meeting_.erase(std::unique(meeting_.begin(), meeting_.end()), meeting_.end());
    if (meeting_.empty()) meeting_.push_back(make_pool(v));
    // Pools are numbered by their bottoms: the first one is the oldest, unless one drains.
    std::uint32_t elder = meeting_.front();
    bool drains = is_outlet;
    for (const std::uint32_t pool : meeting_)
      if (pools_[pool].drains) elder = pool, drains = true;
    if (drains || meeting_.size() > 1) {
      for (const std::uint32_t pool : meeting_)
        if (!pools_[pool].drains) raise_prices(pool, height_[v]);
      for (const std::uint32_t pool : meeting_)
        if (!pools_[pool].drains && (drains || pool != elder)) end_at_spill(pool, v, drains ? kNone : elder);
      for (const std::uint32_t pool : meeting_)
        if (pool != elder) absorb(elder, pool);
    }
    pools_[elder].drains = drains;
    return elder;
  }

  void raise_prices(std::uint32_t number, std::int32_t level) {
    Pool& pool = pools_[number];
    const std::int64_t cost = static_cast<std::int64_t>(pool.num_vertices) * level - pool.sum_of_heights;
    if (pool.leader != kNone) price_[pool.leader] += cost - pool.spent;
    pool.spent = cost;
  }

  void end_at_spill(std::uint32_t number, std::uint32_t v, std::uint32_t elder) {
    Pool& pool = pools_[number];
    const std::int32_t level = height_[v];
    if (height_[pool.bottom] == level) {  // a part of a plateau that is no pit, or of one with another smallest vertex
      pool.leader = kNone;
      return;
    }
    PitBasin& pit = add_pit(number, elder);
    pit.spill_vertex = v;
    pit.spill_position = position_[v];
    pit.spill_level = level;
    pit.num_vertices = pool.num_vertices - (pool.top == level ? pool.num_at_top : 0);
    pit.displacement = static_cast<std::int64_t>(pool.num_vertices) * level - pool.sum_of_heights;
    measure_water(pool, level, pit);
  }

  void end_without_spill(std::uint32_t number) {
    PitBasin& pit = add_pit(number, kNone);
    pit.spill_level = kNoLevel;
    if (pools_[number].leader != kNone) price_[pools_[number].leader] = kNoPrice;
  }

  // The pit at the bottom of a pool that spills into the pool `elder`.
  PitBasin& add_pit(std::uint32_t number, std::uint32_t elder) {
    pit_of_[number] = static_cast<std::uint32_t>(pits_.size());
    bottom_pool_.push_back(number);
    elder_pool_.push_back(elder);
    PitBasin& pit = pits_.emplace_back();
    const std::uint32_t bottom = pools_[number].bottom;
    pit.pit = {position_[bottom], bottom, height_[bottom], 0};
    return pit;
  }

  // Triangles found under water are summed up and leave the list.
  void measure_water(Pool& pool, std::int32_t level, PitBasin& pit) {
    std::int64_t area = 0;
    Int128 sixfold = 0;
    std::uint32_t first = kNone, last = kNone;
    for (std::uint32_t t = pool.first_triangle; t != kNone;) {
      const std::uint32_t next = next_[t];
      const auto h = heights_of(t);
      if (std::max({h[0], h[1], h[2]}) <= level && std::min({h[0], h[1], h[2]}) < level) {
        const std::int64_t doubled = flooded_part(corners_of(t), h, level).doubled_area;
        pool.doubled_area += doubled;
        pool.weighted_height += Int128{doubled} * (std::int64_t{h[0]} + h[1] + h[2]);
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
    pit.doubled_area = area + pool.doubled_area;
    sixfold += Int128{3} * pool.doubled_area * level - pool.weighted_height;
    pit.volume = static_cast<double>(sixfold) / 6;
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

  // By representative, with parents as indices into the list, prices, and the sizes of the plateaus.
  std::vector<PitBasin> sorted() {
    std::vector<std::uint32_t> order(pits_.size()), place(pits_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return pits_[a].pit < pits_[b].pit; });
    for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
    std::vector<PitBasin> result;
    result.reserve(pits_.size());
    std::vector<std::uint32_t> plateau;
    std::vector<bool> is_seen(height_.size());
    for (const std::uint32_t i : order) {
      PitBasin& pit = result.emplace_back(pits_[i]);
      pit.price = price_[bottom_pool_[i]];
      if (elder_pool_[i] != kNone) pit.parent = place[pit_of_[elder_pool_[i]]];
      pit.pit.num_vertices = plateau_size(static_cast<std::uint32_t>(pit.pit.vertex), plateau, is_seen);
    }
    return result;
  }

  std::uint64_t plateau_size(std::uint32_t v, std::vector<std::uint32_t>& plateau, std::vector<bool>& is_seen) const {
    plateau.assign(1, v);
    is_seen[v] = true;
    for (std::size_t next = 0; next < plateau.size(); ++next)
      for (const std::uint32_t w : graph_->neighbors(plateau[next])) {
        if (height_[w] != height_[v] || is_seen[w]) continue;
        is_seen[w] = true;
        plateau.push_back(w);
      }
    return plateau.size();
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
  std::vector<PitBasin> pits_;
  std::vector<std::uint32_t> bottom_pool_, elder_pool_;  // [pits] its own pool, and the one it spills into
  std::vector<std::uint32_t> meeting_;
};

}  // namespace

FloodedPart flooded_part(const std::array<LatticePoint, 3>& corner, std::array<std::int32_t, 3> height,
                         std::int32_t level) {
  const auto difference = [](std::int32_t a, std::int32_t b) { return std::int64_t{a} - b; };
  const std::int64_t signed_area = difference(corner[1].x, corner[0].x) * difference(corner[2].y, corner[0].y) -
                                   difference(corner[1].y, corner[0].y) * difference(corner[2].x, corner[0].x);
  const std::int64_t area = signed_area < 0 ? -signed_area : signed_area;
  std::sort(height.begin(), height.end());
  const std::int64_t low = height[0], middle = height[1], high = height[2];
  if (level <= low) return {};
  const std::int64_t all = area * (3 * std::int64_t{level} - low - middle - high);
  if (level >= high) return {area, all};
  // The corner below, or above, the level is cut off by two similar triangles.
  const bool one_below = level <= middle;
  const std::int64_t rise = one_below ? level - low : high - level;
  const Int128 sides = one_below ? Int128{middle - low} * (high - low) : Int128{high - low} * (high - middle);
  const Int128 squared = Int128{area} * rise * rise;
  const std::int64_t cut_area = rounded(squared, sides);
  const Int128 whole = squared / sides, rest = squared % sides;
  const auto cut_volume = static_cast<std::int64_t>(whole * rise + (rest * rise + sides / 2) / sides);
  if (one_below) return {cut_area, cut_volume};
  return {area - cut_area, all + cut_volume};
}

std::vector<PitBasin> pit_hierarchy(const VertexGraph& graph, std::span<const std::uint32_t> triangle_vertex,
                                    std::span<const std::int32_t> height, std::span<const LatticePoint> position,
                                    std::span<const std::uint8_t> is_outlet) {
  assert(height.size() == graph.num_vertices() && is_outlet.size() == height.size() && "one entry per vertex");
  assert(position.size() == height.size() && "one entry per vertex");
  return Hierarchy(graph, triangle_vertex, height, position).run(is_outlet);
}

}  // namespace hydrotin
