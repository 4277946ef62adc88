#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace hydrotin {

/// Sorts by a 64-bit key, ascending and stable, a byte per pass from the lowest; passes over bytes in which all keys
/// agree are left out. O(n) time, a second array of the size of the first.
template <class T, class Key>
void radix_sort(std::vector<T>& values, Key key) {
  static_assert(std::is_same_v<decltype(key(values.front())), std::uint64_t>, "shifted by up to 56 bits");
  if (values.size() < 2) return;
  std::array<std::array<std::size_t, 256>, 8> count{};
  for (const T& value : values) {
    const std::uint64_t k = key(value);
    for (std::size_t byte = 0; byte < 8; ++byte) ++count[byte][(k >> (8 * byte)) & 255];
  }
  std::vector<T> sorted(values.size());
  for (std::size_t byte = 0; byte < 8; ++byte) {
    auto& offset = count[byte];
    if (offset[(key(values.front()) >> (8 * byte)) & 255] == values.size()) continue;
    std::size_t sum = 0;
    for (std::size_t& slot : offset) {
      const std::size_t here = slot;
      slot = sum;
      sum += here;
    }
    for (const T& value : values) sorted[offset[(key(value) >> (8 * byte)) & 255]++] = value;
    values.swap(sorted);
  }
}

}  // namespace hydrotin
