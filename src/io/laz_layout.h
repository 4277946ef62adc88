#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hydrotin/las.h"

// How a LAZ file packs its points: the laszip VLR.

namespace hydrotin {

enum class LazCompressor : std::uint16_t { pointwise = 1, pointwise_chunked = 2, layered_chunked = 3 };

enum class LazItemKind : std::uint16_t {
  byte = 0,
  point10 = 6,
  gpstime11 = 7,
  rgb12 = 8,
  wavepacket13 = 9,
  point14 = 10,
  rgb14 = 11,
  rgbnir14 = 12,
  wavepacket14 = 13,
  byte14 = 14,
};

struct LazItem {
  LazItemKind kind = LazItemKind::byte;
  std::uint16_t size = 0, version = 0;
  std::uint16_t begin = 0;  // in the record
};

inline constexpr std::uint32_t kVariableChunks = 0xFFFFFFFFU;

struct LazLayout {
  LazCompressor compressor = LazCompressor::pointwise_chunked;
  std::uint32_t chunk_size = 50000;  // points; kVariableChunks: the chunk table counts them
  std::uint16_t record_length = 0;
  std::vector<LazItem> items;  // in the order of the record, which they fill
};

// The compressor's name, also for those that cannot be read.
[[nodiscard]] std::string compressor_name(std::uint16_t compressor);

// Checks the VLR against the header: afterwards every item is one that can be decoded. `path` is for messages.
[[nodiscard]] LazLayout parse_laszip(std::span<const std::uint8_t> payload, const LasHeader& header,
                                     const std::string& path);

}  // namespace hydrotin
