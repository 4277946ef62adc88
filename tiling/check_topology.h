#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "check_tile.h"

/// Checks across the files of a data set.
///
/// All triangles are counter-clockwise, every edge has two triangles on opposite sides or lies once on the hull, the
/// hull is one convex chain, and the areas sum up to its area: then the triangles cover the hull exactly once.

namespace hydrotin {

/// Edges that meet across files, and the hull: one closed convex chain of what is left, of the area of the triangles.
/// Complexity: O(E log E), E = open edges of all files.
void check_edges(const DatasetIndex& index, std::span<const TileFacts> facts, Problems& problems);

/// Whether foreign vertices are what their owners say, and every point of the owner is used by some file.
/// @param claims  of all files about points of `owner`, sorted by point.
void check_owner(const DatasetIndex& index, std::uint32_t owner, std::span<const ForeignVertex> claims,
                 Problems& problems);

/// The foreign vertices of all files, by point.
[[nodiscard]] std::vector<ForeignVertex> sorted_claims(std::span<const TileFacts> facts);

/// Counts and fingerprint of the index against the files.
void check_sums(const DatasetIndex& index, std::span<const TileFacts> facts, Problems& problems);

/// Vertices that rivers added: each is used, and all files agree about it.
/// @param claims  those of tile number num_tiles, ascending
void check_new_vertices(const DatasetIndex& index, std::span<const ForeignVertex> claims, Problems& problems);

/// River edges of all files together. An edge may be invalid only where the index knows of a contradiction.
void check_rivers(const DatasetIndex& index, std::span<const TileFacts> facts, std::uint64_t& num_edges,
                  std::uint64_t& num_invalid, Problems& problems);

}  // namespace hydrotin
