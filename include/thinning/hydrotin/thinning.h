#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"

/// Thinning by greatest vertical error: the points that a TIN needs so that it passes all others within a limit.
///
/// Rounds over the Delaunay triangulation of the points kept, all decisions of a round taken at once:
///   seeds    the point nearest to the centre in each cell of an absolute grid (ties by (x, y)), and the convex hull;
///   polite   each triangle proposes its worst point if that is beyond the limit; a proposal is accepted if it is worse
///            than those of the three neighbours (ties: the smaller by (x, y) wins);
///   eager    all proposals are accepted; last of all, every point beyond the limit;
///   pruning  a vertex may go if its Delaunay triangles and those that would take their place are local and every point
///            below them, itself included, stays within the limit; of neighbours that may go the one with the smallest
///            greatest error goes (ties by a number made from the place in the grid).
/// A triangle is *local* if its circumradius is at most two cells. Others span voids and the rim of the data: points in
/// them are accepted at once.
///
/// Blocks. The rounds travel: after thirty of them a decision may depend on points fifty cells away. So they are run
/// for each absolute *block* of the grid with the points of a margin around it, and only the fates of the block's own
/// points count. Then the blocks are *settled* together: from the points that they keep and the hull of everything on,
/// some eager rounds, which find hardly anything to do, restore the limit everywhere. Neither knows of tiles: the
/// answer is a function of the set of points, the limit and the grid.
///
/// Source   Garland and Heckbert, "Fast polygonal approximation of terrains and height fields", 1995, made synchronous
///          so that no order of insertion matters.
/// Symbols  n = points, eps = the limit.
/// Properties
///   (1) Every point removed lies within eps of the Delaunay triangulation of those kept: |num| <= eps * den in exact
///       integers.
///   (2) The answer does not depend on the order of the points, nor on where (0, 0) is if the grid moves along.
///   (3) Settling in a window: a point that is not `doubtful` is kept or removed as it would be with all points known.
///   (4) A point on an edge belongs to one triangle: to the one that holds it after an infinitesimal step (e, e^2).
/// Units    lattice units of x, y and of z.
/// Threads  Pure functions.

namespace hydrotin {

inline constexpr std::uint32_t kPoliteRounds = 16, kEagerRounds = 6, kLastRounds = 8;
inline constexpr std::uint32_t kPruningRounds = 8;
inline constexpr std::uint32_t kSettlingRounds = 8;                ///< half of them eager, half last
inline constexpr std::int64_t kBlockCells = 64, kBlockMargin = 8;  ///< side of a block, and around it

struct ThinningOptions {
  std::int64_t limit_millionths = 0;    ///< eps in millionths of a unit of z, from 0 to 2^51
  std::int32_t cell = 1;                ///< side of a grid cell, 1 to 2^28
  std::int64_t grid_x = 0, grid_y = 0;  ///< the corner of cell (0, 0)
  bool prune = true;

  /// Cells of this side (0 < side < 2^28 lattice units, to the nearest whole one) at multiples of it from (0, 0) of the
  /// CRS, as near as the lattice comes to it, whatever its base.
  void set_grid(const Lattice& lattice, double side);
};

/// What is known: all points inside `box`, and that there are none beyond its closed sides.
struct ThinningWindow {
  LatticeBox box;                                                                      ///< of whole cells
  bool open_left = false, open_right = false, open_below = false, open_above = false;  ///< there are points beyond
};

enum class PointFate : std::uint8_t {
  removed,   ///< never kept
  seed,      ///< kept from the beginning
  inserted,  ///< kept by a round
  pruned,    ///< kept for a time
  settled    ///< kept because blocks together need it
};

[[nodiscard]] constexpr bool is_kept(PointFate fate) {
  return fate == PointFate::seed || fate == PointFate::inserted || fate == PointFate::settled;
}

struct Thinning {
  std::vector<PointFate> fate;         ///< [n]
  std::vector<std::uint8_t> round;     ///< [n] of the last call that inserted the point, from 1; 0: none
  std::vector<std::uint8_t> doubtful;  ///< [n] 1: points beyond the window may change its fate
  std::vector<std::uint32_t>
      unsettled;  ///< removed points beyond the limit when the rounds were over: nearly never any
  std::uint32_t rounds = 0, pruning_rounds = 0;  ///< that changed something
  double max_error = 0, squared_error = 0;       ///< of points removed: greatest, and sum of squares [units of z]
};

/// Blocks, settled.
///
/// @param position  [n] distinct, any order  @param height  [n]
/// @param hull      indices of their strict convex hull, at least three
/// Complexity: expected O(n log n) with small factors (0.3 to 3 us a point); memory about 30 bytes a point.
[[nodiscard]] Thinning thin(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                            std::span<const std::uint32_t> hull, const ThinningOptions& options);

/// The rounds over all points at once, without blocks. Nothing is in doubt.
[[nodiscard]] Thinning thin_together(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                                     std::span<const std::uint32_t> hull, const ThinningOptions& options);

/// Where the points are that decide about all blocks which meet a box.
[[nodiscard]] LatticeBox reach_of_blocks(const LatticeBox& box, const ThinningOptions& options);

/// Fates of the points in blocks that meet `box`; others are `removed`. A block whose points and margin lie on one line
/// keeps all.
/// Precondition: all points of reach_of_blocks(box) are given; others do no harm.
[[nodiscard]] std::vector<PointFate> thin_blocks(std::span<const LatticePoint> position,
                                                 std::span<const std::int32_t> height, const ThinningOptions& options,
                                                 const LatticeBox& box);

/// Inserts what the points kept by `fate` and by the hull still need.
///
/// @param hull    of all points, also of those beyond the window, which are then among the points
/// @param window  nothing: all points there are
/// @return        fates as given where nothing changed
[[nodiscard]] Thinning settle(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                              std::span<const PointFate> fate, std::span<const std::uint32_t> hull,
                              const ThinningOptions& options, const ThinningWindow* window = nullptr);

/// The corner cell of the grid below and left of a point, as the cell's number along an axis.
[[nodiscard]] constexpr std::int64_t grid_cell(std::int64_t value, std::int64_t corner, std::int64_t cell) {
  const std::int64_t d = value - corner;
  return d >= 0 ? d / cell : -((-d + cell - 1) / cell);
}

}  // namespace hydrotin
