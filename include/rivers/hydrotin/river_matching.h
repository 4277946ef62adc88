#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hydrotin/lattice_terrain.h"
#include "hydrotin/river_constraints.h"
#include "hydrotin/river_lines.h"
#include "hydrotin/river_mouths.h"

/// From river lines to a network on a terrain: the steps of Section 7.2 in their order, each counted.
///
/// Lines get their directions, are split at their nodes, snapped to edges or inserted as edges, and cleaned; then lakes
/// through which rivers come back are closed, mouths are found and Steiner points are put where wingtips are on rivers.
///
/// Source   thesis, Section 7.2; FINDINGS D5, D6. Symbols  n = vertices, R = river edges, L = lines of the input.
/// Properties
///   (1) The result does not depend on the numbering of vertices.
///   (2) On a part of a terrain it is that of the whole wherever the lines stay inside and every triangle that is
///       removed or added has complete vertices only.
/// Threads  Pure.

namespace hydrotin {

enum class LineDirection : std::uint8_t { automatic, digitised, reversed, attribute };

struct LineMatching {
  bool insert = false;  ///< lines become edges; else they are snapped to edges
  LineDirection direction = LineDirection::automatic;
};

/// What became of something, step by step: a name and a number.
using StepCounts = std::vector<std::pair<std::string, std::uint64_t>>;

struct MatchedLines {
  LatticeTerrain terrain;                          ///< with inserted vertices after the old ones
  std::vector<RiverEdge> rivers;                   ///< [R] ascending by (x, y); without fault
  std::vector<std::uint32_t> line;                 ///< [R] source of the line that an edge comes from
  std::vector<std::uint8_t> is_turned;             ///< [L] runs against the order of its points
  std::vector<double> drop;                        ///< [L] downstream, by the terrain
  std::vector<std::uint32_t> disagrees;            ///< lines that rise downstream, by the terrain
  std::vector<std::vector<std::uint32_t>> cycles;  ///< lines that made circles; the first of each was left out
  StepCounts counts;
};

/// @param terrain     with links across edges.
/// @param lines       sources below num_lines; points may repeat.
/// @param is_against  [num_lines] with direction `attribute`: nonzero = drawn upstream; else unused.
/// @param z           heights that inserted vertices take, ascending by place; empty: those of the terrain.
/// Complexity: that of the steps. Fails: never on data.
[[nodiscard]] MatchedLines match_lines(const LatticeTerrain& terrain, const RiverLines& lines, std::size_t num_lines,
                                       const LineMatching& options, std::span<const std::uint8_t> is_against,
                                       std::span<const std::pair<LatticePoint, double>> z);

/// The outlets of a terrain with rivers: those given, and the lakes that no river leaves.
/// @param is_outlet  [n] by the policy; @param lake  [n] of `lake_numbers`.
void add_closed_lakes(std::span<const RiverEdge> rivers, std::span<const std::uint32_t> lake,
                      std::span<std::uint8_t> is_outlet);

/// How many mouths of each kind, and edges of chains.
void count_mouths(const OutletChains& mouths, StepCounts& counts);

/// Polygons in the plane as CSR. Polygon i has the rings ring_begin[i] .. ring_begin[i + 1], ring r the points
/// point[point_begin[r] .. point_begin[r + 1]).
struct PlanePolygons {
  std::span<const std::size_t> ring_begin, point_begin;
  std::span<const std::array<double, 3>> point;  ///< x, y, unused

  [[nodiscard]] std::size_t size() const { return ring_begin.size() - 1; }
};

/// The vertices inside each polygon or on its border (even-odd rule).
struct CoveredVertices {
  std::vector<std::vector<std::uint32_t>> vertex;    ///< [polygons] ascending by (x, y)
  bool overlaps = false;                             ///< two polygons cover one vertex: these two, and it
  std::uint32_t first = 0, second = 0, overlap = 0;  ///< where `overlaps`
};

/// Complexity: O(n log n + sum over polygons of its corners times the vertices between its west and its east).
[[nodiscard]] CoveredVertices vertices_in(const PlanePolygons& polygons,
                                          std::span<const std::array<double, 2>> position);

}  // namespace hydrotin
