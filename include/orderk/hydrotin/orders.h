#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "hydrotin/lattice.h"

/// Orders of single triangles and edges of a point set, straight from the definitions: for study and for checks. All
/// useful edges and order-k triangles of a set are found much faster by useful_edges.h and order_k_triangles.h.
///
/// Source   thesis, Definitions 2.1 (order of a triangle), 2.2 (order of an edge: the fewest points in a circle through
///          its ends) and 2.3 with Lemma 2.1 (useful order: the larger order of the triangles that the edge forms with
///          the first points that circles sliding to its left and to its right hit on that side).
/// Ties     as everywhere: cocircular points are perturbed in (x, y) order.
/// Properties
///   (1) A Delaunay edge has order 0 and useful order 0.
///   (2) The useful order is at least the order.
///   (3) The order of a triangle is at least the order of each of its edges.
/// Errors   none; preconditions: indices below n, distinct, and distinct points.
/// Threads  Pure functions.

namespace hydrotin {

/// Points inside the circumcircle of a, b, c; nothing if they lie on one line. O(n).
[[nodiscard]] std::optional<std::uint32_t> triangle_order(std::span<const LatticePoint> points, std::uint32_t a,
                                                          std::uint32_t b, std::uint32_t c);

/// Points between a and b count for every circle. O(n log n).
[[nodiscard]] std::uint32_t edge_order(std::span<const LatticePoint> points, std::uint32_t a, std::uint32_t b);

/// Nothing if a point lies on the edge, or all points on its line. O(n).
[[nodiscard]] std::optional<std::uint32_t> useful_edge_order(std::span<const LatticePoint> points, std::uint32_t a,
                                                             std::uint32_t b);

}  // namespace hydrotin
