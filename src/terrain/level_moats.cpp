#include "level_moats.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

#include "height_key.h"

namespace hydrotin {
namespace {

constexpr std::int64_t kBoundless = std::int64_t{1} << 62;

}  // namespace

LevelMoats::LevelMoats(const ChangeableTerrain& terrain, std::span<const std::int32_t> level, ChangeMeasure measure,
                       bool may_raise)
    : terrain_(&terrain),
      level_(level),
      is_count_(measure == ChangeMeasure::count),
      may_raise_(may_raise),
      mark_(level.size(), 0),
      first_claim_(level.size(), kNone) {
  by_rank_.resize(level.size());
  std::iota(by_rank_.begin(), by_rank_.end(), 0u);
  std::sort(by_rank_.begin(), by_rank_.end(),
            [&](std::uint32_t v, std::uint32_t w) { return terrain.position[v] < terrain.position[w]; });
  rank_.resize(level.size());
  for (std::uint32_t i = 0; i < rank_.size(); ++i) rank_[by_rank_[i]] = i;
}

Wide LevelMoats::add_pit(std::uint32_t pit) {
  if (!has_time()) return 0;
  const std::int32_t bottom = terrain_->height[pit], top = find_piece(pit);
  work_ += piece_.size();
  if (top <= bottom) return 0;
  return is_count_ ? fill_one_level(pit, {bottom, top}) : fill_band(pit, {bottom, top}, kMostHalvings);
}

bool LevelMoats::is_before(std::uint32_t v, std::uint32_t w) const {
  return std::tie(terrain_->height[v], rank_[v]) < std::tie(terrain_->height[w], rank_[w]);
}

// Lists what is connected to the pit below its level, and returns the highest level at which the pit is the lowest.
std::int32_t LevelMoats::find_piece(std::uint32_t pit) {
  piece_.clear();
  heap_.clear();
  ++search_;
  std::int32_t water = terrain_->height[pit], top = level_[pit];
  std::int64_t sum = 0;
  mark_[pit] = search_;
  heap_.push(height_key(water, rank_[pit]));
  while (!heap_.empty()) {
    const auto key = static_cast<std::uint64_t>(heap_.pop());
    const std::uint32_t v = by_rank_[static_cast<std::uint32_t>(key)];
    water = std::max(water, terrain_->height[v]);
    if (water >= top || piece_.size() == kMostVisits) break;
    sum += weight(v);
    piece_.push_back({water, v, sum});
    for (const std::uint32_t w : terrain_->graph->neighbors(v)) {
      if (mark_[w] == search_) continue;
      mark_[w] = search_;
      if (is_before(w, pit)) top = water;
      heap_.push(height_key(terrain_->height[w], rank_[w]));
    }
  }
  return std::min(top, water);
}

// Of what is connected below a level: the first vertices listed.
std::size_t LevelMoats::size_of_piece(std::int32_t level) const {
  const auto end = std::lower_bound(piece_.begin(), piece_.end(), level,
                                    [](const PieceVertex& p, std::int32_t t) { return p.water < t; });
  return static_cast<std::size_t>(end - piece_.begin());
}

// What it costs to raise all that is connected below a level.
std::int64_t LevelMoats::most_at(std::int32_t level) const {
  if (!may_raise_) return kBoundless;
  const std::size_t size = size_of_piece(level);
  if (!is_count_) return size == 0 ? 0 : piece_[size - 1].sum;
  return std::count_if(piece_.begin(), piece_.begin() + static_cast<std::ptrdiff_t>(size),
                       [&](const PieceVertex& p) { return first_claim_[p.v] == kNone; });
}

// Looks at the levels where the piece has one vertex, two, four, ..., and all.
Wide LevelMoats::fill_one_level(std::uint32_t pit, Band levels) {
  std::int64_t widest = 0;
  std::int32_t best = 0;
  const auto look_at = [&](std::int32_t level) {
    if (level > levels.top) return;
    const std::int64_t radius = grow(pit, {level - 1, level}, most_at(level));
    if (radius > widest) best = level;
    widest = std::max(widest, radius);
  };
  for (std::size_t size = 1; size <= piece_.size(); size *= 2) look_at(piece_[size - 1].water + 1);
  look_at(levels.top);
  if (widest == 0) return 0;
  grow(pit, {best - 1, best}, widest);
  claim_moat(kAllLevels, widest);
  for (std::size_t i = 0; i < size_of_piece(best); ++i) claim(piece_[i].v, kAllLevels, 1);
  return widest;
}

Wide LevelMoats::fill_band(std::uint32_t pit, Band band, int halvings) {
  const std::int64_t radius = grow(pit, band, most_at(band.below + 1));
  if (std::int64_t{band.top} - band.below > 1 && halvings > 0 && has_time()) {
    const std::int64_t widest = grow(pit, {band.below, band.below + 1}, most_at(band.top));
    if (widest > radius) {
      const auto middle = static_cast<std::int32_t>((std::int64_t{band.below} + band.top) >> 1);
      return fill_band(pit, {band.below, middle}, halvings - 1) + fill_band(pit, {middle, band.top}, halvings - 1);
    }
    grow(pit, band, radius);
  }
  claim_moat(band, radius);
  return static_cast<Wide>(radius) * (std::int64_t{band.top} - band.below);
}

// How far the moat can grow. Vertices join it in the order of radius; each is reached once, by the first neighbour.
std::int64_t LevelMoats::grow(std::uint32_t pit, Band band, std::int64_t most) {
  reached_.clear();
  heap_.clear();
  ++search_;
  reach(pit, band, 0);
  std::int64_t radius = most, at = 0;
  std::size_t num_visits = 0;
  while (!heap_.empty()) {
    const Key key = heap_.pop();
    const std::uint32_t v = by_rank_[static_cast<std::uint32_t>(key)];
    at = static_cast<std::int64_t>(key >> 32);
    if (at >= most) break;
    if (level_[v] < band.top || num_visits == kMostVisits) {  // water leaves from here
      radius = at;
      break;
    }
    ++num_visits;
    for (const std::uint32_t w : terrain_->graph->neighbors(v))
      if (mark_[w] != search_) reach(w, band, at);
  }
  if (heap_.empty() && most == kBoundless) radius = at;  // no way out
  return radius;
}

void LevelMoats::reach(std::uint32_t v, Band band, std::int64_t radius) {
  mark_[v] = search_;
  const bool is_wall = terrain_->height[v] >= band.top &&
                       (terrain_->is_outlet[v] || (!terrain_->lower.empty() && terrain_->lower[v] >= band.top));
  if (is_wall) return;  // nothing gets by here
  const std::int64_t can_pay = capacity(v, band);
  reached_.push_back({v, radius, can_pay});
  heap_.push(static_cast<Key>(std::min(radius + can_pay, kBoundless)) << 32 | rank_[v]);
  ++work_;
}

std::int64_t LevelMoats::capacity(std::uint32_t v, Band band) {
  if (terrain_->height[v] < band.top) return 0;
  std::int64_t left = weight(v);
  for (std::uint32_t i = first_claim_[v]; i != kNone; i = claim_[i].next, ++work_)
    if (claim_[i].band.below < band.top && band.below < claim_[i].band.top) left -= claim_[i].amount;
  return std::max<std::int64_t>(left, 0);
}

// For what the last moat reached.
void LevelMoats::claim_moat(Band band, std::int64_t radius) {
  for (const Reached& r : reached_) {
    const std::int64_t amount = std::min(r.capacity, radius - r.radius);
    if (amount > 0) claim(r.v, band, amount);
  }
}

void LevelMoats::claim(std::uint32_t v, Band band, std::int64_t amount) {
  if (const std::uint32_t last = first_claim_[v];
      last != kNone && claim_[last].amount == amount && !is_count_ && claim_[last].band.top == band.below) {
    claim_[last].band.top = band.top;
    return;
  }
  claim_.push_back({band, amount, first_claim_[v]});
  first_claim_[v] = static_cast<std::uint32_t>(claim_.size() - 1);
}

}  // namespace hydrotin
