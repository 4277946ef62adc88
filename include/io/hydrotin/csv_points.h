#pragma once

#include <filesystem>
#include <vector>

/// Points as comma-separated text, the small inputs of the one-shot commands. The header line names x, y and z (in any
/// order and case; further columns are passed over).
///
/// Numbers are read exactly: a decimal number becomes the nearest double, and how many decimals the file uses is said,
/// so that the caller can put the points on the lattice 10^-decimals without loss. Duplicates are kept.
///
/// Threads  Functions are pure: safe to call concurrently.
/// Errors   Error(input) with file, line and column.

namespace hydrotin {

/// Arrays by input row.
struct CsvPoints {
  std::vector<double> x, y, z;  ///< [n] finite
  int decimals_xy = 0;          ///< decimals that x and y use at most (trailing zeros do not count)
  int decimals_z = 0;           ///< the same for z
};

[[nodiscard]] CsvPoints read_csv_points(const std::filesystem::path& path);

}  // namespace hydrotin
