#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "block_index.h"
#include "hydrotin/vertex_graph.h"
#include "phases.h"

/// The part of the TIN that one tile has solved: its own polygons and the seams given to it.
///
/// The parts of all tiles partition the triangles of the TIN. Parts share vertices: of a shared vertex each part has
/// some of the triangles around it, but not all, so it is the end of an edge without twin that is not on the convex
/// hull.
///
/// Symbols  n = vertices of the part, T = triangles, H = its hull edges, F = its foreign vertices.
/// Properties
///   (1) A vertex that two parts have is on the rim of both.
///   (2) New vertices of rivers are points of a tile of their own, after all others.
///   (3) The arrays depend on the set of triangles only, not on their order in the files.
/// Threads  Pure but for reading files.

namespace hydrotin {

struct Part {
  TilePoints own;                       ///< all canonical points of the tile
  std::uint32_t num_own = 0;            ///< vertices 0 .. num_own are the tile's own points
  std::vector<std::uint64_t> point;     ///< [n] PointId values: own ones ascending, then foreign ones ascending
  std::vector<LatticePoint> position;   ///< [n]
  std::vector<std::int32_t> measured;   ///< [n]
  std::vector<std::int32_t> height;     ///< [n] as measured, but where rivers were embedded: as they left it
  std::vector<std::uint32_t> triangle;  ///< [3T] counter-clockwise, smallest vertex first, ascending
  std::vector<DirectedEdge> hull_edge;  ///< [H] ascending
  std::vector<std::uint8_t> is_hull;    ///< [n] nonzero: end of a hull edge of this part
  std::vector<std::uint8_t> is_rim;     ///< [n] nonzero: another part has the vertex too
  std::vector<std::uint32_t> unused;    ///< indices of own points that are no vertex of this part, ascending
  VertexGraph graph;                    ///< of the triangles

  [[nodiscard]] std::uint32_t num_vertices() const { return static_cast<std::uint32_t>(point.size()); }
  [[nodiscard]] std::uint32_t num_triangles() const { return static_cast<std::uint32_t>(triangle.size() / 3); }
  /// The vertex of a point, if the part has it. O(log n).
  [[nodiscard]] std::optional<std::uint32_t> find(PointId id) const;
  /// Box of the triangles; empty if there is none.
  [[nodiscard]] LatticeBox bounds() const;
  /// Vertices on the rim by ascending point id: the order of SpillTree::rim.
  [[nodiscard]] std::vector<std::uint32_t> rim() const;
};

/// Reads a part from the outputs of `arrange`, `triangulate`, `seam` and `mend`; if the context has rivers, with the
/// triangles and heights that these changed.
/// Complexity: O(n log F + T).
/// Fails: Error(storage) naming the file if anything in it is out of range or contradicts another array.
[[nodiscard]] Part load_part(const RunContext& context, std::uint32_t tile);

/// [n] nonzero where a neighbour of the part is lower by (z, x, y).
[[nodiscard]] std::vector<std::uint8_t> has_lower_neighbor(const Part& part);

/// [n] nonzero where water may leave by the policy of the options. A vertex of several parts may have its flag in some
/// of them only: the flags of all parts together count, as the reduced trees and the plateau summaries take them.
[[nodiscard]] std::vector<std::uint8_t> outlet_flags(const RunContext& context, const Part& part);

}  // namespace hydrotin
