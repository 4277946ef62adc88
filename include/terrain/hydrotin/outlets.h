#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/vertex_graph.h"

/// Outlets: the vertices where water may leave the terrain.
///
/// Source   FINDINGS C1: outlets are a policy; the thesis (Section 6.1) has the single global minimum.
/// Symbols  n = vertices, b = boundary edges.
/// Properties
///   (1) Every piece of the terrain has an outlet with `hull_outlets` and `lowest_outlets`.
///   (2) Vertices of no triangle are pieces of their own: they are outlets in all policies.
///   (3) Nothing depends on the numbering of vertices.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

enum class VoidOutlets : std::uint8_t { closed, draining };

/// Water may leave at the outer boundary of each piece of the terrain, and at holes if voids drain.
///
/// Boundary edges form closed walks with the terrain on the left; walks are told apart by their direction: the outer
/// ones run counter-clockwise. Where several meet at a vertex, a walk goes on along the first boundary edge counter-
/// clockwise from the edge it came on, that is, round the same part of the outside.
///
/// @param graph     of all triangles, each counter-clockwise.
/// @param position  [n]
/// @return          [n] nonzero: outlet.
/// Complexity: O(n + b log d), d = boundary edges at a vertex. Fails: never on data; std::bad_alloc.
[[nodiscard]] std::vector<std::uint8_t> hull_outlets(const VertexGraph& graph, std::span<const LatticePoint> position,
                                                     VoidOutlets voids);

/// For each vertex the number of its piece of the terrain, 0 .. pieces - 1 in the order of their smallest (x, y).
/// Complexity: O(n + E).
[[nodiscard]] std::vector<std::uint32_t> pieces_of(const VertexGraph& graph, std::span<const LatticePoint> position);

/// The lowest vertex of each piece, ties by (x, y).
/// Complexity: O(n + E).
[[nodiscard]] std::vector<std::uint8_t> lowest_outlets(const VertexGraph& graph, std::span<const std::int32_t> height,
                                                       std::span<const LatticePoint> position);

/// The smallest vertex by (x, y) of each piece without outlet, in that order: nothing can drain there.
/// Complexity: O(n + E).
[[nodiscard]] std::vector<std::uint32_t> pieces_without_outlet(const VertexGraph& graph,
                                                               std::span<const LatticePoint> position,
                                                               std::span<const std::uint8_t> is_outlet);

/// Voids as long edges: sets the flags of the corners of triangles with an edge longer than a limit.
///
/// @param triangle_vertex     [3T]
/// @param max_squared_edge    squared lattice units; `squared_edge_limit` of rasterize.h.
/// Complexity: O(T).
void mark_void_corners(std::span<const LatticePoint> position, std::span<const std::uint32_t> triangle_vertex,
                       std::uint64_t max_squared_edge, std::span<std::uint8_t> is_outlet);

}  // namespace hydrotin
