#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

/// Pieces of tiles that hang together through vertices that they share, joined to groups; each group is given to the
/// tile with its largest piece (ties: the first).
///
/// Threads  One object belongs to one thread.

namespace hydrotin {

/// Piece p is number index[p] of tile[p]. Groups are numbered by their first pieces.
struct JoinedGroups {
  std::vector<std::uint32_t> tile, index;             ///< [pieces]
  std::vector<std::uint32_t> group;                   ///< [pieces]
  std::vector<std::uint32_t> piece_begin, piece;      ///< [groups + 1], [pieces] ascending within a group
  std::vector<std::uint32_t> owner;                   ///< [groups] tile
  std::vector<std::uint64_t> size;                    ///< [groups] vertices; those that tiles share count once
  std::vector<std::vector<std::uint32_t>> groups_of;  ///< [tiles with pieces] those that the tile owns, ascending

  [[nodiscard]] std::span<const std::uint32_t> pieces_of(std::uint32_t g) const {
    return {piece.data() + piece_begin[g], piece.data() + piece_begin[g + 1]};
  }
  [[nodiscard]] std::span<const std::uint32_t> owned_by(std::uint32_t t) const {
    return t < groups_of.size() ? std::span<const std::uint32_t>(groups_of[t]) : std::span<const std::uint32_t>();
  }
};

class GroupJoiner {
 public:
  /// Pieces of one tile in the order of their numbers, tiles ascending.
  /// @param size  its vertices; 0: sizes are not asked for
  std::uint32_t add_piece(std::uint32_t tile, std::uint64_t size);
  /// A vertex that other tiles may have too.
  void add_vertex(std::uint64_t point, std::uint32_t piece) { vertex_.emplace_back(point, piece); }
  void unite(std::uint32_t a, std::uint32_t b) { union_.emplace_back(a, b); }
  [[nodiscard]] JoinedGroups join();

 private:
  std::vector<std::uint32_t> tile_, index_;
  std::vector<std::uint64_t> size_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> vertex_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> union_;
};

}  // namespace hydrotin
