#pragma once

#include <cstdint>

namespace hydrotin {

/// A height or coordinate as an unsigned number below 2^32, in the same order.
[[nodiscard]] constexpr std::uint64_t biased(std::int32_t value) {
  return static_cast<std::uint32_t>(value) ^ 0x80000000u;
}

[[nodiscard]] constexpr std::int32_t unbiased(std::uint32_t value) {
  return static_cast<std::int32_t>(value ^ 0x80000000u);
}

/// Orders by height, then by a number.
[[nodiscard]] constexpr std::uint64_t height_key(std::int32_t height, std::uint32_t number) {
  return biased(height) << 32 | number;
}

}  // namespace hydrotin
