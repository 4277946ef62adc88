#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "hydrotin/wide.h"

namespace hydrotin {

/// Packs the closed neighbourhoods of the pieces around pits, level by level (change_bound.h).
///
/// Ground provides
///   neighbors(v)   range of vertices
///   height(v)
///   capacity(v)    what a piece may charge for a level of v at most; looked at once v is in a neighbourhood
template <class Ground>
class MoatPacking {
 public:
  /// @param only_once  a piece is its pit with its neighbours, and claims them at all levels
  MoatPacking(Ground ground, std::size_t num_vertices, bool only_once)
      : ground_(std::move(ground)),
        only_once_(only_once),
        first_claim_(num_vertices, kNone),
        entered_(num_vertices, kFree) {}

  /// What the pieces around one pit, up to `top`, add to the bound. Nothing at the levels from which on more than 4096
  /// vertices must be looked at.
  /// Complexity: O(b log b), b <= 4096 vertices with their neighbours.
  Wide add_pit(std::uint32_t pit, std::int64_t top) {
    reached_.clear();
    heap_.clear();
    at_bottom_.clear();
    weight_ = std::int64_t{1} << 62;
    const std::int64_t lowest = ground_.height(pit);
    std::int64_t bottom = lowest;
    Wide gain = 0;
    stop_ = only_once_ ? bottom + 1 : top;
    std::size_t num_visits = 0;
    reach(pit, bottom);
    while (bottom < stop_ && !heap_.empty()) {
      // The piece at levels bottom + 1 .. next: all that is connected below them.
      while (!heap_.empty() && heap_.front().first <= bottom && num_visits < kMaxVisits && stop_ > bottom) {
        std::pop_heap(heap_.begin(), heap_.end(), std::greater<>{});
        const auto [height, v] = heap_.back();
        heap_.pop_back();
        ++num_visits;
        if (height == lowest && bottom == lowest) at_bottom_.push_back(v);
        for (const std::uint32_t w : ground_.neighbors(v)) {
          if (entered_[w] != kFree) continue;
          if (ground_.height(w) < lowest) stop_ = std::min(stop_, bottom);  // it is another's piece now
          reach(w, bottom);
        }
      }
      if (num_visits >= kMaxVisits || heap_.empty() || stop_ <= bottom) break;
      const std::int64_t next = std::min<std::int64_t>(heap_.front().first, stop_);
      gain += static_cast<Wide>(next - bottom) * weight_;
      bottom = next;
    }
    for (const std::uint32_t v : reached_) {
      if (entered_[v] < bottom) {
        if (first_claim_[v] == kNone) claimed_.push_back(v);
        claims_.push_back({only_once_ ? kLowest : entered_[v], only_once_ ? kHighest : bottom, first_claim_[v]});
        first_claim_[v] = static_cast<std::uint32_t>(claims_.size() - 1);
      }
      entered_[v] = kFree;
    }
    return gain;
  }

  /// Vertices as low as the pit that the last call visited: of the same plateau.
  [[nodiscard]] const std::vector<std::uint32_t>& at_bottom() const { return at_bottom_; }

  /// Forgets all claims.
  void clear() {
    for (const std::uint32_t v : claimed_) first_claim_[v] = kNone;
    claimed_.clear();
    claims_.clear();
  }

 private:
  static constexpr std::size_t kMaxVisits = 4096;
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr std::int64_t kFree = std::int64_t{1} << 62, kLowest = -kFree, kHighest = kFree - 1;
  struct Claim {
    std::int64_t first, last;  // levels first + 1 .. last
    std::uint32_t next;        // of the same vertex
  };

  // v belongs to the neighbourhood for all levels above `level`. Claims of others end the growth in time.
  void reach(std::uint32_t v, std::int64_t level) {
    entered_[v] = level;
    reached_.push_back(v);
    heap_.emplace_back(ground_.height(v), v);
    std::push_heap(heap_.begin(), heap_.end(), std::greater<>{});
    weight_ = std::min<std::int64_t>(weight_, ground_.capacity(v));
    for (std::uint32_t i = first_claim_[v]; i != kNone; i = claims_[i].next)
      if (claims_[i].last > level) stop_ = std::min(stop_, std::max(level, claims_[i].first));
  }

  Ground ground_;
  bool only_once_;
  std::vector<std::uint32_t> first_claim_, claimed_, reached_, at_bottom_;
  std::vector<std::int64_t> entered_;
  std::vector<Claim> claims_;
  std::vector<std::pair<std::int64_t, std::uint32_t>> heap_;
  std::int64_t stop_ = 0, weight_ = 0;
};

}  // namespace hydrotin
