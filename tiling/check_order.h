#pragma once

#include <cstdint>

#include "box_tree.h"
#include "dataset.h"
#include "problems.h"

/// Orders of triangles recounted from the definition: the points of all files strictly inside the (perturbed) circle.
///
/// Source   thesis, Definition 2.1; ties as in geometry's predicates.
/// Threads  Pure but for reading files; tiles may be checked concurrently.

namespace hydrotin {

struct OrderCount {
  std::uint64_t counted = 0;
  int max_order = 0;  ///< at most kCountedOrder
};

/// Points inside a circle beyond this number are not counted.
inline constexpr int kCountedOrder = 1000;

/// Counts the orders of the triangles of a file whose `sample_key` has its first 16 bits below `bins`.
/// Complexity: per triangle O(log) plus the points of the blocks that its circle meets.
/// Fails: Error(storage) if a file cannot be read.
[[nodiscard]] OrderCount check_orders(const DatasetIndex& index, const BoxTree& tile_boxes, std::uint32_t tile,
                                      std::uint32_t bins, Problems& problems);

}  // namespace hydrotin
