#include <algorithm>
#include <limits>
#include <tuple>

#include "hydrotin/convex_hull.h"
#include "hydrotin/thinning.h"

namespace hydrotin {
namespace {

// Points that follow each other and lie in one block. Along a curve there are few.
struct Stretch {
  std::int64_t column = 0, row = 0;
  std::uint32_t begin = 0, end = 0;
};

std::int32_t clamped(std::int64_t v) {
  return static_cast<std::int32_t>(
      std::clamp<std::int64_t>(v, std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()));
}

class Blocks {
 public:
  Blocks(std::span<const LatticePoint> position, std::span<const std::int32_t> height, const ThinningOptions& options)
      : position_(position), height_(height), options_(options), side_(kBlockCells * options.cell) {
    for (std::uint32_t i = 0; i < position.size(); ++i) {
      const std::int64_t column = grid_cell(position[i].x, options.grid_x, side_);
      const std::int64_t row = grid_cell(position[i].y, options.grid_y, side_);
      if (stretch_.empty() || stretch_.back().column != column || stretch_.back().row != row)
        stretch_.push_back({column, row, i, i});
      ++stretch_.back().end;
    }
    std::sort(stretch_.begin(), stretch_.end(), before);
  }

  void thin_those_in(const LatticeBox& box, std::vector<PointFate>& fate) {
    for (std::size_t i = 0; i < stretch_.size(); ++i) {
      const Stretch& s = stretch_[i];
      if (i > 0 && s.column == stretch_[i - 1].column && s.row == stretch_[i - 1].row) continue;
      if (box_of(s.column, s.row, 0).intersects(box)) thin_one(s.column, s.row, fate);
    }
  }

 private:
  static bool before(const Stretch& a, const Stretch& b) {
    return std::tuple(a.column, a.row, a.begin) < std::tuple(b.column, b.row, b.begin);
  }

  [[nodiscard]] LatticeBox box_of(std::int64_t column, std::int64_t row, std::int64_t margin) const {
    const std::int64_t x = options_.grid_x + column * side_, y = options_.grid_y + row * side_;
    return {{clamped(x - margin), clamped(y - margin)},
            {clamped(x + side_ - 1 + margin), clamped(y + side_ - 1 + margin)}};
  }

  void thin_one(std::int64_t column, std::int64_t row, std::vector<PointFate>& fate) {
    const LatticeBox own = box_of(column, row, 0), reach = box_of(column, row, kBlockMargin * options_.cell);
    index_.clear();
    some_.clear();
    heights_.clear();
    for (std::int64_t c = column - 1; c <= column + 1; ++c) {
      auto at = std::lower_bound(stretch_.begin(), stretch_.end(), Stretch{c, row - 1, 0, 0}, before);
      for (; at != stretch_.end() && at->column == c && at->row <= row + 1; ++at)
        for (std::uint32_t i = at->begin; i < at->end; ++i) {
          if (!reach.contains(position_[i])) continue;
          index_.push_back(i);
          some_.push_back(position_[i]);
          heights_.push_back(height_[i]);
        }
    }
    const std::vector<std::uint32_t> hull = convex_hull(some_);
    std::vector<PointFate> here(some_.size(), PointFate::seed);
    if (hull.size() >= 3) here = thin_together(some_, heights_, hull, options_).fate;
    for (std::size_t i = 0; i < index_.size(); ++i)
      if (own.contains(some_[i])) fate[index_[i]] = here[i];
  }

  std::span<const LatticePoint> position_;
  std::span<const std::int32_t> height_;
  ThinningOptions options_;
  std::int64_t side_;
  std::vector<Stretch> stretch_;
  std::vector<std::uint32_t> index_;
  std::vector<LatticePoint> some_;
  std::vector<std::int32_t> heights_;
};

}  // namespace

LatticeBox reach_of_blocks(const LatticeBox& box, const ThinningOptions& options) {
  const std::int64_t side = kBlockCells * options.cell, margin = kBlockMargin * options.cell;
  const auto low = [&](std::int32_t v, std::int64_t corner) {
    return clamped(corner + grid_cell(v, corner, side) * side - margin);
  };
  const auto high = [&](std::int32_t v, std::int64_t corner) {
    return clamped(corner + (grid_cell(v, corner, side) + 1) * side - 1 + margin);
  };
  return {{low(box.min.x, options.grid_x), low(box.min.y, options.grid_y)},
          {high(box.max.x, options.grid_x), high(box.max.y, options.grid_y)}};
}

std::vector<PointFate> thin_blocks(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                                   const ThinningOptions& options, const LatticeBox& box) {
  std::vector<PointFate> fate(position.size(), PointFate::removed);
  Blocks(position, height, options).thin_those_in(box, fate);
  return fate;
}

}  // namespace hydrotin
