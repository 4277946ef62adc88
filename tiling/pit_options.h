#pragma once

#include <cstdint>
#include <vector>

#include "hydrotin/pit_removal.h"
#include "hydrotin/pit_units.h"
#include "phases.h"

/// The options of pit removal in lattice units.

namespace hydrotin {

[[nodiscard]] RemovalOptions removal_options(const RunContext& context);

/// A surface as the room `terrain` changes it, with the arrays that its spans refer to.
class ChangeableSurface {
 public:
  /// @param with_stars  find the stars in any case, not only for a measure that weighs by them.
  template <class AnySurface>
  ChangeableSurface(const RunContext& context, const AnySurface& surface, bool with_stars = true) {
    terrain_ = {&surface.graph, surface.height, surface.position, surface.is_outlet, {}, {}, {}};
    if (with_stars || context.options.pits.measure == ChangeMeasure::volume) set_weights(context, surface.triangle);
    set_bounds(context);
    if (context.rivers) keep_rivers(context, surface.point, surface.level);
  }
  ChangeableSurface(const ChangeableSurface&) = delete;
  ChangeableSurface& operator=(const ChangeableSurface&) = delete;

  [[nodiscard]] const ChangeableTerrain& view() const { return terrain_; }
  /// Doubled areas of the stars, if they were asked for; right for vertices that have all their triangles.
  [[nodiscard]] std::span<const std::int64_t> star() const { return star_; }

 private:
  void set_weights(const RunContext& context, std::span<const std::uint32_t> triangle);
  void set_bounds(const RunContext& context);
  void keep_rivers(const RunContext& context, std::span<const std::uint64_t> point,
                   std::span<const std::int32_t> level);

  ChangeableTerrain terrain_;
  std::vector<std::int64_t> star_;
  HeightBounds bounds_;
};

}  // namespace hydrotin
