#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"

/// The rings around a set of triangles: what a polygon layer needs.
///
/// Symbols  T = triangles, R = rings, b = vertices of all rings.
/// Properties
///   (1) No ring has a vertex twice; where the outline touches itself it is cut into two rings.
///   (2) Rings have the triangles on their left: outer ones run counter-clockwise, holes clockwise.
///   (3) The signed areas of the rings sum up to the area of the triangles.
///   (4) Each ring starts at its smallest vertex by (x, y); outer rings come first, then by that vertex: the result
///       does not depend on any numbering or order.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

struct OutlineRings {
  std::vector<std::uint32_t> begin{0};  ///< [R + 1]
  std::vector<std::uint32_t> vertex;    ///< [b] ring i: vertex[begin[i] .. begin[i + 1])
  std::uint32_t num_outer = 0;          ///< rings 0 .. num_outer - 1 are outer ones

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(begin.size() - 1); }
  [[nodiscard]] std::span<const std::uint32_t> ring(std::uint32_t i) const {
    return {vertex.data() + begin[i], vertex.data() + begin[i + 1]};
  }
};

/// @param triangle  [3T] counter-clockwise, without overlap.
/// @param position  of the vertices.
/// Complexity: O(T log T).
[[nodiscard]] OutlineRings outline_rings(std::span<const std::uint32_t> triangle,
                                         std::span<const LatticePoint> position);

}  // namespace hydrotin
