#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "dataset.h"
#include "fingerprint.h"
#include "hydrotin/pits.h"
#include "problems.h"

/// What one terrain file says about itself, and what the others must agree with.
///
/// Threads  Pure but for reading the file.

namespace hydrotin {

__extension__ using Area = unsigned __int128;  ///< twice an area in squared lattice units

/// A directed edge with its terrain on the left.
struct PlacedEdge {
  std::uint64_t origin = 0, target = 0;  ///< PointId values
  LatticePoint from, to;
};

struct ForeignVertex {
  std::uint64_t point = 0;
  LatticePoint position;
  std::int32_t measured = 0, height = 0;
  std::uint32_t tile = 0;  ///< whose file says so
};

/// Triangles by the first 16 bits of `sample_key`.
inline constexpr std::size_t kSampleBins = 65536;

struct TileFacts {
  bool is_readable = false;
  Problems problems;
  Fingerprint fingerprint;
  Area twice_area = 0;
  std::vector<PlacedEdge> open;  ///< edges without twin in this file
  std::vector<PlacedEdge> hull;  ///< those that the file puts on the hull
  std::vector<ForeignVertex> foreign;
  PlateauSummary plateaus;        ///< of the final heights, kept pits apart
  PlateauSummary before, unkept;  ///< of the heights as measured, where pits are kept: all, and without kept ones
  std::vector<std::pair<std::uint64_t, std::uint64_t>> river, invalid_river;  ///< river edges: from, to; ascending
  std::vector<std::uint32_t> bins;                                            ///< [kSampleBins]
};

/// A number of a triangle that depends on its coordinates only and is spread evenly: samples are those with small ones.
[[nodiscard]] std::uint64_t sample_key(LatticePoint a, LatticePoint b, LatticePoint c);

/// Checks one file by itself. A file that cannot be read becomes a problem.
/// Complexity: O((n + T) log of degrees).
[[nodiscard]] TileFacts check_tile(const DatasetIndex& index, std::uint32_t tile);

}  // namespace hydrotin
