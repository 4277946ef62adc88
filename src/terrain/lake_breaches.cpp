#include "hydrotin/lake_breaches.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <tuple>
#include <utility>

#include "breacher.h"
#include "sifted.h"

namespace hydrotin {

OutletHeights outlet_heights(const ChangeableTerrain& terrain) {
  OutletHeights lowest;
  for (std::size_t v = 0; v < terrain.height.size(); ++v) {
    std::int32_t& best = terrain.is_outlet[v] ? lowest.lowest_outlet : lowest.lowest_inner;
    best = std::min(best, terrain.height[v]);
  }
  return lowest;
}

class LakeBreacher::State {
 public:
  State(const ChangeableTerrain& terrain, std::span<const std::int32_t> level, std::span<const std::uint8_t> is_known,
        const OutletHeights& outlets, MemberReach reach, ChangeMeasure measure, const BreachLimits& limits)
      : terrain_(&terrain),
        level_(level),
        is_known_(is_known),
        reach_(reach),
        is_bounded_(limits.max_visits != ~std::uint64_t{0}),
        breacher_(terrain, level, is_known, outlets, measure, limits),
        is_seen_(terrain.height.size(), 0) {}

  std::span<const std::uint32_t> lake_around(std::uint32_t seed) {
    lake_.assign(1, seed);
    low_.clear();
    is_seen_[seed] = 1;
    for (std::size_t next = 0; next < lake_.size(); ++next) {
      const std::uint32_t v = lake_[next];
      std::int32_t lowest = kNoLevel;
      for_each_of(
          terrain_->graph->neighbors(v),
          [&](std::uint32_t w) {
            lowest = std::min(lowest, height(w));
            return (level_[w] != height(w)) & (is_seen_[w] == 0);
          },
          [&](std::uint32_t w) {
            is_seen_[w] = 1;
            lake_.push_back(w);
          });
      if (lowest >= height(v)) low_.push_back(v);
    }
    for (const std::uint32_t v : lake_) is_seen_[v] = 0;
    return lake_;
  }

  void run(LakeBreaches& result) {
    result = {};
    result_ = &result;
    if (!is_known_.empty())
      for (const std::uint32_t v : lake_)
        if (!is_known_[v]) result.unknown.push_back(v);
    if (!result.unknown.empty()) return;
    find_pits();
    if (reach_ == MemberReach::lifted) return;
    breacher_.set_lake_size(lake_.size());
    search_all();
    result.unknown = breacher_.take_unknown();
  }

 private:
  [[nodiscard]] std::int32_t height(std::uint32_t v) const { return terrain_->height[v]; }

  struct Found {
    std::uint32_t first, begin, end;
  };

  // Pits ascending by (height, x, y), each with its plateau. A pit is a plateau without a lower neighbour.
  void find_pits() {
    found_.clear();
    seen_.clear();
    for (const std::uint32_t seed : low_) {
      if (is_seen_[seed]) continue;
      const auto begin = static_cast<std::uint32_t>(seen_.size());
      bool is_pit = true;
      seen_.push_back(seed);
      is_seen_[seed] = 1;
      for (std::size_t next = begin; next < seen_.size(); ++next)
        for (const std::uint32_t w : terrain_->graph->neighbors(seen_[next])) {
          is_pit &= height(w) >= height(seed);
          if (height(w) != height(seed) || is_seen_[w]) continue;
          is_seen_[w] = 1;
          seen_.push_back(w);
        }
      std::uint32_t first = seed;
      for (std::size_t i = begin; i < seen_.size(); ++i)
        if (terrain_->position[seen_[i]] < terrain_->position[first]) first = seen_[i];
      // Plateaus that are no pits stay in the list until all are seen: their vertices must not be visited again.
      if (is_pit) found_.push_back({first, begin, static_cast<std::uint32_t>(seen_.size())});
    }
    for (const std::uint32_t v : seen_) is_seen_[v] = 0;
    std::sort(found_.begin(), found_.end(), [&](const Found& a, const Found& b) {
      return std::tuple(height(a.first), terrain_->position[a.first]) <
             std::tuple(height(b.first), terrain_->position[b.first]);
    });
    plateau_begin_.assign(1, 0);
    plateau_vertex_.clear();
    for (const Found& pit : found_) {
      result_->pit.push_back(pit.first);
      plateau_vertex_.insert(plateau_vertex_.end(), seen_.begin() + pit.begin, seen_.begin() + pit.end);
      plateau_begin_.push_back(static_cast<std::uint32_t>(plateau_vertex_.size()));
    }
  }

  [[nodiscard]] std::span<const std::uint32_t> plateau(std::size_t pit) const {
    return {plateau_vertex_.data() + plateau_begin_[pit], plateau_vertex_.data() + plateau_begin_[pit + 1]};
  }

  void search_all() {
    std::vector<std::size_t> unfinished, unbreached;
    for (std::size_t i = 0; i < result_->pit.size(); ++i) {
      if (breacher_.run(plateau(i)))
        add_path(i, reach_ == MemberReach::centers);
      else
        (breacher_.is_unfinished() ? unfinished : unbreached).push_back(i);
    }
    result_->num_unfinished = unfinished.size();
    if (!unfinished.empty()) {  // the lowest one opens the lake
      if (breacher_.run(plateau(unfinished.front()), true))
        add_path(unfinished.front(), false);
      else
        unbreached.push_back(unfinished.front());
    }
    result_->num_unbreached = unbreached.size();
    std::sort(unbreached.begin(), unbreached.end());
    const std::size_t num_raised = is_bounded_ ? std::min<std::size_t>(unbreached.size(), 1) : unbreached.size();
    for (std::size_t i = 0; i < num_raised; ++i) add_raised_path(unbreached[i]);
  }

  void add(std::uint32_t v, std::int32_t level) {
    result_->vertex.push_back(v);
    result_->level.push_back(level);
  }

  void add_path(std::size_t pit, bool with_centers) {
    const std::int32_t level = height(result_->pit[pit]);
    const BreachSearch& search = breacher_.search();
    const std::int64_t cost = search.cost();
    result_->dearest = std::max(result_->dearest, breacher_.cost());
    for (const std::uint32_t v : search.path().first(search.path().size() - 1)) add(v, level);
    if (!with_centers) return;
    const auto may_meet = [&](std::uint32_t v) { return !terrain_->is_outlet[v] && height(v) >= level; };
    for (const std::uint32_t v : search.touched()) {
      if (search.cost_to(v) >= cost) continue;
      if (may_meet(v)) add(v, kNoLevel);
      for (const std::uint32_t w : breacher_.neighbors(v))
        if (may_meet(w)) add(w, kNoLevel);
    }
  }

  void add_raised_path(std::size_t pit) {
    if (!breacher_.run_raised(plateau(pit))) return;
    const auto path = breacher_.search().path();
    for (const std::uint32_t v : path)
      if (!terrain_->is_outlet[v]) add(v, level_[path.back()]);
  }

  const ChangeableTerrain* terrain_;
  std::span<const std::int32_t> level_;
  std::span<const std::uint8_t> is_known_;
  MemberReach reach_;
  bool is_bounded_;
  Breacher breacher_;
  std::vector<std::uint8_t> is_seen_;
  std::vector<std::uint32_t> lake_, low_;  // the lake; those of it without a lower neighbour
  std::vector<Found> found_;
  std::vector<std::uint32_t> seen_, plateau_begin_, plateau_vertex_;
  LakeBreaches* result_ = nullptr;
};

LakeBreacher::LakeBreacher(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
                           std::span<const std::uint8_t> is_known, const OutletHeights& outlets, MemberReach reach,
                           ChangeMeasure measure, const BreachLimits& limits)
    : state_(std::make_unique<State>(terrain, level, is_known, outlets, reach, measure, limits)) {
  assert(level.size() == terrain.height.size() && (is_known.empty() || is_known.size() == level.size()));
}

LakeBreacher::~LakeBreacher() = default;

std::span<const std::uint32_t> LakeBreacher::lake_around(std::uint32_t seed) {
  return state_->lake_around(seed);
}

void LakeBreacher::run(LakeBreaches& result) {
  state_->run(result);
}

}  // namespace hydrotin
