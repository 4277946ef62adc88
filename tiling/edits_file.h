#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hydrotin/exact_sum.h"
#include "hydrotin/pit_components.h"
#include "phases.h"
#include "store.h"
#include "surface.h"

/// The edits of pit removal in the files of `members` and `settle`, and how much was changed in all.
///
/// Regions ascend by their smallest vertices in (x, y), breaches by their first vertices: R regions, B breaches.
///     region_key i32 [2R], region_level i32 [R], region_lowest i32 [3R] (z before), region_vertices u64 [R],
///     region_displacement i64 [R], region_volume f64 [R], region_ring_begin u64 [R + 1], ring_begin u64 [rings + 1],
///     ring_xy i32
///     breach_key i32 [2B], breach_pit i32 [3B] (z before; level of no pit: 2147483647), breach_displacement i64 [B],
///     breach_depth i32 [B], breach_lowered u64 [B], breach_length f64 [B], breach_volume f64 [B],
///     breach_begin u64 [B + 1], breach_xyz i32 (new heights)
/// Lattice units; volumes in cubed ones.

namespace hydrotin {

/// What pit removal did to the heights.
struct ChangeFigures {
  std::int64_t raised = 0, lowered = 0;  ///< vertices
  std::int64_t raise_total = 0, lower_total = 0, raise_max = 0, lower_max = 0;
  ExactSum volume;  ///< sixfold: displacements times doubled areas of stars
  std::int64_t groups = 0, unguaranteed = 0;

  void add(std::int64_t displacement, std::int64_t star);
  void add(const ChangeFigures& other);
};

void write_figures(store::Writer& out, const ChangeFigures& figures);
[[nodiscard]] ChangeFigures read_change_figures(const store::Reader& in);

/// Finds and writes the edits of the components; their members must have all their triangles in the surface.
/// @param terrain  of the surface  @param height  [n] new heights  @param star  [n] doubled areas
void write_edits(store::Writer& out, const ChangeableTerrain& terrain, std::span<const std::uint32_t> triangle,
                 const PitComponents& components, std::span<const std::int32_t> height,
                 std::span<const std::int64_t> star);

}  // namespace hydrotin
