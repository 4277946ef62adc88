#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "hydrotin/river_constraints.h"

namespace hydrotin::app {

/// The vertices in each polygon of a vector file, its border included; a polygon without vertices is no lake.
/// @param crs_wkt  of the vertices; empty = unknown.
/// Complexity: O(n log n + sum over polygons of its corners times the vertices between its west and its east).
/// Fails: Error(input): the file, or a vertex in two polygons.
[[nodiscard]] std::vector<Lake> read_lakes(const std::string& path, std::span<const std::array<double, 2>> position,
                                           const std::string& crs_wkt);

}  // namespace hydrotin::app
