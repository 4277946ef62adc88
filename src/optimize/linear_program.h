#pragma once

#include <cstdint>
#include <vector>

#include "polygon_costs.h"

/// The triangulations of a polygon with many components inside, as a linear program over its triangles.
///
/// One variable per triangle; for every inner edge the triangles on its left and on its right are equally many, at
/// every side of the polygon there is one. For sums over triangles the program was integral in every experiment; where
/// it is not, it is branched on. Its dual is a certificate: the bound is computed from it, not taken from the solver.
/// Source: the conditions are those of de Loera, Hosten, Santos and Sturmfels, "The polytope of all triangulations of a
/// point configuration", 1996; restricted to order-k triangles it replaces the O(k)^h ways of T3.3.

namespace hydrotin {

struct LinearOutcome {
  std::vector<std::uint32_t> triangle;  ///< of the best answer; empty: none found
  bool proven = false;                  ///< no answer is better; or there is none
  double first_bound = 0;               ///< no answer has less in the first slot
  std::uint32_t programs = 0;
};

/// @param size          triangles of an answer
/// @param incumbent     an answer that is known, empty if none is. If local minima are all that counts, an answer that
///                      serves as many is not looked for.
/// @param max_programs  nodes of the tree of branches
/// Deterministic: rows and columns are in (x, y) order.
[[nodiscard]] LinearOutcome solve_linear_program(const PolygonGraph& graph, const PolygonCosts& costs,
                                                 const std::vector<std::uint8_t>& blocked, std::uint32_t size,
                                                 std::uint32_t max_programs, std::vector<std::uint32_t> incumbent = {});

}  // namespace hydrotin
