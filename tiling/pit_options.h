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
  template <class AnySurface>
  ChangeableSurface(const RunContext& context, const AnySurface& surface) {
    terrain_ = {&surface.graph, surface.height, surface.position, surface.is_outlet, {}, {}, {}};
    set_weights(context, surface.triangle);
    set_bounds(context);
  }
  ChangeableSurface(const ChangeableSurface&) = delete;
  ChangeableSurface& operator=(const ChangeableSurface&) = delete;

  [[nodiscard]] const ChangeableTerrain& view() const { return terrain_; }
  /// Doubled areas of the stars; right for vertices that have all their triangles.
  [[nodiscard]] std::span<const std::int64_t> star() const { return star_; }

 private:
  void set_weights(const RunContext& context, std::span<const std::uint32_t> triangle);
  void set_bounds(const RunContext& context);

  ChangeableTerrain terrain_;
  std::vector<std::int64_t> star_;
  HeightBounds bounds_;
};

}  // namespace hydrotin
