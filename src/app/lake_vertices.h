#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "hydrotin/river_constraints.h"

namespace hydrotin::app {

/// The vertices in each polygon of a vector file, its border included; a polygon without vertices is no lake.
/// @param crs_wkt      of the vertices; empty = unknown.
/// @param missing_wkt  of the polygons if their file names none; empty = that of the vertices.
/// @param level_field  attribute with the level of each lake; empty = lakes are level wherever is cheapest.
/// Complexity: O(n log n + sum over polygons of its corners times the vertices between its west and its east).
/// Fails: Error(input): the file, a vertex in two polygons, a level that is no number.
[[nodiscard]] std::vector<Lake> read_lakes(const std::string& path, std::span<const std::array<double, 2>> position,
                                           const std::string& crs_wkt, const std::string& missing_wkt,
                                           const std::string& level_field);

}  // namespace hydrotin::app
