#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

// Little-endian numbers at any address, as LAS stores them.

namespace hydrotin {

static_assert(std::endian::native == std::endian::little, "LAS numbers are copied as they are");

template <class T>
[[nodiscard]] inline T load(const std::uint8_t* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

template <class T>
inline void store(std::uint8_t* to, T value) {
  std::memcpy(to, &value, sizeof value);
}

}  // namespace hydrotin
