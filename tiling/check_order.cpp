#include "check_order.h"

#include <algorithm>
#include <map>
#include <memory>
#include <unordered_map>

#include "check_tile.h"
#include "disc.h"
#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

// Points of other tiles by segments of 16 blocks, forgotten all at once when there are too many.
class PointCache {
 public:
  explicit PointCache(const DatasetIndex& index) : index_(index) {}

  [[nodiscard]] const BoxTree& blocks(std::uint32_t tile) { return directory(tile).blocks; }

  [[nodiscard]] std::span<const LatticePoint> points(std::uint32_t tile, std::uint32_t block) {
    const std::uint64_t key = std::uint64_t{tile} << 32 | block / kSegmentBlocks;
    auto found = segment_.find(key);
    if (found == segment_.end()) {
      if (segment_.size() >= kMostSegments) segment_.clear();
      const std::uint64_t first = std::uint64_t{block / kSegmentBlocks} * kSegmentPoints;
      const std::uint64_t count = std::min<std::uint64_t>(kSegmentPoints, index_.count[tile] - first);
      const store::Reader& in = directory(tile).file;
      const auto x = in.read_range<std::int32_t>("x", first, count);
      const auto y = in.read_range<std::int32_t>("y", first, count);
      std::vector<LatticePoint> points(count);
      for (std::size_t i = 0; i < count; ++i) points[i] = {x[i], y[i]};
      found = segment_.emplace(key, std::move(points)).first;
    }
    const std::size_t first = std::size_t{block % kSegmentBlocks} * kBlockPoints;
    const std::span<const LatticePoint> all(found->second);
    return all.subspan(first, std::min<std::size_t>(kBlockPoints, all.size() - first));
  }

 private:
  static constexpr std::uint32_t kSegmentBlocks = 16;
  static constexpr std::uint64_t kSegmentPoints = std::uint64_t{kSegmentBlocks} * kBlockPoints;
  static constexpr std::size_t kMostSegments = 1024;  // 64 MiB

  struct Directory {
    store::Reader file;
    BoxTree blocks;
  };
  Directory& directory(std::uint32_t tile) {
    const auto found = directory_.find(tile);
    if (found != directory_.end()) return found->second;
    if (directory_.size() >= 64) directory_.clear();  // bounds the open files
    store::Reader file(index_.tile_path(tile));
    BoxTree blocks(read_block_boxes(file));
    return directory_.emplace(tile, Directory{std::move(file), std::move(blocks)}).first->second;
  }

  const DatasetIndex& index_;
  std::map<std::uint32_t, Directory> directory_;
  std::unordered_map<std::uint64_t, std::vector<LatticePoint>> segment_;
};

class OrderCounter {
 public:
  OrderCounter(const DatasetIndex& index, const BoxTree& tile_boxes, const TerrainTile& tile)
      : tile_boxes_(tile_boxes), tile_(tile), own_blocks_(tile.block_box), others_(index) {}

  [[nodiscard]] int order_of(LatticePoint a, LatticePoint b, LatticePoint c) {
    const Region disc = disc_through(a, b, c);
    const auto meets = [&](const LatticeBox& box) { return disc.meets(box); };
    int count = 0;
    const auto add = [&](std::span<const LatticePoint> points) {
      const double radius2 = disc.radius * disc.radius;
      for (const LatticePoint p : points) {
        const double dx = p.x - disc.x, dy = p.y - disc.y;
        if (dx * dx + dy * dy > radius2 * (1 + 1e-12)) continue;
        if (p == a || p == b || p == c) continue;
        if (in_circle(a, b, c, p) && ++count == kCountedOrder) return false;
      }
      return true;
    };
    tile_boxes_.for_each(meets, [&](std::uint32_t t) {
      if (t == tile_.tile)
        return own_blocks_.for_each(meets, [&](std::uint32_t block) {
          const std::size_t first = std::size_t{block} * kBlockPoints;
          return add(
              std::span(tile_.position).subspan(first, std::min<std::size_t>(kBlockPoints, tile_.num_own - first)));
        });
      // A copy: the directory may be forgotten while its blocks are visited.
      std::vector<std::uint32_t> blocks;
      others_.blocks(t).for_each(meets, [&](std::uint32_t block) {
        blocks.push_back(block);
        return true;
      });
      return std::all_of(blocks.begin(), blocks.end(),
                         [&](std::uint32_t block) { return add(others_.points(t, block)); });
    });
    return count;
  }

 private:
  const BoxTree& tile_boxes_;
  const TerrainTile& tile_;
  BoxTree own_blocks_;
  PointCache others_;
};

}  // namespace

OrderCount check_orders(const DatasetIndex& index, const BoxTree& tile_boxes, std::uint32_t tile, std::uint32_t bins,
                        Problems& problems) {
  const TerrainTile file = load_terrain_tile(index, tile);
  OrderCounter counter(index, tile_boxes, file);
  OrderCount out;
  for (std::size_t i = 0; i < file.triangle.size(); i += 3) {
    const LatticePoint a = file.position[file.triangle[i]], b = file.position[file.triangle[i + 1]],
                       c = file.position[file.triangle[i + 2]];
    if ((sample_key(a, b, c) >> 48) >= bins) continue;
    if (std::binary_search(file.added_triangle.begin(), file.added_triangle.end(), i / 3)) continue;
    ++out.counted;
    if (orientation(a, b, c) <= 0) continue;  // a problem of its own
    const int order = counter.order_of(a, b, c);
    out.max_order = std::max(out.max_order, order);
    if (order > index.order)
      problems.add("order", file.path + ": triangle " + std::to_string(i / 3) + " at " + index.place(a) +
                                " has order " + std::to_string(order) + ", more than " + std::to_string(index.order));
  }
  return out;
}

}  // namespace hydrotin
