#include "neighborhood.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hydrotin {
namespace {

LatticeBox grown(const LatticeBox& box, double margin) {
  const auto clamp = [](double v) { return static_cast<std::int32_t>(std::clamp(v, -2147483647.0, 2147483647.0)); };
  return {{clamp(box.min.x - margin), clamp(box.min.y - margin)},
          {clamp(box.max.x + margin), clamp(box.max.y + margin)}};
}

LatticeBox intersection(const LatticeBox& a, const LatticeBox& b) {
  return {{std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y)},
          {std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y)}};
}

bool is_within(const LatticeBox& inner, const LatticeBox& outer) {
  return inner.is_empty() || (outer.contains(inner.min) && outer.contains(inner.max));
}

}  // namespace

Neighborhood::Neighborhood(const RunContext& context, std::uint32_t tile, double halo)
    : context_(context), tile_(tile) {
  num_own_ = static_cast<std::uint32_t>(context.outline.count[tile]);
  TilePoints own = read_points(reader(tile), 0, num_own_);
  position_ = std::move(own.position);
  height_ = std::move(own.height);
  point_.reserve(num_own_);
  for (std::uint32_t i = 0; i < num_own_; ++i) point_.emplace_back(tile, i);
  if (num_own_ == 0) return;

  window_ = grown(context.outline.box[tile], halo);
  const auto meets_window = [&](const LatticeBox& box) { return window_.intersects(box); };
  context.outline.tree.for_each(meets_window, [&](std::uint32_t t) {
    if (t == tile) return true;
    directory(t).tree.for_each(meets_window, [&](std::uint32_t b) {
      load_block(t, b, &window_);
      return true;
    });
    return true;
  });
  for (const HullVertex& v : context.outline.hull)
    if (v.point.tile() != tile && !window_.contains(v.position)) {
      single_.insert(v.point.value);
      add(v.point, v.position, v.height);
    }
}

const store::Reader& Neighborhood::reader(std::uint32_t tile) {
  const auto found = readers_.find(tile);
  if (found != readers_.end()) return found->second;
  return readers_.emplace(tile, store::Reader(context_.points_unit(tile))).first->second;
}

Neighborhood::Directory& Neighborhood::directory(std::uint32_t tile) {
  const auto found = directories_.find(tile);
  if (found != directories_.end()) return found->second;
  Directory fresh;
  fresh.box = read_block_boxes(reader(tile));
  fresh.tree = BoxTree(fresh.box);
  fresh.loaded.resize(fresh.box.size());
  fresh.wanted.resize(fresh.box.size());
  return directories_.emplace(tile, std::move(fresh)).first->second;
}

void Neighborhood::add(PointId id, LatticePoint position, std::int32_t height) {
  point_.push_back(id);
  position_.push_back(position);
  height_.push_back(height);
}

// With `only_inside` the points inside the window; without it those outside, which are the ones still missing.
void Neighborhood::load_block(std::uint32_t tile, std::uint32_t block, const LatticeBox* only_inside) {
  const std::uint64_t first = std::uint64_t{block} * kBlockPoints;
  const std::uint64_t count = std::min<std::uint64_t>(kBlockPoints, context_.outline.count[tile] - first);
  const TilePoints points = read_points(reader(tile), first, count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const PointId id(tile, static_cast<std::uint32_t>(first) + i);
    if (window_.contains(points.position[i]) != (only_inside != nullptr) || single_.contains(id.value)) continue;
    add(id, points.position[i], points.height[i]);
  }
  Directory& known = directory(tile);
  known.loaded[block] = only_inside == nullptr || is_within(known.box[block], window_);
}

bool Neighborhood::needs(const Directory& directory, std::uint32_t block, const Region& region) const {
  if (directory.loaded[block] || !region.meets(directory.box[block])) return false;
  if (region.is_half_plane) return true;
  const LatticeBox bounds = grown({{static_cast<std::int32_t>(std::clamp(region.x, -2147483647.0, 2147483647.0)),
                                    static_cast<std::int32_t>(std::clamp(region.y, -2147483647.0, 2147483647.0))},
                                   {static_cast<std::int32_t>(std::clamp(region.x, -2147483647.0, 2147483647.0)),
                                    static_cast<std::int32_t>(std::clamp(region.y, -2147483647.0, 2147483647.0))}},
                                  region.radius + 1);
  return !is_within(intersection(bounds, directory.box[block]), window_);
}

bool Neighborhood::covers(const Region& region, LatticePoint anchor) {
  if (region.is_inside(window_)) return true;
  // Tiles by distance, so that far ones are opened only if nothing nearer is missing.
  std::vector<std::pair<double, std::uint32_t>> tiles;
  const auto meets = [&](const LatticeBox& box) { return region.meets(box); };
  context_.outline.tree.for_each(meets, [&](std::uint32_t t) {
    if (t != tile_ && (region.is_half_plane || !is_within(context_.outline.box[t], window_)))
      tiles.emplace_back(distance2(anchor, context_.outline.box[t]), t);
    return true;
  });
  std::sort(tiles.begin(), tiles.end());
  double nearest2 = -1;
  std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> missing;
  for (const auto& [tile_distance2, t] : tiles) {
    if (nearest2 >= 0 && tile_distance2 > 4 * nearest2) break;
    const Directory& other = directory(t);
    other.tree.for_each(meets, [&](std::uint32_t b) {
      if (!needs(other, b, region)) return true;
      const double d2 = distance2(anchor, other.box[b]);
      missing.emplace_back(d2, t, b);
      if (nearest2 < 0 || d2 < nearest2) nearest2 = d2;
      return true;
    });
  }
  // A few blocks more cost less than another round.
  constexpr std::size_t kFewBlocks = 8;
  const double reach2 = missing.size() <= kFewBlocks ? std::numeric_limits<double>::infinity() : 4 * nearest2;
  for (const auto& [d2, t, b] : missing) {
    std::uint8_t& wanted = directory(t).wanted[b];
    if (d2 > reach2 || wanted) continue;
    wanted = 1;
    wanted_.emplace_back(t, b);
  }
  return missing.empty();
}

bool Neighborhood::fetch() {
  if (wanted_.empty()) return false;
  std::sort(wanted_.begin(), wanted_.end());
  const std::size_t before = position_.size();
  for (const auto& [t, b] : wanted_) load_block(t, b, nullptr);
  num_fetched_ += position_.size() - before;
  wanted_.clear();
  return true;
}

}  // namespace hydrotin
