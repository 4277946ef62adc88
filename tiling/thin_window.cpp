#include "thin_window.h"

#include <algorithm>
#include <limits>

#include "hydrotin/convex_hull.h"

namespace hydrotin {
namespace {

constexpr std::int64_t kFirstMargin = 12;  // cells: usually enough

}  // namespace

ThinWindow::ThinWindow(const RunContext& context, std::uint32_t tile, const ThinningOptions& options)
    : context_(context), tile_(tile), options_(options) {
  left_ = right_ = below_ = above_ = kFirstMargin;
  num_own_ = static_cast<std::uint32_t>(context.survey.count[tile]);
  if (num_own_ == 0) return;
  cut();
  load();
}

// Whole cells around the tile's points; a side that reaches the bounds of the data is closed.
void ThinWindow::cut() {
  constexpr std::int64_t kLeast = std::numeric_limits<std::int32_t>::min(),
                         kMost = std::numeric_limits<std::int32_t>::max();
  const LatticeBox own = context_.survey.box[tile_], all = context_.survey.bounds();
  const auto low = [&](std::int32_t from, std::int32_t bound, std::int64_t corner, std::int64_t margin, bool& is_open) {
    const std::int64_t at = corner + (grid_cell(from, corner, options_.cell) - margin) * options_.cell;
    is_open = at > bound;
    const std::int64_t last = corner + grid_cell(bound, corner, options_.cell) * options_.cell;
    return static_cast<std::int32_t>(std::max({at, last, kLeast}));
  };
  const auto high = [&](std::int32_t from, std::int32_t bound, std::int64_t corner, std::int64_t margin,
                        bool& is_open) {
    const std::int64_t at = corner + (grid_cell(from, corner, options_.cell) + margin + 1) * options_.cell - 1;
    is_open = at < bound;
    const std::int64_t last = corner + (grid_cell(bound, corner, options_.cell) + 1) * options_.cell - 1;
    return static_cast<std::int32_t>(std::min({at, last, kMost}));
  };
  window_.box.min.x = low(own.min.x, all.min.x, options_.grid_x, left_, window_.open_left);
  window_.box.max.x = high(own.max.x, all.max.x, options_.grid_x, right_, window_.open_right);
  window_.box.min.y = low(own.min.y, all.min.y, options_.grid_y, below_, window_.open_below);
  window_.box.max.y = high(own.max.y, all.max.y, options_.grid_y, above_, window_.open_above);
}

void ThinWindow::load() {
  const auto file_of = [&](std::uint32_t t) { return store::Reader(context_.layout.unit(Phase::arrange, t)); };
  {
    TilePoints own = read_points(file_of(tile_), 0, num_own_);
    position_ = std::move(own.position);
    height_ = std::move(own.height);
  }
  const LatticeBox reach = reach_of_blocks(window_.box, options_);
  TilePoints beyond;
  const auto meets = [&](const LatticeBox& box) { return reach.intersects(box); };
  context_.survey.tree.for_each(meets, [&](std::uint32_t t) {
    if (t == tile_) return true;
    const store::Reader in = file_of(t);
    const std::vector<LatticeBox> block = read_block_boxes(in);
    const std::uint64_t total = context_.survey.count[t];
    for (std::uint64_t b = 0; b < block.size(); ++b) {
      if (!meets(block[b])) continue;
      std::uint64_t last = b + 1;  // neighbouring blocks are read together
      while (last < block.size() && meets(block[last])) ++last;
      const std::uint64_t first = b * kBlockPoints;
      const TilePoints some = read_points(in, first, std::min(last * kBlockPoints, total) - first);
      for (std::size_t i = 0; i < some.position.size(); ++i) {
        const bool is_inside = window_.box.contains(some.position[i]);
        if (!is_inside && !reach.contains(some.position[i])) continue;
        (is_inside ? position_ : beyond.position).push_back(some.position[i]);
        (is_inside ? height_ : beyond.height).push_back(some.height[i]);
      }
      b = last;
    }
    return true;
  });
  num_inside_ = static_cast<std::uint32_t>(position_.size());
  position_.insert(position_.end(), beyond.position.begin(), beyond.position.end());
  height_.insert(height_.end(), beyond.height.begin(), beyond.height.end());
  if (position_.size() >= std::numeric_limits<std::uint32_t>::max() / 8)
    throw Error(ErrorKind::resource,
                "tile " + std::to_string(tile_) + ": thinning has to know " + std::to_string(position_.size()) +
                    " points around it, more than it can; lower tiles.target_points or thin.cell_m");
}

Thinning ThinWindow::thin() const {
  std::vector<PointFate> fate = thin_blocks(position_, height_, options_, window_.box);
  std::vector<LatticePoint> position(position_.begin(), position_.begin() + num_inside_);
  std::vector<std::int32_t> height(height_.begin(), height_.begin() + num_inside_);
  fate.resize(num_inside_);
  for (const HullVertex& v : context_.survey.hull)
    if (!window_.box.contains(v.position)) {
      position.push_back(v.position);
      height.push_back(v.height);
      fate.push_back(PointFate::seed);
    }
  // The vertices of the hull of all points are here, so it is that of the points here.
  return settle(position, height, fate, convex_hull(position), options_, &window_);
}

bool ThinWindow::widen(const std::vector<std::uint8_t>& doubtful) {
  const LatticeBox& w = window_.box;
  bool left = false, right = false, below = false, above = false;
  for (std::uint32_t i = 0; i < num_own_; ++i) {
    if (doubtful[i] == 0) continue;
    constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();
    const LatticePoint p = position_[i];
    const std::int64_t to_left = window_.open_left ? std::int64_t{p.x} - w.min.x : kFar;
    const std::int64_t to_right = window_.open_right ? std::int64_t{w.max.x} - p.x : kFar;
    const std::int64_t to_below = window_.open_below ? std::int64_t{p.y} - w.min.y : kFar;
    const std::int64_t to_above = window_.open_above ? std::int64_t{w.max.y} - p.y : kFar;
    const std::int64_t nearest = std::min({to_left, to_right, to_below, to_above});
    left = left || to_left == nearest;
    right = right || to_right == nearest;
    below = below || to_below == nearest;
    above = above || to_above == nearest;
  }
  if (!left && !right && !below && !above) return false;
  const auto grow = [](bool wanted, std::int64_t& margin) {
    margin += wanted ? std::max<std::int64_t>(margin / 2, 4) : 0;
  };
  grow(left && window_.open_left, left_);
  grow(right && window_.open_right, right_);
  grow(below && window_.open_below, below_);
  grow(above && window_.open_above, above_);
  cut();
  load();
  return true;
}

}  // namespace hydrotin
