#pragma once

#include <cstdint>
#include <vector>

#include "hydrotin/pencil_growth.h"
#include "neighborhood.h"

/// Delaunay triangulation and useful edges around one tile, certified: what is said of owned triangles is true of the
/// whole data set.
///
/// A tile owns the Delaunay triangles whose smallest vertex in (x, y) is one of its points. An edge of order k that
/// crosses an owned triangle starts within 2k - 1 Delaunay triangles of it. So it is enough that around owned
/// triangles, to that depth, (1) the discs of all triangles and (2) the deciding circles of all useful edges are
/// covered; whatever is not covered is fetched, and decided again.

namespace hydrotin {

struct CertifiedTile {
  Triangulation triangulation;  ///< of all loaded points; vertices 0 .. num_own are the tile's
  VertexLinks links;
  UsefulEdges edges;                ///< all that cross or bound owned triangles, and some around
  std::vector<std::uint8_t> owned;  ///< [T]
  std::uint32_t rounds = 0;
};

[[nodiscard]] CertifiedTile certify(Neighborhood& neighborhood, int k, const Executor& executor);

}  // namespace hydrotin
