#pragma once

#include <cstdint>
#include <span>

#include "certify.h"
#include "hydrotin/reference_location.h"
#include "phases.h"
#include "polygon_figures.h"

/// The reference points that matter to one tile: its own, and those of other tiles in Delaunay triangles that it owns.
///
/// A reference point belongs to the tile in whose core it lies. It is counted there: whether it lies outside the hull
/// or at a vertex. Where it lies inside a triangle it is that triangle's owner who measures it.

namespace hydrotin {

struct TileReference {
  ReferenceLocation location;  ///< points in owned triangles, by Delaunay triangle; its counts are not filled
  std::uint64_t points = 0;    ///< of the tile
  std::uint64_t outside = 0, at_vertices = 0, beyond_limit = 0;  ///< of these
  TriangleError vertex_error;                                    ///< of those at vertices
};

/// @param height  [loaded vertices]  @param limit  may be null
/// Complexity: expected O(R log R + T), R = points of the tile and those read around it.
/// Fails: Error(storage) if an arranged tile contradicts the outline.
[[nodiscard]] TileReference read_tile_reference(const RunContext& context, std::uint32_t tile,
                                                const CertifiedTile& certified, std::span<const std::int32_t> height,
                                                const ErrorLimit* limit);

/// What a tile says of its reference points.
struct ReferenceFigures {
  std::uint64_t points = 0, outside = 0, at_vertices = 0, beyond_limit = 0;
  TriangleError vertex_error;

  void add(const ReferenceFigures& other);
  friend bool operator==(const ReferenceFigures&, const ReferenceFigures&) = default;
};

void write_reference_figures(store::Writer& out, const TileReference& reference);
[[nodiscard]] ReferenceFigures read_reference_figures(const store::Reader& in);

}  // namespace hydrotin
