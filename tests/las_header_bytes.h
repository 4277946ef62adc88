#pragma once

#include <cstdint>
#include <cstring>

#include "las_memory_file.h"

namespace hydrotin::testing {

/// The header of an uncompressed LAS file without VLRs, whose points would follow.
inline Bytes las_header_bytes(int minor, int format, std::uint16_t record_length, std::uint64_t points) {
  const std::uint16_t bytes = minor >= 4 ? 375 : 227;
  Bytes h(bytes, 0);
  std::memcpy(h.data(), "LASF", 4);
  h[24] = 1;
  h[25] = static_cast<std::uint8_t>(minor);
  poke(h, 94, bytes);
  poke(h, 96, std::uint32_t{bytes});
  h[104] = static_cast<std::uint8_t>(format);
  poke(h, 105, record_length);
  if (minor >= 4) {
    poke(h, 247, points);
  } else {
    poke(h, 107, static_cast<std::uint32_t>(points));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) poke(h, 131 + 8 * axis, 0.01);
  return h;
}

}  // namespace hydrotin::testing
