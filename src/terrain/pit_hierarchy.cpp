#include "hydrotin/pit_hierarchy.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <tuple>
#include <utility>

#include "hydrotin/lifting.h"
#include "pool_sweep.h"
#include "vertex_order.h"

namespace hydrotin {
namespace {

std::int64_t rounded(Wide numerator, Wide denominator) {
  return static_cast<std::int64_t>((numerator + denominator / 2) / denominator);
}

class Hierarchy : private PoolSweep {
 public:
  Hierarchy(const VertexGraph& graph, std::span<const std::uint32_t> triangle_vertex,
            std::span<const std::int32_t> height, std::span<const LatticePoint> position)
      : PoolSweep(graph, triangle_vertex, height, position) {}

  std::vector<PitBasin> run(std::span<const std::uint8_t> is_outlet) {
    const std::vector<std::uint32_t> order = order_vertices(height_, position_);
    sort_triangles(order);
    pool_of_.assign(height_.size(), kNone);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::uint32_t v = order[i];
      look_ahead(order, i);
      const std::uint32_t pool = join_at(v, is_outlet[v] != 0);
      pool_of_[v] = pool;
      add_vertex(pools_[pool], v);
    }
    for (std::uint32_t pool = 0; pool < pools_.size(); ++pool)
      if (parent_[pool] == pool && !pools_[pool].drains) end_without_spill(pool);
    return sorted();
  }

 private:
  // The pool that v belongs to, after the pools that meet at v have become one.
  std::uint32_t join_at(std::uint32_t v, bool is_outlet) {
    find_meeting(v);
    if (meeting_.empty()) meeting_.push_back(make_pool(v));
    // Pools are numbered by their bottoms: the first one is the oldest, unless one drains.
    std::uint32_t elder = meeting_.front();
    bool drains = is_outlet;
    for (const std::uint32_t pool : meeting_)
      if (pools_[pool].drains) elder = pool, drains = true;
    return join(elder, v, drains, [&](std::uint32_t pool, std::uint32_t into) -> PitBasin& {
      PitBasin& pit = add_pit(pool, into);
      pit.spill_vertex = v;
      return pit;
    });
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

  std::vector<PitBasin> pits_;
  std::vector<std::uint32_t> bottom_pool_, elder_pool_;  // [pits] its own pool, and the one it spills into
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
  const Wide all = Wide{area} * (3 * std::int64_t{level} - low - middle - high);
  if (level >= high) return {area, all};
  // The corner below, or above, the level is cut off by two similar triangles.
  const bool one_below = level <= middle;
  const std::int64_t rise = one_below ? level - low : high - level;
  const Wide sides = one_below ? Wide{middle - low} * (high - low) : Wide{high - low} * (high - middle);
  const Wide squared = Wide{area} * rise * rise;
  const std::int64_t cut_area = rounded(squared, sides);
  const Wide whole = squared / sides, rest = squared % sides;
  const Wide cut_volume = whole * rise + (rest * rise + sides / 2) / sides;
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
