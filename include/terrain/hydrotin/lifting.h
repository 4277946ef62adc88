#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/vertex_graph.h"

/// Lifting (pit filling): the least surface above the terrain from which water can leave everywhere.
///
/// The level of a vertex is the least height that every way out must climb to:
///     f(v) = min over paths from v to an outlet of the maximum height on the path,
/// which is the greatest solution of f(v) = max(h(v), min over neighbours w of f(w)) with f = h at outlets. Raising
/// each vertex to f removes all pits and is optimal for total, maximum, count and volume of the change at once.
///
/// Source   thesis, Section 6.1 (propagated lifting along the contour tree; here as one flood from the outlets).
/// Symbols  n = vertices, E = edges, h = height, f = level.
/// Properties
///   (1) f >= h, f = h at outlets; no pit is left: from each vertex a path that never rises leads to an outlet.
///   (2) Every surface with (1) lies nowhere below f.
///   (3) Lifting a lifted terrain changes nothing.
///   (4) f is made by comparisons alone, no arithmetic: no tie has to be broken, no order of vertices or edges matters,
///       and a part flooded from the known levels of its rim gets the levels of the whole (`lift_from`).
/// Units    heights and levels are integers on the z lattice.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

/// The level of a vertex without a path to an outlet: the minimum over no path. Heights must be smaller.
inline constexpr std::int32_t kNoLevel = std::numeric_limits<std::int32_t>::max();

/// Levels of a whole terrain.
///
/// @param height     [n], each below kNoLevel.
/// @param is_outlet  [n], nonzero where water may leave. Every component of the graph should have one: a vertex without
///                   a path to an outlet gets kNoLevel, which the caller must treat as a mistake or as "leave it
///                   alone".
/// @return           [n] levels.
/// Complexity: O(n + E) plus O(log n) for each vertex that may overflow into a lower one; at most n.
/// Fails: never on data; std::bad_alloc. Preconditions are asserted.
[[nodiscard]] std::vector<std::int32_t> lift(const VertexGraph& graph, std::span<const std::int32_t> height,
                                             std::span<const std::uint8_t> is_outlet);

/// Levels of one part of a terrain, given the final levels of the vertices it shares with other parts.
///
/// @param source_level  [n], the known level (at least the height) of a source, kNoLevel elsewhere. Levels of sources
///                      must be those of the whole terrain; they are returned unchanged.
/// Otherwise as `lift`; an outlet has its own height whatever its source level.
[[nodiscard]] std::vector<std::int32_t> lift_from(const VertexGraph& graph, std::span<const std::int32_t> height,
                                                  std::span<const std::uint8_t> is_outlet,
                                                  std::span<const std::int32_t> source_level);

/// The vertex of the outlet policy `lowest`: the smallest by (z, x, y), so the same in every storage order.
///
/// @param position  [n], n >= 1.
[[nodiscard]] std::uint32_t lowest_vertex(std::span<const std::int32_t> height, std::span<const LatticePoint> position);

}  // namespace hydrotin
