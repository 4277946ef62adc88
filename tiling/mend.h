#pragma once

#include <cstdint>
#include <vector>

#include "phases.h"
#include "polygon_figures.h"

/// Local minima that polygons left, saved by their neighbours: what `triangulate` does for point sets in memory, after
/// the exact recursion of the thesis, Section 3.2.2, for each polygon.
///
/// A vertex that its polygon left without a lower neighbour is offered to all other polygons around it. Each of these
/// is solved once more, and the new answer is kept if no vertex of its own suffers. One round: the final answer of a
/// polygon rests on the first answers of its neighbours only, so it is the same for every tiling.
///
/// Every polygon that may be offered a vertex is among the seams: `triangulate` hands a polygon on as a piece, even if
/// it lies inside the tile, when a vertex of it depends on a polygon that the tile does not know as a whole, or was
/// left by another polygon of the tile. So seam files are all that changes.

namespace hydrotin {

/// What changes in the seam file of one tile.
struct Mending {
  std::vector<std::uint32_t> polygon;   ///< polygons of the file with new answers, ascending
  ResultTable result;                   ///< of these
  std::vector<std::uint64_t> position;  ///< triangles of the file to be replaced, ascending
  std::vector<std::uint32_t> triangle;  ///< by these: numbers of its points, three per triangle
  std::uint64_t changed = 0;            ///< polygons whose set of triangles is another one now
};

/// What changes in a tile's triangles: `position` and `triangle` only.
/// Fails: Error(storage) if the arrays contradict each other.
[[nodiscard]] Mending read_mended_triangles(const RunContext& context, std::uint32_t tile);

/// The results of the seam polygons of all tiles after mending: those of tile t are result[begin[t] .. begin[t + 1]).
struct MendedResults {
  std::vector<std::uint64_t> begin;
  std::vector<std::uint32_t> polygon;
  ResultTable result;
  std::vector<std::uint64_t> hopeless;  ///< [tiles] minima that the limit on errors makes unavoidable

  /// The figures of one tile's seam polygons. Fails: Error(storage).
  [[nodiscard]] PolygonFigures figures(const RunContext& context, std::uint32_t tile) const;
};

[[nodiscard]] MendedResults read_mended_results(const RunContext& context);

/// Writes the output of the phase.
/// @param hopeless  [tiles] as in MendedResults
void write_mendings(const RunContext& context, const std::vector<Mending>& tiles,
                    const std::vector<std::uint64_t>& hopeless);

}  // namespace hydrotin
