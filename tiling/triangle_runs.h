#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "store.h"
#include "surface.h"

/// Shares of files of triangles (`lay`, `pools`): what lies near some cells, without reading the rest.
///
/// Such a file has `triangle` in runs of `kRunTriangles`, `triangle_box` with the box of each run, and arrays of
/// vertices, the first of which is `point`.
/// Errors  Error(storage) naming the file.

namespace hydrotin {

inline constexpr std::uint32_t kVertexGap = 16384;  ///< for vertices: a chunk of the store is read whole anyway

/// The triangles of runs that meet the cells, over the vertices of the file, in the order of the file.
[[nodiscard]] std::vector<std::uint32_t> read_triangle_runs(const store::Reader& in, const CellGrid& grid,
                                                            std::span<const Cell> cells);

/// The vertices that triangles use.
struct UsedVertices {
  std::vector<std::uint32_t> vertex;  ///< ascending
  std::vector<std::uint32_t> number;  ///< [n] in `vertex`; 2^32 - 1: not used
};

/// O(n + triangles): a table of all vertices numbers those in use without sorting.
[[nodiscard]] UsedVertices number_used(std::span<const std::uint32_t> triangle, std::uint64_t num_vertices);

}  // namespace hydrotin
