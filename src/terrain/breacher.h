#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "breach_search.h"
#include "hydrotin/lake_breaches.h"

namespace hydrotin {

/// The terrain as `BreachSearch` sees it.
struct TerrainGround {
  const ChangeableTerrain* terrain;
  std::span<const std::int32_t> flood_level;
  std::span<const std::uint8_t> is_known;  // empty: all
  std::vector<std::uint32_t>* unknown;     // vertices looked at that are not
  ChangeMeasure measure;
  std::int64_t max_depth;
  bool any_drained_is_goal = false;  // for water that has been raised to `level`
  bool has_goals = true;             // else all in reach is looked at

  [[nodiscard]] std::span<const std::uint32_t> neighbors(std::uint32_t v) const {
    if (!is_known.empty() && !is_known[v]) unknown->push_back(v);
    return terrain->graph->neighbors(v);
  }
  [[nodiscard]] std::int64_t cost(std::uint32_t v, std::int32_t level) const {
    const std::int64_t depth = std::int64_t{terrain->height[v]} - level;
    if (depth <= 0) return 0;
    if (depth > max_depth || terrain->is_outlet[v]) return -1;
    if (!terrain->lower.empty() && terrain->lower[v] > level) return -1;
    if (measure == ChangeMeasure::count) return 1;
    return depth * (terrain->weight.empty() ? 1 : terrain->weight[v]);
  }
  [[nodiscard]] bool is_goal(std::uint32_t v, std::int32_t level) const {
    if (!has_goals) return false;
    if (any_drained_is_goal) return flood_level[v] <= level;
    const std::int32_t h = terrain->height[v];
    return h < level || (h == level && flood_level[v] == h);
  }
  /// The same for heights up to `top` only.
  [[nodiscard]] TerrainGround limited_to(std::int32_t top, std::int32_t level) const {
    TerrainGround ground = *this;
    ground.max_depth = std::min(max_depth, std::int64_t{top} - level);
    return ground;
  }
  [[nodiscard]] static bool is_exit(std::uint32_t, std::int32_t) { return false; }
  [[nodiscard]] bool before(std::uint32_t v, std::uint32_t w) const {
    return terrain->position[v] < terrain->position[w];
  }
};

/// Searches of many pits, one after the other.
class Breacher {
 public:
  Breacher(const ChangeableTerrain& terrain, std::span<const std::int32_t> flood_level,
           std::span<const std::uint8_t> is_known, const OutletHeights& outlets, ChangeMeasure measure,
           const BreachLimits& limits);

  /// Whether the pit can be breached within the limits.
  /// @param to_the_end  where visits are limited: looks as far as the size of the lake allows
  bool run(std::span<const std::uint32_t> plateau, bool to_the_end = false);
  /// Whether the last search was ended by too many visits.
  [[nodiscard]] bool is_unfinished() const { return is_unfinished_; }
  /// The way of water that is raised just so far that it can leave by a breach. For pits below all outlets in reach;
  /// where visits are limited, after `run` to the end for the same pit.
  bool run_raised(std::span<const std::uint32_t> plateau);
  void set_lake_size(std::uint64_t num_vertices) { lake_size_ = num_vertices; }

  [[nodiscard]] const BreachSearch& search() const { return search_; }
  [[nodiscard]] std::span<const std::uint32_t> neighbors(std::uint32_t v) const { return ground_.neighbors(v); }
  /// In terms of the measure.
  [[nodiscard]] std::int64_t cost() const;
  [[nodiscard]] double length() const;
  [[nodiscard]] std::vector<std::uint32_t> take_unknown();

 private:
  struct Bottleneck {
    std::int64_t depth = -1;  // none
    bool is_unfinished = false;
  };
  [[nodiscard]] bool is_bounded() const { return limits_.max_visits != ~std::uint64_t{0}; }
  [[nodiscard]] bool is_hopeless(std::uint32_t v) const;
  [[nodiscard]] std::uint64_t lake_visits() const { return std::max(limits_.max_visits, 4 * lake_size_); }
  /// What may be looked at for the lake of a pit: nothing above its level.
  [[nodiscard]] TerrainGround lake_ground(std::uint32_t pit) const {
    return ground_.limited_to(ground_.flood_level[pit], terrain_->height[pit]);
  }
  bool run_to_lowest_drain(std::span<const std::uint32_t> plateau);
  [[nodiscard]] std::int32_t lowest_outlet_around(std::uint32_t seed) const;
  Bottleneck bottleneck_depth(const TerrainGround& ground, std::span<const std::uint32_t> plateau, std::int32_t level,
                              std::uint64_t max_visits);
  bool run_on(TerrainGround ground, std::span<const std::uint32_t> plateau, std::int32_t level,
              std::uint64_t max_visits);
  bool run_raised_to(std::span<const std::uint32_t> plateau, std::int32_t level);

  const ChangeableTerrain* terrain_;
  std::vector<std::uint32_t> unknown_;
  TerrainGround ground_;
  BreachLimits limits_;
  OutletHeights outlets_;
  BreachSearch search_;
  std::uint64_t lake_size_ = 0;
  bool is_unfinished_ = false;
  std::uint32_t explored_ = kNoVertexNumber;  // pit whose search to the end was the last, without success
  std::vector<std::uint32_t> touched_;
  std::vector<std::uint8_t> is_touched_;
};

}  // namespace hydrotin
