#pragma once

#include "hydrotin/executor.h"

namespace hydrotin::app {

/// Parts of a computation on so many threads; 0: on all cores.
[[nodiscard]] Executor worker_executor(int workers);

}  // namespace hydrotin::app
