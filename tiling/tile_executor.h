#pragma once

#include "hydrotin/executor.h"

/// Threads for the parts of one tile.

namespace hydrotin {

/// Carries parts out on all of TBB's workers that have nothing else to do. A worker that waits for the parts of its
/// tile does not begin another tile, so that no more tiles are in flight than the budget allows.
[[nodiscard]] Executor tile_executor();

}  // namespace hydrotin
