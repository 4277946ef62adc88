#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "hydrotin/lattice.h"
#include "hydrotin/raster_frame.h"

/// The terrain as a raster: linear interpolation of triangles at cell centres.
///
/// Each centre belongs to at most one triangle of a triangulation: to the one that contains it after a shift by
/// (eps, eps^2) for an infinitesimal eps > 0. So a centre on an edge goes to the triangle on the right of the edge
/// (above it, if the edge is horizontal), a centre on a vertex to the one triangle whose corner opens that way, and a
/// centre on the outer boundary is inside on left and lower sides and outside on right and upper ones. Coordinates
/// alone decide.
///
/// Properties
///   (1) Each centre in the interior of a triangulated region is written exactly once.
///   (2) The value is a function of the triangle's coordinates and heights and of the cell: whoever computes it, in
///       whatever order of triangles and of their vertices, gets the same bits.
///   (3) Rasters of the parts of a triangulation, in any windows, are pieces of the raster of the whole.
/// Units    heights on the z lattice; values in world units as float.
/// Threads  Pure but for `value`: concurrent calls must write different arrays.

namespace hydrotin {

inline constexpr std::uint64_t kNoEdgeLimit = std::numeric_limits<std::uint64_t>::max();

/// The largest squared edge length in squared lattice units that does not exceed `max_edge` world units; kNoEdgeLimit
/// if max_edge is infinite or beyond all lattices. max_edge >= 0.
[[nodiscard]] std::uint64_t squared_edge_limit(double max_edge, const Lattice& lattice);

/// Writes the heights of triangles at the centres of the cells of a window; leaves all other cells alone.
///
/// @param position         [n] vertices on the lattice.
/// @param height           [n] heights on the z lattice.
/// @param triangle_vertex  [3T] vertex ids below n, in either sense of rotation; triangles of area 0 cover nothing.
/// @param window           range of cells of `frame`; at most 2^31 - 1 columns and rows.
/// @param max_squared_edge triangles with an edge longer than this are left out.
/// @param value            [num_rows * num_columns of the window] row by row from the top; fill it with "no data"
/// first.
/// @return                 number of cells written.
/// Complexity: O(n + T + rows touched by triangles + cells covered) time; 8 bytes per vertex and per column and row.
/// Fails: never on data; std::bad_alloc. Preconditions are asserted.
std::uint64_t rasterize(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                        std::span<const std::uint32_t> triangle_vertex, const Lattice& lattice,
                        const RasterFrame& frame, const CellRange& window, std::uint64_t max_squared_edge,
                        std::span<float> value);

}  // namespace hydrotin
