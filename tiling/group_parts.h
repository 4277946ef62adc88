#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/group_cut.h"
#include "store.h"
#include "surface.h"

/// Parts of the pieces of one tile, so small that groups which are too large can be cut between them (group_cut.h): a
/// part is a lake that other tiles have too, or all else of a piece that has its place in one fine cell.
///
///     part_piece u32, part_size u64, part_xy i32 [2 each], part_is_lake u8
///
/// Errors  Error(storage) naming the file for arrays that contradict each other.

namespace hydrotin {

struct GroupParts {
  std::vector<std::uint32_t> of;      ///< [n] the part of each vertex; 4294967295: none. Not stored
  std::vector<std::uint32_t> piece;   ///< [parts] the piece or flat it is of, ascending
  std::vector<std::uint64_t> size;    ///< [parts] vertices
  std::vector<LatticePoint> place;    ///< [parts] a point of its cell; of a lake its smallest vertex here
  std::vector<std::uint8_t> is_lake;  ///< [parts] 1: a lake that other tiles have too
};

/// @param label  [n] the piece or flat of each vertex; 4294967295: none.
[[nodiscard]] GroupParts parts_of(const Surface& surface, const ChangeableTerrain& terrain,
                                  std::span<const std::uint32_t> label, const CutGrid& grid);

/// Each piece is a part.
[[nodiscard]] GroupParts whole_parts(const Surface& surface, std::span<const std::uint32_t> label);

void write_parts(store::Writer& out, const GroupParts& parts);
/// @param num_pieces  with flats.
[[nodiscard]] GroupParts read_parts(const store::Reader& in, std::size_t num_pieces);

}  // namespace hydrotin
