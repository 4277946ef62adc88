#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "block_index.h"
#include "hydrotin/lattice.h"
#include "store.h"

/// The files of a finished terrain, terrain/tile_NNNNNN.h5: what users open. N = own points, F = foreign points,
/// T = triangles, H = edges on the convex hull. All coordinates are integers of the lattice.
///
///     x, y, z         i32 [N]   own points; z as measured
///     block_box       i32 [4B]  boxes of runs of 512 points: min x, min y, max x, max y
///     height          i32 [N]   final height; kUnusedHeight: see the foreign lists of other tiles
///     foreign_point   u64 [F]   tile << 32 | index, ascending; tile = number of tiles: vertices that rivers added
///     foreign_xyz     i32 [3F]  z as measured
///     foreign_height  i32 [F]   final height
///     triangle        u32 [3T]  counter-clockwise: < N own point, else N + entry of foreign_point
///     triangle_box    i32 [4R]  boxes of runs of 1024 triangles
///     hull_edge       u64 [2H]  origin, target; the terrain on the left
///     pit_xyz         i32 [3Q]  pits before lifting inside this part: place and height
///     pit_level       i32 [Q]   where they overflow
///     pit_vertices    u64 [Q]   vertices of their plateaus
///     outlet_vertex   u32       vertices at which water may leave by a layer or at voids, numbered as in triangle
///     kept_vertex     u32       vertices of pits that were to be kept
///     river_moved     u32 [M]   vertices that the rivers moved; with rivers only, as the next eight
///     river_height    i32 [M]   their heights before pits were removed
///     river_edge      u32 [2R]  river edges of these triangles: from, to; numbered as in triangle
///     invalid_river_edge  u32   those of them along which water climbs, or that are no valleys
///     no_valley_edge  u32       those above a side of theirs, whether that is asked for or not
///     river_source    u32 [S]   vertices with a river edge down; steepest_way f64 [S] over these triangles
///     added_triangle  u32       triangles that came with the rivers: their order is not limited
///     removed_x, removed_y, removed_z, removed_block_box   as x, y, z, block_box: own points that thinning removed
///     final_...                 plateaus of the final heights (see reduced_store.h)
///     lattice_scale_offset f64 [5], lattice_base i64 [3]
///                               coordinate = (base + integer) * scale + offset
///
/// Attributes: tile, crs, points, vertices, triangles, rim_vertices, order, outlets (hull, lowest, layer), pits_removed
/// (0, 1), pit_method, fingerprint, recipe, writer.

namespace hydrotin {

/// Own points that no triangle of their tile's file uses.
inline constexpr std::int32_t kUnusedHeight = std::numeric_limits<std::int32_t>::min();
inline constexpr std::uint32_t kRunTriangles = 1024;

void write_lattice(store::Writer& out, const Lattice& lattice);
[[nodiscard]] Lattice read_lattice(const store::Reader& in);

/// Triangles with their vertices, apart from the rest of a tile.
struct TrianglePatch {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;     ///< final
  std::vector<std::int32_t> measured;   ///< if asked for
  std::vector<std::uint32_t> triangle;  ///< [3T]
  std::vector<std::uint8_t> is_added;   ///< [T] came with the rivers; if `measured` is asked for
};

/// The runs of triangles of a terrain file whose boxes meet `box`; only what they need is read.
/// Fails: Error(storage) naming the file.
[[nodiscard]] TrianglePatch read_patch(const store::Reader& in, const LatticeBox& box, bool with_measured = false);

}  // namespace hydrotin
