#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "layout.h"

/// Which outputs of `breach` have members among the points of a tile, and where in them.
///
/// An output of `breach` lists its members by ascending points, so by tile. Read once for all outputs and turned round,
/// the beginnings of the tiles tell each tile what to read: `members` opens these outputs and no others, so that its
/// work grows with the members and not with tiles times tiles. It is derived from the outputs alone: each process of a
/// job array makes its own.
///
/// Memory   24 bytes for each pair of an output and a tile that meet, 8 for each tile.
/// Threads  May be called concurrently; the first caller reads the lists, others wait for it.

namespace hydrotin {

/// Members of one tile's points in one output: entries first .. first + count of `member_point`.
struct MemberRange {
  std::uint64_t first = 0, count = 0;
  std::uint32_t unit = 0;
};

class BreachIndex {
 public:
  /// Ranges with members among the points of `tile`, units ascending. Valid as long as this object.
  /// @param tile  < num_tiles, or num_tiles for vertices that rivers added; the other arguments are those of the first
  /// call Fails: Error(storage) if an output of `breach` is missing or damaged; the next call tries again.
  [[nodiscard]] std::span<const MemberRange> ranges_of(std::uint32_t tile, const Layout& layout,
                                                       std::uint32_t num_tiles);

 private:
  void build(const Layout& layout, std::uint32_t num_tiles);

  std::once_flag once_;
  std::vector<std::uint64_t> begin_;  // [tiles + 2]
  std::vector<MemberRange> range_;    // of tile t: range_[begin_[t] .. begin_[t + 1])
};

}  // namespace hydrotin
