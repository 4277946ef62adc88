#include "hydrotin/lake_bound.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <tuple>

#include "hydrotin/wide.h"
#include "moat_packing.h"

namespace hydrotin {
namespace {

/// Weights are cut here, so that shares of them fit.
constexpr std::int64_t kMostWeight = std::int64_t{1} << 55;
/// Stars with so many groups of raised neighbours, or that might have, are not charged at all.
constexpr std::uint8_t kManyLakes = 255;

struct LakeGround {
  const ChangeableTerrain* terrain;
  std::span<const std::int32_t> level;
  std::span<const std::uint8_t> is_known;
  ChangeMeasure measure;
  std::vector<std::uint32_t>* unknown;
  mutable std::vector<std::uint8_t> num_lakes;  // [n] that may charge a vertex; 0: not counted yet
  mutable std::vector<std::uint32_t> raised;

  [[nodiscard]] std::int64_t height(std::uint32_t v) const { return terrain->height[v]; }
  [[nodiscard]] std::span<const std::uint32_t> neighbors(std::uint32_t v) const {
    if (!is_known.empty() && !is_known[v]) unknown->push_back(v);
    return terrain->graph->neighbors(v);
  }
  [[nodiscard]] bool is_raised(std::uint32_t v) const { return level[v] != terrain->height[v]; }
  [[nodiscard]] std::int64_t capacity(std::uint32_t v) const {
    const bool has_weight = measure != ChangeMeasure::count && !terrain->weight.empty();
    const std::int64_t weight = has_weight ? std::min(terrain->weight[v], kMostWeight) : 1;
    if (is_raised(v)) return kBoundShares * weight;
    if (num_lakes[v] == 0) num_lakes[v] = count_lakes(v);
    return num_lakes[v] == kManyLakes ? 0 : kBoundShares * weight / num_lakes[v];
  }

  // Groups of raised neighbours; in a star these are few.
  [[nodiscard]] std::uint8_t count_lakes(std::uint32_t v) const {
    raised.clear();
    for (const std::uint32_t w : neighbors(v))
      if (is_raised(w)) raised.push_back(w);
    if (raised.size() > 2 * kManyLakes) return kManyLakes;
    std::size_t groups = 0;
    for (std::size_t end = 0; end < raised.size(); ++groups) {
      std::size_t next = end++;  // raised[.. end) have groups
      for (; next < end; ++next) {
        const auto around = terrain->graph->neighbors(raised[next]);
        for (std::size_t i = end; i < raised.size(); ++i)
          if (std::binary_search(around.begin(), around.end(), raised[i])) std::swap(raised[i], raised[end++]);
      }
    }
    return static_cast<std::uint8_t>(std::clamp<std::size_t>(groups, 1, kManyLakes));
  }
};

}  // namespace

class LakeBound::State {
 public:
  State(const ChangeableTerrain& terrain, std::span<const std::int32_t> level, std::span<const std::uint8_t> is_known,
        ChangeMeasure measure)
      : ground_{&terrain, level, is_known, measure, &unknown_, std::vector<std::uint8_t>(level.size(), 0), {}},
        packing_(&ground_, level.size(), measure == ChangeMeasure::count),
        is_spent_(level.size(), 0) {}

  std::int64_t run(std::span<const std::uint32_t> lake, std::vector<std::uint32_t>& unknown) {
    if (ground_.measure == ChangeMeasure::max) return 0;
    unknown_.clear();
    const std::vector<std::uint32_t> pits = bottoms(lake);
    Wide bound = 0;
    for (const std::uint32_t v : pits) {
      if (is_spent_[v]) continue;  // its plateau had its turn
      bound += packing_.add_pit(v, ground_.level[v]);
      for (const std::uint32_t w : packing_.at_bottom()) {
        is_spent_[w] = 1;
        spent_.push_back(w);
      }
    }
    packing_.clear();
    for (const std::uint32_t v : spent_) is_spent_[v] = 0;
    spent_.clear();
    unknown.insert(unknown.end(), unknown_.begin(), unknown_.end());
    return static_cast<std::int64_t>(std::min<Wide>(bound, std::numeric_limits<std::int64_t>::max()));
  }

 private:
  // No lower neighbour: a vertex of each pit, and some others, which add nothing. The deepest come first.
  [[nodiscard]] std::vector<std::uint32_t> bottoms(std::span<const std::uint32_t> lake) const {
    const std::span<const std::int32_t> height = ground_.terrain->height;
    const std::span<const LatticePoint> position = ground_.terrain->position;
    std::vector<std::uint32_t> out;
    for (const std::uint32_t v : lake)
      if (std::ranges::none_of(ground_.neighbors(v), [&](std::uint32_t w) { return height[w] < height[v]; }))
        out.push_back(v);
    std::sort(out.begin(), out.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tie(height[a], position[a]) < std::tie(height[b], position[b]);
    });
    return out;
  }

  struct GroundOf {  // the packing's view of `ground_`
    const LakeGround* ground;
    GroundOf(const LakeGround* g) : ground(g) {}
    [[nodiscard]] std::int64_t height(std::uint32_t v) const { return ground->height(v); }
    [[nodiscard]] std::span<const std::uint32_t> neighbors(std::uint32_t v) const { return ground->neighbors(v); }
    [[nodiscard]] std::int64_t capacity(std::uint32_t v) const { return ground->capacity(v); }
  };

  std::vector<std::uint32_t> unknown_;
  LakeGround ground_;
  MoatPacking<GroundOf> packing_;
  std::vector<std::uint8_t> is_spent_;
  std::vector<std::uint32_t> spent_;
};

LakeBound::LakeBound(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
                     std::span<const std::uint8_t> is_known, ChangeMeasure measure)
    : state_(std::make_unique<State>(terrain, level, is_known, measure)) {
  assert(level.size() == terrain.height.size() && (is_known.empty() || is_known.size() == level.size()));
}

LakeBound::~LakeBound() = default;

std::int64_t LakeBound::run(std::span<const std::uint32_t> lake, std::vector<std::uint32_t>& unknown) {
  return state_->run(lake, unknown);
}

std::int64_t sum_of_lake_bounds(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
                                ChangeMeasure measure) {
  LakeBound bound(terrain, level, {}, measure);
  std::vector<std::uint8_t> is_seen(level.size(), 0);
  std::vector<std::uint32_t> lake, unknown;
  Wide sum = 0;
  for (std::uint32_t seed = 0; seed < is_seen.size(); ++seed) {
    if (is_seen[seed] || level[seed] == terrain.height[seed] || level[seed] == kNoLevel) continue;
    lake.assign(1, seed);
    is_seen[seed] = 1;
    for (std::size_t next = 0; next < lake.size(); ++next)
      for (const std::uint32_t w : terrain.graph->neighbors(lake[next])) {
        if (is_seen[w] || level[w] == terrain.height[w]) continue;
        is_seen[w] = 1;
        lake.push_back(w);
      }
    sum += bound.run(lake, unknown);
  }
  return static_cast<std::int64_t>(std::min<Wide>(sum, std::numeric_limits<std::int64_t>::max()));
}

}  // namespace hydrotin
