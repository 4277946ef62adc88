#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace hydrotin::app {

/// Edges from CSV: a header line, then two 0-based indices a line, separated by a comma, a semicolon or blanks.
/// @param num_vertices  indices must be smaller
/// Fails: Error(input) with file and line.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> read_edges(const std::string& path, std::uint64_t num_vertices);

}  // namespace hydrotin::app
