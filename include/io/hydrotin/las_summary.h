#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>

#include "hydrotin/las.h"

/// What is really in a LAS or LAZ file, as opposed to what its header says: every point is decoded.
///
/// Properties
///   (1) A tally of a file does not depend on how its points are cut into batches or chunks, nor on which thread made
///       which part, as long as parts are appended in file order.
///   (2) The checksum is that of x, y, z (integers), class, flags and return numbers of all records in file order:
///       equal for a LAS file and the LAZ file made from it, different when points are in another order.
/// Threads  Functions are pure; a LasTally belongs to one thread.

namespace hydrotin {

/// Counts, bounds and checksum of a run of points.
class LasTally {
 public:
  /// `with_checksum` costs about as much again as the counts. The batches then need `returns`.
  explicit LasTally(bool with_checksum = false) : with_checksum_(with_checksum) {}

  /// Adds the points of a batch decoded with all of PointFields (returns only for the checksum).
  void add(const PointBatch& batch);
  /// Adds the points of another tally that come right after those of this one. Both with, or both without checksum.
  void append(const LasTally& later);

  [[nodiscard]] std::uint64_t points() const { return points_; }
  [[nodiscard]] std::uint64_t withheld() const { return withheld_; }
  /// [256] points of each class, withheld ones included.
  [[nodiscard]] const std::array<std::uint64_t, 256>& classes() const { return classes_; }
  /// Least and greatest integer of x, y, z; min > max when there is no point.
  [[nodiscard]] const std::array<std::int32_t, 3>& min() const { return min_; }
  [[nodiscard]] const std::array<std::int32_t, 3>& max() const { return max_; }
  [[nodiscard]] std::uint64_t checksum() const { return checksum_; }

 private:
  void add_checksum(const PointBatch& batch);

  bool with_checksum_;
  std::uint64_t points_ = 0, withheld_ = 0;
  std::array<std::uint64_t, 256> classes_{};
  std::array<std::int32_t, 3> min_{kMost, kMost, kMost}, max_{kLeast, kLeast, kLeast};
  std::uint64_t checksum_ = 0;  // a polynomial in a fixed base modulo 2^61 - 1, hence easy to append

  static constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  static constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
};

struct LasSummary {
  LasHeader header;
  LasTally tally;                      ///< of the points that could be decoded
  std::array<double, 3> min{}, max{};  ///< of those points [units of the CRS]; zeros when there is none
  bool complete = true;                ///< every declared point is there and whole
  std::string problem;                 ///< why not; empty when complete
  std::string checksum;                ///< 16 hexadecimal digits, or empty: not asked for, or not complete
};

/// Decodes a whole file on the calling thread. What is wrong with its points is told in `problem`.
///
/// Complexity: O(points) time, O(chunk) memory.
/// Fails: the header cannot be read (Error(input)).
[[nodiscard]] LasSummary summarize_las(const std::string& path, bool with_checksum = false);

}  // namespace hydrotin
