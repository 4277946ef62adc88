#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace hydrotin {

/// Sorts by a 64-bit key, ascending and stable: in as few passes as the range of the keys asks for, each by as many of
/// its bits, from the lowest. O(n) time, a second array of the size of the first.
template <class T, class Key>
void radix_sort(std::vector<T>& values, Key key) {
  static_assert(std::is_same_v<decltype(key(values.front())), std::uint64_t>, "shifted by up to 63 bits");
  if (values.size() < 2) return;
  std::uint64_t least = key(values.front()), most = least;
  for (const T& value : values) {
    least = std::min(least, key(value));
    most = std::max(most, key(value));
  }
  constexpr int kFewBits = 8, kManyBits = 11;  // more bits a pass only where the counts are few beside the values
  const int widest = values.size() < 10'000 ? kFewBits : kManyBits;
  const int bits = static_cast<int>(std::bit_width(most - least)), num_passes = (bits + widest - 1) / widest;
  if (num_passes == 0) return;
  const int width = (bits + num_passes - 1) / num_passes;
  const std::uint64_t mask = (std::uint64_t{1} << width) - 1;
  std::vector<std::size_t> offset(mask + 1);
  std::vector<T> sorted(values.size());
  for (int shift = 0; shift < bits; shift += width) {
    std::fill(offset.begin(), offset.end(), 0);
    for (const T& value : values) ++offset[((key(value) - least) >> shift) & mask];
    std::size_t sum = 0;
    for (std::size_t& slot : offset) {
      const std::size_t here = slot;
      slot = sum;
      sum += here;
    }
    for (const T& value : values) sorted[offset[((key(value) - least) >> shift) & mask]++] = value;
    values.swap(sorted);
  }
}

}  // namespace hydrotin
