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

/// Arrays x, y, z and block_box (min x, min y, max x, max y per block).
void write_points(store::Writer& out, std::span<const LatticePoint> position, std::span<const std::int32_t> height);

struct TilePoints {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
};

[[nodiscard]] TilePoints read_points(const store::Reader& in, std::uint64_t first, std::uint64_t count);

[[nodiscard]] std::vector<LatticeBox> read_block_boxes(const store::Reader& in);

/// Interleaved boxes as they are stored.
[[nodiscard]] std::vector<std::int32_t> flatten(std::span<const LatticeBox> boxes);
[[nodiscard]] std::vector<LatticeBox> unflatten(std::span<const std::int32_t> values);

}  // namespace hydrotin
