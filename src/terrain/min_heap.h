#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hydrotin {

/// A priority queue of integers, smallest first: a heap with four children, whose sift down misses the cache half as
/// often as one with two.
template <class Key>
class BasicMinHeap {
 public:
  void clear() { key_.clear(); }
  [[nodiscard]] bool empty() const { return key_.empty(); }
  [[nodiscard]] Key top() const { return key_.front(); }

  void push(Key key) {
    std::size_t i = key_.size();
    key_.push_back(key);
    for (; i > 0 && key < key_[(i - 1) / 4]; i = (i - 1) / 4) key_[i] = key_[(i - 1) / 4];
    key_[i] = key;
  }

  Key pop() {
    const Key smallest = key_.front(), key = key_.back();
    key_.pop_back();
    const std::size_t n = key_.size();
    if (n == 0) return smallest;
    std::size_t i = 0;
    for (std::size_t child = 1; child < n; child = 4 * i + 1) {
      if (child + 4 <= n) {  // two independent comparisons, then one
        const std::size_t left = child + (key_[child + 1] < key_[child]);
        const std::size_t right = child + 2 + (key_[child + 3] < key_[child + 2]);
        child = key_[right] < key_[left] ? right : left;
      } else {
        child = static_cast<std::size_t>(
            std::min_element(key_.begin() + static_cast<std::ptrdiff_t>(child), key_.end()) - key_.begin());
      }
      if (key <= key_[child]) break;
      key_[i] = key_[child];
      i = child;
    }
    key_[i] = key;
    return smallest;
  }

 private:
  std::vector<Key> key_;
};

using MinHeap = BasicMinHeap<std::uint64_t>;

}  // namespace hydrotin
