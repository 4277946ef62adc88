#pragma once

#include <cstdint>
#include <mutex>
#include <optional>

#include "box_tree.h"
#include "hydrotin/lattice.h"
#include "layout.h"

/// Boxes of the tiles' triangles, as `drain` found them, for finding the tiles that meet a region: read once, and
/// searched in far less time than there are tiles.
///
/// Memory   16 bytes a tile and a seventh of it.
/// Threads  May be called concurrently; the first caller reads the boxes, others wait for it.

namespace hydrotin {

class PartBounds {
 public:
  /// Valid as long as this object; the arguments are those of the first call.
  /// Fails: Error(storage) if the output of `drain` is missing or damaged; the next call tries again.
  [[nodiscard]] const BoxTree& tree(const Layout& layout, std::uint32_t num_tiles);

 private:
  std::once_flag once_;
  std::optional<BoxTree> tree_;
};

}  // namespace hydrotin
