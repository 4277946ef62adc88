#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/pit_components.h"

/// Cutting components that have grown too large.
///
/// Lakes hang together where the breach of one comes upon another. On rough terrain such components grow with the
/// terrain, and with them what must be in memory together. One of more than `BreachLimits::max_group` members is
/// therefore cut along squares of the lattice. Its *places* are its lakes, each at its smallest vertex by (x, y), and
/// its other members; places lie in fine cells, and these are put together to the largest squares, or halves of
/// squares, that have no more members than allowed. (A lake is never cut: in a cell with a larger one there are more.)
/// Members that lifting does not raise and that have a neighbour in another square are *held*: they stay as they are,
/// and are no members any more. Of two such neighbours the one in the later square is held.
///
/// Why no pit comes of that. Held vertices are at f = h, f the levels of `lift`. Let x <= f, with x = f wherever
/// nothing is solved, and let each part that is left drain to its exits. If P were a pit of x at height t, it would
/// contain a vertex r that is not solved, at f(r) = t. Under f, the flat around r leads to an outlet or to a w with
/// f(w) < t; as x <= f, all of it and w would belong to P. Nothing is asked of the held vertices but x = f.
///
/// And it costs no more than lifting: held vertices do not move, and each part costs no more than lifting it.
///
/// Properties
///   (1) What is held depends on the component, its heights and levels, and the grid: not on memory nor on any tiling.
///   (2) Parts of different squares do not touch.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

/// Fine cells, numbered along a curve on which every square of them is one run.
struct CutGrid {
  LatticePoint origin;  ///< smallest x and y of the terrain
  int shift = 0;        ///< cells have 2^shift lattice units a side
  [[nodiscard]] std::uint64_t cell_of(LatticePoint p) const;
};

/// Cells with about 256 vertices if these were spread evenly over the box of the terrain.
[[nodiscard]] CutGrid cut_grid(const LatticeBox& bounds, std::uint64_t num_vertices);

struct CountedCell {
  std::uint64_t cell = 0, members = 0;
};

/// The squares of one component.
/// @param cells  ascending, distinct.
/// @return       [cells] the number of the square, from 0 on; squares ascend with their cells.
/// Complexity: O(cells log cells).
[[nodiscard]] std::vector<std::uint32_t> squares_of(std::span<const CountedCell> cells, std::uint64_t most);

/// Takes the held vertices out of the members.
///
/// @param square     [n] numbers that ascend with the squares of a component, distinct among components that touch;
///                   kNoVertexNumber for vertices that are no members of any.
/// @param level      [n] of `lift`.
/// @param is_member  [n] nonzero: may be held; changed.
/// Complexity: O(n + E).
void hold_borders(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
                  std::span<const std::uint32_t> square, std::span<std::uint8_t> is_member);

/// The lake around a vertex that `lift` raises, in order of discovery.
/// @param is_seen  [n] of no vertex of the lake before, of all after.
void collect_lake(const ChangeableTerrain& terrain, std::span<const std::int32_t> level, std::uint32_t seed,
                  std::span<std::uint8_t> is_seen, std::vector<std::uint32_t>& lake);

/// Cuts all components of more than `most` members.
/// @param is_member  [n] changed.
/// @return           how many were cut.
/// Complexity: O(n + M log M); with such components 6 bytes per vertex and 24 for each of their members.
std::uint64_t cut_large_groups(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
                               const CutGrid& grid, std::uint64_t most, std::span<std::uint8_t> is_member);

}  // namespace hydrotin
