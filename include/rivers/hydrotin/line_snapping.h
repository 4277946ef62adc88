#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/line_walk.h"
#include "hydrotin/river_lines.h"

/// River lines snapped to edges of the terrain.
///
/// Each point where a line crosses an edge goes to the nearer end of the edge; points of the line inside triangles go,
/// which simplifies it to the resolution of the terrain. Consecutive points lie in one triangle, so their vertices are
/// joined by an edge. The ends of a line go to the nearest corner of their triangle: lines that share an end share its
/// vertex.
///
/// Source   thesis, Section 7.2 and Figure 7.4.
/// Properties
///   (1) Consecutive vertices of a path are different and joined by an edge of the terrain.
///   (2) Of two ends equally near the smaller in (x, y) order is taken: the direction of the line does not matter.
/// Threads  Pure.

namespace hydrotin {

/// Ways along vertices of a terrain, downstream, as CSR. Path i: vertex[begin[i] .. begin[i + 1]).
struct RiverPaths {
  std::vector<std::size_t> begin{0};
  std::vector<std::uint32_t> vertex;
  std::vector<std::uint32_t> line;  ///< [paths] the line of the input (`RiverLines::source`)

  [[nodiscard]] std::size_t size() const { return line.size(); }
  [[nodiscard]] std::span<const std::uint32_t> path(std::size_t i) const {
    return {vertex.data() + begin[i], vertex.data() + begin[i + 1]};
  }
};

struct SnappingCounts {
  std::uint64_t crossings = 0;       ///< of lines with edges
  std::uint64_t dropped_points = 0;  ///< of lines, inside triangles
  std::uint64_t outside = 0;         ///< reaches that lie outside the terrain altogether
  std::uint64_t pieces = 0;          ///< parts of reaches inside the terrain
  std::uint64_t vanished = 0;        ///< parts that snapped to one vertex
  std::uint64_t repeated = 0;        ///< points snapped to the vertex of the point before
};

struct SnappedLines {
  RiverPaths paths;
  SnappingCounts counts;
};

/// @param reaches  of `split_at_nodes`, downstream.
/// Complexity: that of the walks.
[[nodiscard]] SnappedLines snap_lines(const TerrainLocator& locator, const RiverLines& reaches);

}  // namespace hydrotin
