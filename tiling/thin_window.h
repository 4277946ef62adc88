#pragma once

#include <cstdint>
#include <vector>

#include "hydrotin/thinning.h"
#include "phases.h"

/// The points around a tile, for thinning.
///
/// A window of whole grid cells around the tile's own points, cut to the bounds of the data, in which blocks are
/// settled; and what decides about the blocks that meet it. Points in doubt ask for a wider window on the sides where
/// the doubt came from.
///
/// Threads  One object by one thread.

namespace hydrotin {

class ThinWindow {
 public:
  /// @param cell, grid_x, grid_y  of the grid, lattice units
  ThinWindow(const RunContext& context, std::uint32_t tile, const ThinningOptions& options);

  /// Points 0 .. num_own are the tile's, points 0 .. num_inside the window's; then those beyond it that the blocks
  /// need, and the vertices of the hull of all points.
  [[nodiscard]] const std::vector<LatticePoint>& position() const { return position_; }

  /// Thins the blocks and settles them in the window: of the points 0 .. num_inside, and hull vertices beyond.
  [[nodiscard]] Thinning thin() const;

  [[nodiscard]] const std::vector<std::int32_t>& height() const { return height_; }
  [[nodiscard]] std::uint32_t num_own() const { return num_own_; }

  /// Widens the window on the open sides nearest to points in doubt and loads what is new. False: none was in doubt.
  bool widen(const std::vector<std::uint8_t>& doubtful);

 private:
  void cut();
  void load();

  const RunContext& context_;
  std::uint32_t tile_, num_own_ = 0, num_inside_ = 0;
  ThinningOptions options_;
  std::int64_t left_ = 0, right_ = 0, below_ = 0, above_ = 0;  // margins in cells
  ThinningWindow window_;
  std::vector<LatticePoint> position_;
  std::vector<std::int32_t> height_;
};

}  // namespace hydrotin
