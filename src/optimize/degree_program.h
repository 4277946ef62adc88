#pragma once

#include <cstdint>
#include <vector>

#include "polygon_graph.h"

/// Least maximum degree (T, Theorem 3.2): for every directed edge and every number of edges that the part on its left
/// may have at the origin, the least number that it then needs at the target.

namespace hydrotin {

/// Degrees of all vertices in a triangulation: `base_degree` and the edges inside the polygon.
[[nodiscard]] std::vector<std::uint32_t> degrees(const PolygonGraph& graph,
                                                 const std::vector<std::uint32_t>& triangles);

/// A triangulation in which no vertex has more than `most` neighbours; false if there is none without blocked
/// triangles. Exact if no vertex stands on the boundary twice and nothing is closed. O(most) for each of the T + C
/// triangles.
bool triangulate_with_degree(const PolygonGraph& graph, std::uint32_t most, const std::vector<std::uint8_t>& blocked,
                             const std::vector<std::uint8_t>& closed, std::vector<std::uint32_t>& triangles);

}  // namespace hydrotin
