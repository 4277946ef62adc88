#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "small_points.h"

namespace hydrotin::app {

/// Everything about order k of a small point set, by input rows: tuples ascending, lists sorted.
struct OrderTables {
  std::vector<std::array<std::uint32_t, 3>> delaunay;                             ///< triangles
  std::vector<std::array<std::uint32_t, 3>> useful;                               ///< a, b, useful order (0: Delaunay)
  std::vector<std::pair<std::array<std::uint32_t, 3>, std::uint32_t>> triangles;  ///< of order at most k, with order
  std::vector<std::array<std::uint32_t, 2>> fixed;                                ///< edges
  std::vector<std::pair<std::uint32_t, std::uint32_t>> polygons;                  ///< Delaunay triangles, components
};

/// @param k  0 .. kMaxOrder
/// Complexity: expected O(n k^2).
[[nodiscard]] OrderTables order_tables(const SmallPoints& points, int k);

/// Fails: Error(config) for an order that the one-shot commands do not know.
void require_order(int order);

}  // namespace hydrotin::app
