#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "polygon_search.h"

/// The best triangulation for local minima where vertices stand on the boundary of a polygon more than once, as the
/// ends of ties and of slits do: a dynamic program may count what it gives to such a vertex at each of its corners.
///
/// The program's value is then a bound that may not be reached. A vertex that was counted twice is given its lower
/// neighbour for nothing, which is a bound as well; if the answer happens to serve it, nothing is better. If not, all
/// edges that can serve it are forced one after the other, or it is left unserved: branch and bound.

namespace hydrotin {

/// Solves the polygon for other wishes [n] (as `wants_lower`) and blocked triangles; false if there is no answer.
using CountedProgram = std::function<bool(std::span<const std::uint8_t> wishes,
                                          const std::vector<std::uint8_t>& blocked, CountedAnswer& out)>;

/// Improves `best` to the best answer. False if that would take more than `max_programs` programs.
/// @param root  the answer to the wishes of the polygon, `best` among them
/// Deterministic: vertices in (x, y) order.
bool resolve_double_counts(const PolygonGraph& graph, const PolygonCosts& costs,
                           const std::vector<std::uint8_t>& blocked, const CountedProgram& program,
                           std::uint32_t max_programs, const CountedAnswer& root, PolygonAnswer& best);

}  // namespace hydrotin
