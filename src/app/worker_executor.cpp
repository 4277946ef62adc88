#include "worker_executor.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <memory>

namespace hydrotin::app {

Executor worker_executor(int workers) {
  const auto arena = std::make_shared<tbb::task_arena>(workers > 0 ? workers : int{tbb::task_arena::automatic});
  return [arena](std::uint32_t count, const std::function<void(std::uint32_t)>& work) {
    arena->execute([&] { tbb::parallel_for(std::uint32_t{0}, count, work, tbb::simple_partitioner()); });
  };
}

}  // namespace hydrotin::app
