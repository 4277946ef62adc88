#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "box_tree.h"
#include "hydrotin/vertical_error.h"
#include "polygon_figures.h"
#include "store.h"

/// Vertical errors of the points that thinning removed, measured against the finished TIN, from its files alone.
///
/// A point belongs to one triangle, whichever file holds that: each is found exactly once, or lies outside everything.

namespace hydrotin {

struct RemovedFigures {
  std::uint64_t points = 0;
  std::uint64_t beyond = 0;    ///< farther than the limit from the TIN through the heights as measured
  std::uint64_t not_once = 0;  ///< in no triangle, or in two
  TriangleError measured;      ///< from the TIN through the heights as measured; without triangles added by rivers
  TriangleError final;         ///< from the final one, after edits of heights

  void add(const RemovedFigures& other);
  friend bool operator==(const RemovedFigures&, const RemovedFigures&) = default;
};

/// @param tile    whose removed points are measured
/// @param open    terrain files by tile  @param bounds  of the triangles in them
/// Complexity: O(points + triangles that meet them). Fails: Error(storage) naming the file.
[[nodiscard]] RemovedFigures measure_removed(std::uint32_t tile,
                                             const std::function<store::Reader(std::uint32_t)>& open,
                                             const BoxTree& bounds, const std::optional<ErrorLimit>& limit);

void write_removed_figures(store::Writer& out, const RemovedFigures& figures);
[[nodiscard]] RemovedFigures read_removed_figures(const store::Reader& in);

}  // namespace hydrotin
