#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hydrotin {

/// A priority queue of distinct integers below a bound, smallest first: a bit for each, and above every 64 bits one
/// that tells whether any of them is set. To push or to pop touches one word per level, most of them in the cache, and
/// compares nothing: where keys are ranks, this is faster than a heap by far.
class BitQueue {
 public:
  void reset(std::uint32_t bound) {
    num_levels_ = 0;
    do {
      bound = (bound + 63) / 64;
      std::vector<std::uint64_t>& words = level_[num_levels_++];
      words.assign(bound, 0);
    } while (bound > 1);
  }

  [[nodiscard]] bool empty() const { return level_[num_levels_ - 1].empty() || level_[num_levels_ - 1][0] == 0; }

  void push(std::uint32_t key) {
    for (std::size_t i = 0; i < num_levels_; ++i, key /= 64) {
      std::uint64_t& word = level_[i][key / 64];
      const bool was_empty = word == 0;
      word |= std::uint64_t{1} << (key % 64);
      if (!was_empty) return;
    }
  }

  [[nodiscard]] std::uint32_t top() const {
    std::uint32_t key = 0;
    for (std::size_t i = num_levels_; i-- > 0;)
      key = key * 64 + static_cast<std::uint32_t>(std::countr_zero(level_[i][key]));
    return key;
  }

  std::uint32_t pop() {
    const std::uint32_t key = top();
    std::uint32_t k = key;
    for (std::size_t i = 0; i < num_levels_; ++i, k /= 64) {
      std::uint64_t& word = level_[i][k / 64];
      word &= word - 1;  // the lowest bit is that of the key
      if (word != 0) break;
    }
    return key;
  }

 private:
  static constexpr std::size_t kMostLevels = 6;  // 64^6 > 2^32
  std::vector<std::uint64_t> level_[kMostLevels];
  std::size_t num_levels_ = 1;
};

}  // namespace hydrotin
