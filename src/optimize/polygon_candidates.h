#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hydrotin/simple_polygon.h"

/// The triangles of order at most k that a simple polygon may be made of.

namespace hydrotin {

/// A simple polygon that was found sound: counter-clockwise, with all edges that must be there.
struct SoundPolygon {
  SimplePolygon given;
  std::vector<std::uint32_t> ring;                ///< [m] boundary vertices, counter-clockwise
  std::vector<std::array<std::uint32_t, 2>> rim;  ///< directed sides, then both directions of edges inside
  std::uint32_t components = 0;                   ///< of points and edges inside that hang nowhere
};

/// Throws Error (input) for a polygon that is not simple, with the rows to blame.
[[nodiscard]] SoundPolygon check_polygon(const SimplePolygon& polygon);

struct CandidateTriangles {
  std::vector<std::array<std::uint32_t, 3>> triangle;  ///< counter-clockwise, by order
  std::vector<std::uint32_t> order;                    ///< ascending
};

/// O(n p^2), p = points within k + 2 Delaunay edges of a point.
[[nodiscard]] CandidateTriangles candidate_triangles(const SoundPolygon& polygon, std::uint32_t k);

}  // namespace hydrotin
