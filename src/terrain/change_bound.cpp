#include "hydrotin/change_bound.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "hydrotin/lifting.h"

namespace hydrotin {
namespace {

constexpr std::size_t kMaxVisits = 4096;

struct Claim {
  std::int64_t first, last;  // levels first + 1 .. last
  std::uint32_t next;        // of the same vertex
};
constexpr std::uint32_t kNone = 0xffffffffu;

/// Packs the neighbourhoods of growing pieces.
class Packing {
 public:
  Packing(const ChangeableTerrain& terrain, bool only_once)
      : terrain_(&terrain),
        only_once_(only_once),
        first_claim_(terrain.height.size(), kNone),
        entered_(terrain.height.size(), kFree) {}

  /// What the pieces around one pit, up to `top`, add to the bound.
  std::int64_t add_pit(std::uint32_t pit, std::int64_t top) {
    reached_.clear();
    heap_.clear();
    weight_ = std::int64_t{1} << 62;
    std::int64_t gain = 0, bottom = terrain_->height[pit];
    stop_ = only_once_ ? bottom + 1 : top;
    std::size_t num_visits = 0;
    reach(pit, bottom);
    while (bottom < stop_ && !heap_.empty()) {
      // The piece at levels bottom + 1 .. next: all that is connected below them.
      while (!heap_.empty() && heap_.front().first <= bottom && num_visits < kMaxVisits) {
        std::pop_heap(heap_.begin(), heap_.end(), std::greater<>{});
        const std::uint32_t v = heap_.back().second;
        heap_.pop_back();
        ++num_visits;
        for (const std::uint32_t w : terrain_->graph->neighbors(v)) {
          if (entered_[w] != kFree) continue;
          if (terrain_->height[w] < terrain_->height[pit])
            stop_ = std::min(stop_, bottom);  // it is another's piece now
          reach(w, bottom);
        }
      }
      if (num_visits >= kMaxVisits || heap_.empty() || stop_ <= bottom) break;
      const std::int64_t next = std::min<std::int64_t>(heap_.front().first, stop_);
      gain += (next - bottom) * weight_;
      bottom = next;
    }
    for (const std::uint32_t v : reached_) {
      if (entered_[v] < bottom) {
        claims_.push_back({only_once_ ? kLowest : entered_[v], only_once_ ? kHighest : bottom, first_claim_[v]});
        first_claim_[v] = static_cast<std::uint32_t>(claims_.size() - 1);
      }
      entered_[v] = kFree;
    }
    return gain;
  }

 private:
  static constexpr std::int64_t kFree = std::int64_t{1} << 62, kLowest = -kFree, kHighest = kFree - 1;

  // v belongs to the neighbourhood for all levels above `level`. Claims of others end the growth in time.
  void reach(std::uint32_t v, std::int64_t level) {
    entered_[v] = level;
    reached_.push_back(v);
    heap_.emplace_back(terrain_->height[v], v);
    std::push_heap(heap_.begin(), heap_.end(), std::greater<>{});
    weight_ = std::min(weight_, only_once_ || terrain_->weight.empty() ? 1 : terrain_->weight[v]);
    for (std::uint32_t i = first_claim_[v]; i != kNone; i = claims_[i].next)
      if (claims_[i].last > level) stop_ = std::min(stop_, std::max(level, claims_[i].first));
  }

  const ChangeableTerrain* terrain_;
  bool only_once_;
  std::vector<std::uint32_t> first_claim_, reached_;
  std::vector<std::int64_t> entered_;
  std::vector<Claim> claims_;
  std::vector<std::pair<std::int64_t, std::uint32_t>> heap_;
  std::int64_t stop_ = 0, weight_ = 0;
};

/// Whether a surface without pits exists that moves no vertex by more than `displacement`: the least one above h -
/// displacement is the best candidate.
bool is_feasible(const ChangeableTerrain& terrain, std::int64_t displacement) {
  std::vector<std::int32_t> lowered(terrain.height.begin(), terrain.height.end());
  for (std::size_t v = 0; v < lowered.size(); ++v) {
    if (terrain.is_outlet[v]) continue;
    const std::int64_t low =
        std::max<std::int64_t>(lowered[v] - displacement, std::numeric_limits<std::int32_t>::min());
    lowered[v] = static_cast<std::int32_t>(low);
    if (!terrain.lower.empty()) lowered[v] = std::max(lowered[v], terrain.lower[v]);
  }
  const std::vector<std::int32_t> level = lift(*terrain.graph, lowered, terrain.is_outlet);
  for (std::size_t v = 0; v < level.size(); ++v)
    if (level[v] != kNoLevel && level[v] > terrain.height[v] + displacement) return false;
  return true;
}

/// The least possible largest displacement, between half of the deepest flood and all of it.
std::int64_t least_largest(const ChangeableTerrain& terrain, std::int64_t deepest) {
  std::int64_t low = (deepest + 1) / 2, high = deepest;
  while (low < high) {
    const std::int64_t middle = low + (high - low) / 2;
    if (is_feasible(terrain, middle))
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

}  // namespace

std::int64_t change_bound(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
                          ChangeMeasure measure) {
  std::int64_t most = 0;
  std::vector<std::uint32_t> bottoms;  // no lower neighbour: a vertex of each pit, and some others, which add nothing
  for (std::uint32_t v = 0; v < level.size(); ++v) {
    if (level[v] == terrain.height[v] || level[v] == kNoLevel) continue;
    most = std::max(most, std::int64_t{level[v]} - terrain.height[v]);
    const auto around = terrain.graph->neighbors(v);
    if (std::ranges::none_of(around, [&](std::uint32_t w) { return terrain.height[w] < terrain.height[v]; }))
      bottoms.push_back(v);
  }
  if (measure == ChangeMeasure::max) return least_largest(terrain, most);
  const auto depth = [&](std::uint32_t v) { return std::int64_t{level[v]} - terrain.height[v]; };
  std::sort(bottoms.begin(), bottoms.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(-depth(a), terrain.height[a], terrain.position[a]) <
           std::tuple(-depth(b), terrain.height[b], terrain.position[b]);
  });
  Packing packing(terrain, measure == ChangeMeasure::count);
  std::int64_t bound = 0;
  for (const std::uint32_t v : bottoms) bound += packing.add_pit(v, level[v]);
  return bound;
}

}  // namespace hydrotin
