#pragma once

#include <cstdint>
#include <vector>

#include "hydrotin/pit_hierarchy.h"
#include "part.h"
#include "phases.h"
#include "store.h"

/// The pit hierarchy of the data set, and which pits are kept: the output of `choose`.
///
///     pit_xyz i32 [3P], pit_plateau u64 [P], pit_parent u32 [P], spill_xyz i32 [3P], basin_vertices u64 [P],
///     basin_displacement i64 [P], basin_doubled_area i64 [P], basin_volume f64 [P], kept u8 [P]
///     kept_begin u64 [tiles + 1], kept_seed u64: of each kept pit a vertex in each tile that has a share of it
/// Pits ascend by (x, y): their numbers are the ids that users see.
///
/// Errors  Error(storage) for arrays that contradict each other.

namespace hydrotin {

struct PitTable {
  std::vector<PitBasin> pit;  ///< without prices; `vertex`, `spill_vertex` are void
  std::vector<std::uint8_t> is_kept;
};

[[nodiscard]] PitTable read_pit_table(const store::Reader& in);

/// [n] nonzero: the vertex belongs to a kept pit.
[[nodiscard]] std::vector<std::uint8_t> kept_flags(const RunContext& context, std::uint32_t tile, const Part& part);

}  // namespace hydrotin
