#pragma once

#include <cstdint>
#include <vector>

#include "polygon_costs.h"
#include "quadrilateral_program.h"

/// Improving a triangulation of a polygon by flips: what is left where a search would take too long, and de Kok et
/// al.'s flip heuristic (2007) on its own.

namespace hydrotin {

/// What decides whether a flip is an improvement, before all others first.
struct FlipCriterion {
  int slot = -1;                               ///< a slot of the costs; or
  const std::vector<double>* score = nullptr;  ///< [triangles] the worse of the two triangles counts; or
  bool by_pairs = false;                       ///< the quadrilateral objective; or
  bool by_degree = false;                      ///< the largest degree among the four vertices
};

/// Flips edges in (x, y) order, pass by pass, as long as a flip improves; at most `max_passes`.
/// @param triangles  a triangulation of the polygon; replaced
/// O(triangles) a pass.
void improve_by_flips(const PolygonGraph& graph, const PolygonOptions& options, const PolygonCosts& costs,
                      const std::vector<FlipCriterion>& criteria, const BeyondSides& beyond,
                      std::vector<std::uint32_t>& triangles, int max_passes = 64);

}  // namespace hydrotin
