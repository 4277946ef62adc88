#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hydrotin/las.h"
#include "las_source.h"

// Header, VLRs and EVLRs, before any look at the points.

namespace hydrotin {

inline constexpr int kNumPointFormats = 11;

// Bytes of a record of each point format, without extra bytes.
inline constexpr std::array<std::uint16_t, kNumPointFormats> kFormatBytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

struct ParsedLas {
  LasHeader header;
  std::vector<std::uint8_t> laszip;  // payload of the laszip VLR; empty where there is none
};

[[nodiscard]] ParsedLas parse_las(const LasSource& source);

}  // namespace hydrotin
