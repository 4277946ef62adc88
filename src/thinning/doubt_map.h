#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "hydrotin/thinning.h"

/// Where the points kept may differ from those of the whole data set: pixels of the window, and all beyond its open
/// sides.
///
/// Marks are collected and take effect together (`settle`), because all decisions of a round rest on what was certain
/// before it. A table of sums answers for any box in constant time.

namespace hydrotin::thinning {

class DoubtMap {
 public:
  /// @param pitch  side of a pixel; pixels are made wider where the window would have more than `most` of them
  DoubtMap(const ThinningWindow& window, std::int64_t pitch, std::uint64_t most) : window_(window) {
    const std::int64_t width = std::int64_t{window.box.max.x} - window.box.min.x + 1;
    const std::int64_t height = std::int64_t{window.box.max.y} - window.box.min.y + 1;
    pitch_ = std::max<std::int64_t>(pitch, 1);
    while (pixels(width) * pixels(height) > std::max<std::uint64_t>(most, 1)) pitch_ *= 2;
    columns_ = pixels(width);
    rows_ = pixels(height);
    marked_.assign(columns_ * rows_, 0);
    sum_.assign((columns_ + 1) * (rows_ + 1), 0);
  }

  [[nodiscard]] bool is_open() const {
    return window_.open_left || window_.open_right || window_.open_below || window_.open_above;
  }

  /// Takes effect when the map settles.
  void mark(LatticePoint p) {
    if (!window_.box.contains(p)) return;  // beyond the window all is in doubt anyway
    std::uint8_t& at = marked_[row_of(p.y) * columns_ + column_of(p.x)];
    has_changed_ = has_changed_ || at == 0;
    at = 1;
  }

  /// Whether anything was marked since the last time.
  bool settle() {
    if (!has_changed_) return false;
    has_changed_ = false;
    for (std::uint64_t r = 0; r < rows_; ++r) {
      std::uint32_t in_row = 0;
      for (std::uint64_t c = 0; c < columns_; ++c) {
        in_row += marked_[r * columns_ + c];
        sum_[(r + 1) * (columns_ + 1) + c + 1] = sum_[r * (columns_ + 1) + c + 1] + in_row;
      }
    }
    return true;
  }

  /// Whether anything in the closed box is in doubt.
  [[nodiscard]] bool any(const LatticeBox& box) const {
    const LatticeBox& w = window_.box;
    if ((window_.open_left && box.min.x < w.min.x) || (window_.open_right && box.max.x > w.max.x) ||
        (window_.open_below && box.min.y < w.min.y) || (window_.open_above && box.max.y > w.max.y))
      return true;
    if (!box.intersects(w)) return false;
    const std::uint64_t c0 = column_of(std::max(box.min.x, w.min.x)), c1 = column_of(std::min(box.max.x, w.max.x)) + 1;
    const std::uint64_t r0 = row_of(std::max(box.min.y, w.min.y)), r1 = row_of(std::min(box.max.y, w.max.y)) + 1;
    const auto at = [&](std::uint64_t r, std::uint64_t c) { return sum_[r * (columns_ + 1) + c]; };
    return at(r1, c1) - at(r0, c1) - at(r1, c0) + at(r0, c0) != 0;
  }

 private:
  [[nodiscard]] std::uint64_t pixels(std::int64_t length) const {
    return static_cast<std::uint64_t>((length + pitch_ - 1) / pitch_);
  }
  [[nodiscard]] std::uint64_t column_of(std::int32_t x) const {
    return static_cast<std::uint64_t>((std::int64_t{x} - window_.box.min.x) / pitch_);
  }
  [[nodiscard]] std::uint64_t row_of(std::int32_t y) const {
    return static_cast<std::uint64_t>((std::int64_t{y} - window_.box.min.y) / pitch_);
  }

  ThinningWindow window_;
  std::int64_t pitch_ = 1;
  std::uint64_t columns_ = 0, rows_ = 0;
  std::vector<std::uint8_t> marked_;
  std::vector<std::uint32_t> sum_;  // of pixels marked below and left
  bool has_changed_ = false;
};

}  // namespace hydrotin::thinning
