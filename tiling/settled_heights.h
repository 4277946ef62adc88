#pragma once

#include <cstdint>
#include <vector>

#include "part.h"
#include "phases.h"

namespace hydrotin {

/// Final heights of a part: from `members`, and from `settle` of the tiles that solved groups it has a share in.
/// Fails: Error(storage) naming the file.
[[nodiscard]] std::vector<std::int32_t> settled_heights(const RunContext& context, std::uint32_t tile,
                                                        const Part& part);

}  // namespace hydrotin
