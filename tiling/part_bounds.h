#pragma once

#include <vector>

#include "block_index.h"
#include "phases.h"
#include "store.h"

namespace hydrotin {

/// [tiles] Boxes of the tiles' triangles, as `drain` found them. Fails: Error(storage).
[[nodiscard]] inline std::vector<LatticeBox> bounds_of_parts(const RunContext& context) {
  const store::Reader in(context.layout.unit(Phase::drain, 0));
  auto bounds = unflatten(in.read<std::int32_t>("tile_bounds"));
  if (bounds.size() != context.plan.num_tiles())
    throw Error(ErrorKind::storage, in.path() + ": its bounds are not one per tile; delete the file and run again");
  return bounds;
}

}  // namespace hydrotin
