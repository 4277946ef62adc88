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

/// A triangulation in which no vertex has more than `most` neighbours; false if there is certainly none without blocked
/// triangles. Where vertices stand on the boundary twice or edges are closed, each corner counts for itself and closed
/// edges do not count: the answer may exceed `most`. O(most) for each of the T + C triangles.
bool triangulate_with_degree(const PolygonGraph& graph, std::uint32_t most, const std::vector<std::uint8_t>& blocked,
                             const std::vector<std::uint8_t>& closed, std::vector<std::uint32_t>& triangles);

}  // namespace hydrotin
