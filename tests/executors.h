#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "hydrotin/executor.h"

/// Executors that carry parts out in other orders than one after the other.

namespace hydrotin::testing {

inline void backwards(std::uint32_t count, const std::function<void(std::uint32_t)>& work) {
  for (std::uint32_t i = count; i-- > 0;) work(i);
}

inline void on_four_threads(std::uint32_t count, const std::function<void(std::uint32_t)>& work) {
  std::atomic<std::uint32_t> next = 0;
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (std::uint32_t i = next++; i < count; i = next++) work(i);
    });
}

}  // namespace hydrotin::testing
