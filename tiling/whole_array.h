#pragma once

#include <cstdint>
#include <exception>

#include "schedule.h"

/// Whole-array loops of the global passes (outline, join, mend, drain), which run alone in their phase: no TBB task is
/// at work, so OpenMP may have all the threads.

namespace hydrotin {

/// Calls body(i) for i = 0 .. n - 1 on all workers of the run. The body writes to slot i of its own arrays only, so
/// that the result does not depend on the threads. The first exception, by index, is thrown on.
template <class Body>
void for_all(const RunContext& context, std::uint64_t n, Body body) {
  std::exception_ptr failure;
  std::int64_t failed = static_cast<std::int64_t>(n);
  const int threads = static_cast<int>(worker_count(context.options.run));
#pragma omp parallel for num_threads(threads) schedule(dynamic)
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(n); ++i) {
    try {
      body(static_cast<std::uint64_t>(i));
    } catch (...) {
#pragma omp critical(hydrotin_for_all)
      if (i < failed) {
        failed = i;
        failure = std::current_exception();
      }
    }
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace hydrotin
