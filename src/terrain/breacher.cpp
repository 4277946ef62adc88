#include "breacher.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>

namespace hydrotin {
namespace {

double distance(LatticePoint a, LatticePoint b) {
  const double x = static_cast<double>(a.x) - b.x, y = static_cast<double>(a.y) - b.y;
  return std::sqrt(x * x + y * y);
}

}  // namespace

Breacher::Breacher(const ChangeableTerrain& terrain, std::span<const std::int32_t> flood_level,
                   std::span<const std::uint8_t> is_known, const OutletHeights& outlets, ChangeMeasure measure,
                   const BreachLimits& limits)
    : terrain_(&terrain),
      ground_{&terrain, flood_level, is_known, &unknown_, measure, limits.max_depth},
      limits_(limits),
      outlets_(outlets),
      search_(terrain.height.size()) {
  if (measure == ChangeMeasure::max) is_touched_.resize(terrain.height.size(), 0);
}

bool Breacher::run(std::span<const std::uint32_t> plateau, bool to_the_end) {
  const std::uint32_t pit = plateau.front();
  const std::int32_t level = terrain_->height[pit];
  is_unfinished_ = false;
  explored_ = kNoVertexNumber;
  if (is_bounded()) {
    if (!to_the_end) return run_on(ground_, plateau, level, limits_.max_visits);
    if (run_on(lake_ground(pit), plateau, level, lake_visits())) return true;
    if (ground_.measure != ChangeMeasure::max && search_.path().empty()) explored_ = pit;
    return false;
  }
  return !is_hopeless(pit) && run_on(ground_, plateau, level, limits_.max_visits);
}

bool Breacher::run_on(TerrainGround ground, std::span<const std::uint32_t> plateau, std::int32_t level,
                      std::uint64_t max_visits) {
  if (ground.measure == ChangeMeasure::max) {
    const Bottleneck bottleneck = bottleneck_depth(ground, plateau, level, max_visits);
    is_unfinished_ = bottleneck.is_unfinished;
    if (bottleneck.depth < 0) return false;
    ground.max_depth = bottleneck.depth;
  }
  const bool is_found = search_.run(ground, plateau, level, max_visits);
  is_unfinished_ = !is_found && search_.is_unfinished();
  return is_found && length() <= limits_.max_length;
}

bool Breacher::run_raised(std::span<const std::uint32_t> plateau) {
  if (outlets_.lowest_outlet == kNoLevel) return false;
  if (is_bounded()) return run_to_lowest_drain(plateau);
  if (run_raised_to(plateau, outlets_.lowest_outlet)) return true;
  const std::int32_t level = lowest_outlet_around(plateau.front());  // the lowest of all is out of reach
  return level != kNoLevel && level != outlets_.lowest_outlet && run_raised_to(plateau, level);
}

bool Breacher::run_raised_to(std::span<const std::uint32_t> plateau, std::int32_t level) {
  TerrainGround ground = ground_;
  ground.any_drained_is_goal = true;
  return run_on(ground, plateau, level, limits_.max_visits);
}

std::int64_t Breacher::cost() const {
  if (ground_.measure != ChangeMeasure::max) return search_.cost();
  std::int64_t depth = 0;
  for (const std::uint32_t v : search_.path())
    depth = std::max(depth, std::int64_t{terrain_->height[v]} - terrain_->height[search_.path().front()]);
  return depth;
}

double Breacher::length() const {
  double sum = 0;
  const auto path = search_.path();
  for (std::size_t i = 1; i < path.size(); ++i)
    sum += distance(terrain_->position[path[i - 1]], terrain_->position[path[i]]);
  return sum;
}

std::vector<std::uint32_t> Breacher::take_unknown() {
  std::sort(unknown_.begin(), unknown_.end());
  unknown_.erase(std::unique(unknown_.begin(), unknown_.end()), unknown_.end());
  return std::exchange(unknown_, {});
}

// Whether nothing is lower than v, and no outlet as low.
bool Breacher::is_hopeless(std::uint32_t v) const {
  return terrain_->height[v] < outlets_.lowest_outlet && terrain_->height[v] <= outlets_.lowest_inner;
}

// The way to the vertex with the lowest level of those that the search of the lake can look at. All of them are higher
// than the pit, but to drain there is to raise the lake less. If that search was the last one, its answer is here.
bool Breacher::run_to_lowest_drain(std::span<const std::uint32_t> plateau) {
  const std::uint32_t pit = plateau.front();
  const std::int32_t level = terrain_->height[pit];
  if (explored_ != pit) {
    TerrainGround ground = lake_ground(pit);
    ground.has_goals = false;
    search_.run(ground, plateau, level, lake_visits());
  }
  std::uint32_t lowest = pit;
  const auto rank = [&](std::uint32_t v) {
    return std::tuple(ground_.flood_level[v], search_.cost_to(v), search_.hops_to(v), terrain_->position[v]);
  };
  for (const std::uint32_t v : search_.touched())
    if (search_.is_settled(v) && rank(v) < rank(lowest)) lowest = v;
  if (ground_.flood_level[lowest] >= ground_.flood_level[pit]) return false;
  search_.end_at(lowest);
  return length() <= limits_.max_length;
}

// The lowest outlet that water can reach without passing another.
std::int32_t Breacher::lowest_outlet_around(std::uint32_t seed) const {
  std::int32_t lowest = kNoLevel;
  std::vector<bool> is_reached(terrain_->height.size());
  std::vector<std::uint32_t> open{seed};
  is_reached[seed] = true;
  while (!open.empty()) {
    const std::uint32_t v = open.back();
    open.pop_back();
    for (const std::uint32_t w : ground_.neighbors(v)) {
      if (is_reached[w]) continue;
      is_reached[w] = true;
      if (terrain_->is_outlet[w])
        lowest = std::min(lowest, terrain_->height[w]);
      else
        open.push_back(w);
    }
  }
  return lowest;
}

// The least depth to which a breach of the pit must lower some vertex: how far the water must rise to find a goal.
// Vertices are visited by (rise, steps); all of the last rank that visits reach are, so that the answer does not depend
// on the order within it.
Breacher::Bottleneck Breacher::bottleneck_depth(const TerrainGround& ground, std::span<const std::uint32_t> plateau,
                                                std::int32_t level, std::uint64_t max_visits) {
  using Entry = std::tuple<std::int32_t, std::uint32_t, std::uint32_t>;  // top, steps, vertex
  std::vector<Entry> heap;
  const auto reach = [&](std::int32_t top, std::uint32_t steps, std::uint32_t v) {
    is_touched_[v] = 1;
    touched_.push_back(v);
    heap.emplace_back(top, steps, v);
    std::push_heap(heap.begin(), heap.end(), std::greater<>{});
  };
  touched_.clear();
  for (const std::uint32_t v : plateau) reach(level, 0, v);
  Bottleneck result;
  std::uint64_t num_visits = 0;
  std::pair<std::int32_t, std::uint32_t> last{kNoLevel, 0xffffffffu};  // rank of the last vertex that may be visited
  while (!heap.empty() && result.depth < 0) {
    std::pop_heap(heap.begin(), heap.end(), std::greater<>{});
    const auto [top, steps, v] = heap.back();
    heap.pop_back();
    if (std::pair{top, steps} > last) {
      result.is_unfinished = true;
      break;
    }
    if (++num_visits == max_visits) last = {top, steps};
    for (const std::uint32_t w : ground.neighbors(v)) {
      if (is_touched_[w]) continue;
      if (ground.cost(w, level) < 0) continue;
      if (ground.is_goal(w, level)) {
        result.depth = std::int64_t{top} - level;
        break;
      }
      reach(std::max(top, terrain_->height[w]), steps + 1, w);
    }
  }
  for (const std::uint32_t v : touched_) is_touched_[v] = 0;
  return result;
}

}  // namespace hydrotin
