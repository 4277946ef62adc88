#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "hydrotin/lattice.h"

namespace hydrotin::app {

/// The points of a one-shot command: read from CSV, LAS, LAZ or a DEM, put on a lattice, without duplicates, in curve
/// order.
struct SmallPoints {
  Lattice lattice;
  std::string crs_wkt;                                              ///< empty = unknown
  std::uint64_t num_rows = 0;                                       ///< points in the input; cells of a raster
  std::vector<LatticePoint> position;                               ///< [n] distinct
  std::vector<std::int32_t> height;                                 ///< [n]
  std::vector<std::uint32_t> row;                                   ///< [n] 0-based input row
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;  ///< (dropped row, kept row): the lowest is kept
  std::vector<LatticePoint> reference_position;                     ///< [r] points that are no vertices
  std::vector<std::int32_t> reference_height;                       ///< [r]
  std::vector<std::string> notes;                                   ///< what was done to the coordinates, for people
};

/// LAS, LAZ and rasters are told from CSV by content; Withheld points and cells without height are left out. The rows
/// of a raster are its cells, row by row; they lie on a lattice of 0.001 (see dem_points.h). A CSV's lattice is as fine
/// as its decimals ask, or as 32 bits allow (then a note says so). Fails: Error(input).
/// @param reference  a second file of the same kind, for the same lattice; empty = none
[[nodiscard]] SmallPoints load_small_points(const std::string& path, const std::string& reference = {});

/// The same, and says on stderr what was done to the points.
[[nodiscard]] SmallPoints load_and_note(const std::string& path, const std::string& reference = {});

}  // namespace hydrotin::app
