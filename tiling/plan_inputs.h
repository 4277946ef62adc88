#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common_lattice.h"
#include "hydrotin/options.h"

/// The input files as the plan sees them: what headers say, of clouds and of rasters alike.

namespace hydrotin {

struct PlanInput {
  FileLattice lattice;  ///< with its path and declared bounds
  std::string crs_wkt;  ///< empty: none
  std::uint64_t points = 0, bytes = 0;
  std::vector<std::string> files;  ///< all that it is read from; their sizes and times belong to the recipe
  bool is_reference = false, is_dem = false;
  std::uint32_t num_columns = 0, num_rows = 0, block_rows = 1;  ///< of a raster
  double first_y = 0, step_y = 0;                               ///< of its rows

  [[nodiscard]] const std::string& path() const { return lattice.path; }
  /// Smallest and largest x and y (x, y, x, y) of some rows of a raster, of all points of a cloud.
  [[nodiscard]] std::array<double, 4> bounds(std::uint64_t first_row, std::uint64_t rows) const;
};

/// Opens and checks all inputs: rasters by path, points by path, reference points by path. Reads headers only.
/// Fails: Error(input) for a file that cannot be used or a pattern that matches nothing, Error(config) if none is
/// named.
[[nodiscard]] std::vector<PlanInput> open_inputs(const PipelineOptions& options);

}  // namespace hydrotin
