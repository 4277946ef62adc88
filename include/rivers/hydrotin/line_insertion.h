#pragma once

#include <cstdint>

#include "hydrotin/line_snapping.h"

/// River lines as edges of the terrain: their points become vertices, their segments constrained edges.
///
/// The parts of the lines inside the terrain are snap-rounded with each other and with the vertices of the terrain, so
/// that all points lie on the lattice and no two segments cross. Points are inserted with the height that the terrain
/// has there (linear interpolation in the triangle that they lie in); segments then take the place of the edges that
/// they cross, and the triangles around are made constrained Delaunay. A line that leaves the terrain gets a vertex on
/// the rim: the lattice point nearest to the crossing in the closed triangle there (so the rim may give way by a unit),
/// or an end of the edge.
///
/// Source   thesis, Section 7.2, first way of matching; constrained Delaunay: Chapter 5, and Sloan 1993 for the flips.
/// Properties
///   (1) Of a Delaunay triangulation the result is the constrained Delaunay triangulation of all vertices and the
///       segments, ties as in predicates.h.
///   (2) Vertices of the terrain keep their numbers, heights and places; new ones follow.
///   (3) Each path runs along edges of the new terrain; what could not be inserted is counted.
/// Threads  Pure.

namespace hydrotin {

struct InsertionCounts {
  std::uint64_t outside = 0;    ///< reaches that lie outside the terrain altogether
  std::uint64_t pieces = 0;     ///< parts of reaches inside the terrain
  std::uint64_t crossings = 0;  ///< of segments with each other, now vertices
  std::uint64_t bent = 0;       ///< points that rounding put into segments
  std::uint64_t new_vertices = 0;
  std::uint64_t rim_vertices = 0;   ///< of these on the rim
  std::uint64_t lost_segments = 0;  ///< that rounding pushed out of the terrain
};

struct InsertedLines {
  LatticeTerrain terrain;
  RiverPaths paths;
  InsertionCounts counts;
};

/// @param reaches  of `split_at_nodes`, downstream.
/// Complexity: that of the walks and of snap rounding, plus the triangles changed.
[[nodiscard]] InsertedLines insert_lines(const TerrainLocator& locator, const RiverLines& reaches);

}  // namespace hydrotin
