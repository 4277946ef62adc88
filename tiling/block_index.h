#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hydrotin/lattice.h"
#include "store.h"

/// Points of a tile in blocks: runs of consecutive points along the curve with their boxes, so that a small region can
/// be read without the rest.

namespace hydrotin {

inline constexpr std::uint32_t kBlockPoints = 512;

/// What the names of the arrays of reference points begin with.
inline constexpr const char* kReference = "reference_";
/// The same for points that thinning removed.
inline constexpr const char* kRemoved = "removed_";

/// Arrays x, y, z and block_box (min x, min y, max x, max y per block).
/// @param prefix  of the names of the arrays
void write_points(store::Writer& out, std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                  const std::string& prefix = {});

struct TilePoints {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
};

[[nodiscard]] TilePoints read_points(const store::Reader& in, std::uint64_t first, std::uint64_t count,
                                     const std::string& prefix = {});

[[nodiscard]] std::vector<LatticeBox> read_block_boxes(const store::Reader& in, const std::string& prefix = {});

/// Interleaved boxes as they are stored.
[[nodiscard]] std::vector<std::int32_t> flatten(std::span<const LatticeBox> boxes);
[[nodiscard]] std::vector<LatticeBox> unflatten(std::span<const std::int32_t> values);

}  // namespace hydrotin
