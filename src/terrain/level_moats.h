#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "hydrotin/pit_components.h"
#include "hydrotin/wide.h"
#include "min_heap.h"

namespace hydrotin {

/// Moats around pits, level by level, as wide as the way out of the pit is long: a lower bound on the cost of removing
/// all pits, in the measures total, volume and count.
///
/// Look at one level t, at a pit and at K, what is connected to it below t. Let S_0 = K and S_1, S_2, ... be sets
/// around it, each with the neighbours of the one before, none with an outlet below t. A surface without pits has all
/// of K at t or above, or some vertex of K below t, and then water that runs from there to an outlet, below t all the
/// way: it leaves every S_i by a neighbour below t. The neighbours of S_i that were not below t before, and are not in
/// S_i, are those of S_i alone, so the surface costs at least min(weight of K, number of sets) at this level. With
/// weights, sets grow like circles: a vertex of weight w is within the front while the radius grows by w; then the cost
/// is at least min(weight of K, radius). Pits share out the weight of each vertex at each level; what is used up can be
/// crossed at no cost. Each K is asked for once, by its lowest vertex.
///
/// A band of levels is treated like one level: with K as at its lowest, and what is below its highest level free to
/// cross. Bands are halved, some times, where their lowest level alone would give more.
///
/// For the measure count each pit chooses one level, all weights are 1, and what it uses, of K too, is used up at all
/// levels.
///
/// Source   own; the dual of shortest paths and of prize-collecting Steiner trees.
class LevelMoats {
 public:
  /// @param level      [n] of `lift`.
  /// @param may_raise  false: bounds surfaces that raise nothing, where the weight of K does not count.
  LevelMoats(const ChangeableTerrain& terrain, std::span<const std::int32_t> level, ChangeMeasure measure,
             bool may_raise);

  /// What the moats of a pit add to the bound; nothing if it is not the lowest vertex, by (height, x, y), of anything.
  /// Looks at up to 4096 vertices for K and for each of up to 48 moats; after 500 n vertices and claims in all, adds
  /// nothing more: so the pits that matter come first.
  [[nodiscard]] Wide add_pit(std::uint32_t pit);

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr std::size_t kMostVisits = 4096;
  static constexpr int kMostHalvings = 4;
  static constexpr std::uint64_t kMostWork = 500;  // per vertex
  __extension__ using Key = unsigned __int128;     // radius, rank

  struct Band {
    std::int32_t below, top;  // levels below + 1 .. top
  };
  static constexpr Band kAllLevels{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()};
  struct Claim {
    Band band;
    std::int64_t amount;
    std::uint32_t next;  // of the same vertex
  };
  struct Reached {
    std::uint32_t v;
    std::int64_t radius, capacity;  // when the front comes to it; what it can pay
  };

  struct PieceVertex {
    std::int32_t water;  // that reaches it
    std::uint32_t v;
    std::int64_t sum;  // of weights, of all before too
  };

  [[nodiscard]] std::int64_t weight(std::uint32_t v) const {
    return is_count_ || terrain_->weight.empty() ? 1 : terrain_->weight[v];
  }
  [[nodiscard]] bool is_before(std::uint32_t v, std::uint32_t w) const;
  std::int32_t find_piece(std::uint32_t pit);
  [[nodiscard]] std::size_t size_of_piece(std::int32_t level) const;
  [[nodiscard]] std::int64_t most_at(std::int32_t level) const;
  Wide fill_one_level(std::uint32_t pit, Band levels);
  Wide fill_band(std::uint32_t pit, Band band, int halvings);
  std::int64_t grow(std::uint32_t pit, Band band, std::int64_t most);
  void reach(std::uint32_t v, Band band, std::int64_t radius);
  [[nodiscard]] std::int64_t capacity(std::uint32_t v, Band band);
  [[nodiscard]] bool has_time() const { return work_ < kMostWork * mark_.size(); }
  void claim(std::uint32_t v, Band band, std::int64_t amount);
  void claim_moat(Band band, std::int64_t radius);

  const ChangeableTerrain* terrain_;
  std::span<const std::int32_t> level_;
  bool is_count_, may_raise_;
  std::uint64_t work_ = 0;
  std::vector<std::uint32_t> by_rank_, rank_;  // [n] vertices by (x, y): searches do not depend on the numbering
  std::vector<std::uint32_t> mark_;            // [n] of the last search that reached a vertex
  std::uint32_t search_ = 0;
  std::vector<PieceVertex> piece_;
  std::vector<std::uint32_t> first_claim_;  // [n]
  std::vector<Claim> claim_;
  std::vector<Reached> reached_;
  BasicMinHeap<Key> heap_;
};

}  // namespace hydrotin
