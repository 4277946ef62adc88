#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "hydrotin/pits.h"
#include "hydrotin/spill_tree.h"
#include "store.h"

/// Reduced trees and plateau summaries in files.
///
/// A tree is the arrays `rim` u64 [R], `edge_a`, `edge_b` u32, `edge_height` i32 [at most R]. A summary is, behind a
/// prefix, `pit_xy` i32 [2N], `pit_vertex` u64 [N], `pit_height` i32 [N], `pit_vertices` u64 [N] and `plateau_xy` i32
/// [2P], `plateau_vertex` u64, `plateau_height` i32, `plateau_inner` u32, `plateau_drains` u8 [P], `plateau_rim_begin`
/// u32 [P + 1], `plateau_rim` u64.
///
/// Catchments are `catchment_rise` u32 [n], modulo 2^32, and `catchment_terminal` u32 [n].
///
/// Errors  Error(storage) for arrays that contradict each other.

namespace hydrotin {

void write_tree(store::Writer& out, const SpillTree& tree);
[[nodiscard]] SpillTree read_tree(const store::Reader& in);

/// @param height  [n] of the part.
void write_catchments(store::Writer& out, const Catchments& catchments, std::span<const std::int32_t> height);
/// @param num_rim  vertices of the tree's rim.
[[nodiscard]] Catchments read_catchments(const store::Reader& in, std::span<const std::int32_t> height,
                                         std::size_t num_rim);

void write_plateaus(store::Writer& out, const std::string& prefix, const PlateauSummary& summary);
[[nodiscard]] std::vector<Pit> read_pits(const store::Reader& in, const std::string& prefix);
/// The open plateaus only: `pit` stays empty.
[[nodiscard]] PlateauSummary read_open_plateaus(const store::Reader& in, const std::string& prefix);

}  // namespace hydrotin
