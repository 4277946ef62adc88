#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/vertex_graph.h"
#include "part.h"
#include "phases.h"
#include "store.h"

/// The surface of a tile's part with its levels, as the phases of pit removal share it: in the output of `pools`, so
/// that a few triangles of it can be read alone.
///
///     point u64 [n], xyz i32 [3n], level i32 [n], outlet u8 [n], rim u8 [n]
///     triangle u32 [3T], triangle_box i32 [4R]   runs of 1024 triangles
///
/// Errors  Error(storage) naming the file for arrays that contradict each other.

namespace hydrotin {

struct Surface {
  std::vector<std::uint64_t> point;     ///< [n] PointId values
  std::vector<LatticePoint> position;   ///< [n]
  std::vector<std::int32_t> height;     ///< [n] as measured
  std::vector<std::int32_t> level;      ///< [n] of `lift` over the whole terrain
  std::vector<std::uint8_t> is_outlet;  ///< [n]
  std::vector<std::uint8_t> is_rim;     ///< [n] of one part; empty for a window
  std::vector<std::uint32_t> triangle;  ///< [3T]
  VertexGraph graph;

  [[nodiscard]] std::uint32_t num_vertices() const { return static_cast<std::uint32_t>(point.size()); }
};

/// Levels and outlets of a part, from the slices of `drain`.
struct PartLevels {
  std::vector<std::int32_t> level;      ///< [n]
  std::vector<std::uint8_t> is_outlet;  ///< [n] as all parts together know it
};
[[nodiscard]] PartLevels levels_of(const RunContext& context, std::uint32_t tile, const Part& part);

void write_surface(store::Writer& out, const Surface& surface);
[[nodiscard]] Surface read_surface(const store::Reader& in);

/// A cell of a fixed grid over the lattice.
using Cell = std::pair<std::int32_t, std::int32_t>;

/// Squares of lattice points, each with about 256 vertices if these were spread evenly. The result of a phase
/// does not depend on their size.
class CellGrid {
 public:
  static constexpr std::uint64_t kVertices = 256;
  explicit CellGrid(const Outline& outline);
  [[nodiscard]] Cell of(LatticePoint p) const { return {p.x >> shift_, p.y >> shift_}; }
  [[nodiscard]] LatticeBox box(const Cell& cell) const;

 private:
  int shift_ = 0;
};

/// Whether a box meets one of some cells.
/// @param cells  ascending, distinct. Complexity: O(log cells) for each column of the box.
[[nodiscard]] bool meets(const LatticeBox& box, const CellGrid& grid, std::span<const Cell> cells);

/// All triangles of the terrain with a corner in one of some cells: vertices in the cells have all their triangles.
/// Vertices ascend by (x, y).
/// @param cells          ascending, distinct.
/// @param most_vertices  no more are loaded. (Those that tiles share count for each.)
/// @return               nothing if there are more.
[[nodiscard]] std::optional<Surface> read_window(const RunContext& context, const CellGrid& grid,
                                                 std::span<const Cell> cells, std::uint64_t most_vertices);

/// One surface of several that share vertices; vertices ascend by (x, y).
[[nodiscard]] Surface merged(std::span<const Surface> parts, const std::string& path);

}  // namespace hydrotin
