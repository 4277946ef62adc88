#pragma once

#include <vector>

#include "polygon_graph.h"

/// Vertical errors of every triangle that a polygon may be made of, from the reference points inside it.

namespace hydrotin {

/// One entry per triangle of the graph. A triangle's points are found by flooding the Delaunay triangles that it
/// overlaps: O(overlaps + points in them).
/// @param limit  may be null
[[nodiscard]] std::vector<TriangleError> reference_errors(const PolygonGraph& graph, const ErrorLimit* limit);

}  // namespace hydrotin
