#pragma once

#include <cstdint>

#include "hydrotin/lattice.h"

/// Where the cells of a raster lie on the lattice.
///
/// One frame holds for the whole data set; tiles are ranges of its global columns and rows. A cell is decided by its
/// centre, and a centre is rounded once, by one formula of its global column or row, to a sub-lattice of 2^-16 lattice
/// units. From there on all tests are exact integer arithmetic. (At a lattice of 1 cm this moves a centre by less than
/// 0.1 micrometres; a centre that is a lattice point in the coordinates of the files is one here, as long as these
/// coordinates are below 2^35 lattice units.)
///
/// Properties
///   (1) Centres ascend with the column and descend with the row.
///   (2) `cells_in` of boxes that partition the lattice partition the cells of the frame.
/// Units    world coordinates in the unit of the CRS; sub-lattice units are lattice units / 65536.
/// Threads  Pure: safe to call concurrently.

namespace hydrotin {

/// A raster of square cells, row 0 at the top. All numbers are finite, cell > 0, columns and rows >= 0.
struct RasterFrame {
  double origin_x = 0.0, origin_y = 0.0;  ///< top left corner of cell (0, 0)
  double cell = 1.0;                      ///< side of a cell
  std::int64_t columns = 0, rows = 0;
  friend bool operator==(const RasterFrame&, const RasterFrame&) = default;
};

/// Global columns [column_begin, column_end) and rows [row_begin, row_end).
struct CellRange {
  std::int64_t column_begin = 0, column_end = 0;
  std::int64_t row_begin = 0, row_end = 0;

  [[nodiscard]] std::int64_t num_columns() const { return column_end - column_begin; }
  [[nodiscard]] std::int64_t num_rows() const { return row_end - row_begin; }
  [[nodiscard]] bool is_empty() const { return num_columns() <= 0 || num_rows() <= 0; }
  friend bool operator==(const CellRange&, const CellRange&) = default;
};

inline constexpr int kSubLatticeBits = 16;

/// Centre of a column (x) or row (y) of cells, in sub-lattice units; clamped to +-2^50, far outside the lattice.
[[nodiscard]] std::int64_t center_x(const RasterFrame& frame, const Lattice& lattice, std::int64_t column);
[[nodiscard]] std::int64_t center_y(const RasterFrame& frame, const Lattice& lattice, std::int64_t row);

/// The cells whose centres c have box.min <= c < box.max + 1 in x and y: all centres in the closed box, and those
/// between it and the next lattice points, so that adjacent boxes share no cell and miss none. Empty for an empty box.
/// Complexity: O(log(columns + rows)).
[[nodiscard]] CellRange cells_in(const RasterFrame& frame, const Lattice& lattice, const LatticeBox& box);

/// The smallest frame with corners at whole multiples of `cell` that covers a box, up to the rounding of its corners:
/// no centre of the box is left out. It depends on nothing else.
///
/// @param box   not empty.
/// @param cell  finite, > 0.
[[nodiscard]] RasterFrame frame_around(const Lattice& lattice, const LatticeBox& box, double cell);

}  // namespace hydrotin
