#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// River edges on a terrain: edges of its triangles with a flow direction, and what must hold before heights change.
///
/// Source   thesis, Section 7.1 and Table 7.1: directed cycles make a strict decline infeasible.
/// Symbols  n = vertices, T = triangles, R = river edges.
/// Properties
///   (1) The networks are the connected components of the river edges; they are numbered by their smallest vertex in
///       (x, y) order, so that no numbering of vertices or edges matters.
///   (2) A network may meet in confluences and part in divergences; it has no directed cycle.
/// Units    metres (or the unit of the CRS), plane coordinates.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

/// A terrain in memory, or any part of one: non-owning.
struct RiverTerrain {
  std::span<const std::array<double, 2>> position;  ///< [n] distinct
  std::span<const double> height;                   ///< [n]
  std::span<const std::uint32_t> triangle;          ///< [3T] vertices of the triangles, any sense of rotation

  [[nodiscard]] std::uint32_t num_vertices() const { return static_cast<std::uint32_t>(position.size()); }
  [[nodiscard]] std::uint32_t num_triangles() const { return static_cast<std::uint32_t>(triangle.size() / 3); }
};

/// Water runs from `from` to `to`.
struct RiverEdge {
  std::uint32_t from = 0, to = 0;
  friend constexpr auto operator<=>(const RiverEdge&, const RiverEdge&) = default;
};

enum class NetworkFault : std::uint8_t {
  none,
  no_vertex,       ///< an end is no vertex, or both ends are the same
  no_edge,         ///< no triangle has this edge
  repeated,        ///< the same edge in the same direction again
  directed_cycle,  ///< water runs in a circle (an edge in both directions is one, too)
};

/// What is wrong with a list of river edges: the first fault found, and where.
struct NetworkCheck {
  NetworkFault fault = NetworkFault::none;
  std::vector<std::uint32_t> edge;  ///< indices of the edges in question; those of a cycle in its order
};

/// Complexity: O(n + T + R).
/// Fails: never on data; std::bad_alloc.
[[nodiscard]] NetworkCheck check_network(const RiverTerrain& terrain, std::span<const RiverEdge> rivers);

/// The connected networks. Precondition: the check found no fault.
struct RiverNetworks {
  std::vector<std::uint32_t> network;  ///< [R] of each edge
  std::vector<double> length, drop;    ///< [networks] sums over the edges, as the heights are
  std::uint32_t num_networks = 0;

  /// Sum of drops / sum of lengths; not positive where the heights contradict the directions.
  [[nodiscard]] double average_slope(std::uint32_t i) const { return drop[i] / length[i]; }
};

/// Complexity: O(n + R log R).
[[nodiscard]] RiverNetworks connect_networks(const RiverTerrain& terrain, std::span<const RiverEdge> rivers);

}  // namespace hydrotin
