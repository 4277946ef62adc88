#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "river_network_store.h"
#include "surface.h"

/// Windows on the terrain for what rivers ask: any set of cells with all triangles around.
///
/// A window holds every triangle of the terrain whose box meets one of its cells. So every vertex in a cell has its
/// complete star, and a line that stays in the cells does not leave the window where it does not leave the terrain.
/// What is done on a window and needs complete vertices only is as it is on the whole terrain.
///
/// Errors  Error(storage) naming the file.

namespace hydrotin {

struct RiverWindow {
  std::vector<std::uint64_t> point;        ///< [n] PointId values
  std::vector<LatticePoint> position;      ///< [n] ascending
  std::vector<std::int32_t> height;        ///< [n] as measured
  std::vector<std::uint8_t> is_outlet;     ///< [n] complete vertices: as all parts together know it
  std::vector<std::uint8_t> is_complete;   ///< [n] all triangles around it are there
  std::vector<std::uint32_t> triangle;     ///< [3T] counter-clockwise
  std::vector<std::uint32_t> tile;         ///< [T] whose part has the triangle
  std::vector<std::uint8_t> is_hull_edge;  ///< [3T] the edge from this corner is on the convex hull

  [[nodiscard]] std::uint32_t num_vertices() const { return static_cast<std::uint32_t>(point.size()); }
  /// The vertex at a place; all ones if there is none. O(log n).
  [[nodiscard]] std::uint32_t find(LatticePoint p) const;
};

/// Cells, growing: ascending and distinct.
class CellSet {
 public:
  explicit CellSet(const Outline& outline) : grid_(outline), bounds_(outline.bounds()) {}

  /// The cells of some vertices and those up to so many cells away, within the bounds of the terrain.
  void grow(std::span<const LatticePoint> position, std::span<const std::uint32_t> vertex, std::int32_t rings);
  /// Cells that the segment meets, and maybe some beside it.
  void add_segment(LatticePoint a, LatticePoint b);
  /// All cells that a box meets.
  void add_box(const LatticeBox& box);

  /// Sorts what was added.
  [[nodiscard]] std::span<const Cell> cells();
  [[nodiscard]] const CellGrid& grid() const { return grid_; }

 private:
  CellGrid grid_;
  LatticeBox bounds_;
  std::vector<Cell> cell_;
  std::size_t sorted_ = 0;
};

/// The box of the data and as much again around it: where lines have a say.
[[nodiscard]] LatticeBox reach_of(const LatticeBox& box);

/// The cells of lines, lakes and preserved edges: all that matching looks at first.
void add_river_cells(const RunContext& context, const RiverLines& lines, const LatticeBox& bounds, CellSet& cells);

/// Reads windows from the output of `lay`.
class WindowReader {
 public:
  /// @param bounds  [tiles] boxes of the parts
  /// @param patch   what replaces triangles; null: the terrain as it was before the rivers
  WindowReader(const RunContext& context, std::vector<LatticeBox> bounds, const RiverNetwork* patch)
      : context_(context), bounds_(std::move(bounds)), patch_(patch) {}

  [[nodiscard]] RiverWindow read(const CellGrid& grid, std::span<const Cell> cells) const;

 private:
  const RunContext& context_;
  std::vector<LatticeBox> bounds_;
  const RiverNetwork* patch_;
};

/// [tiles] Boxes of the parts, as the outputs of `lay` say.
[[nodiscard]] std::vector<LatticeBox> bounds_of_laid(const RunContext& context);

}  // namespace hydrotin
