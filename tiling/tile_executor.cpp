#include "tile_executor.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace hydrotin {

Executor tile_executor() {
  return [](std::uint32_t count, const std::function<void(std::uint32_t)>& work) {
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(std::uint32_t{0}, count, work, tbb::simple_partitioner()); });
  };
}

}  // namespace hydrotin
