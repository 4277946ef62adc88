#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"

/// A terrain on the lattice, as the matching of river lines wants it: triangles with links across their edges.
///
/// Half-edge h of triangle h / 3 runs from triangle[h] to triangle[next_halfedge(h)] with its triangle on the left.
/// Any part of a terrain will do: it may have holes, several pieces, and vertices where pieces touch.
///
/// Source   the vertex ids and arrays of RiverTerrain, with exact positions. Symbols  n = vertices, T = triangles.
/// Threads  Views are safe to read concurrently.

namespace hydrotin {

inline constexpr std::uint32_t kNoHalfedge = 0xffffffffu;

[[nodiscard]] constexpr std::uint32_t next_halfedge(std::uint32_t h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
[[nodiscard]] constexpr std::uint32_t previous_halfedge(std::uint32_t h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}

struct LatticeTerrain {
  std::vector<LatticePoint> position;   ///< [n] distinct
  std::vector<double> height;           ///< [n]
  std::vector<std::uint32_t> triangle;  ///< [3T] counter-clockwise
  std::vector<std::uint32_t> twin;      ///< [3T] kNoHalfedge on the rim

  [[nodiscard]] std::uint32_t num_vertices() const { return static_cast<std::uint32_t>(position.size()); }
  [[nodiscard]] std::uint32_t origin(std::uint32_t h) const { return triangle[h]; }
  [[nodiscard]] std::uint32_t target(std::uint32_t h) const { return triangle[next_halfedge(h)]; }
  [[nodiscard]] std::uint32_t apex(std::uint32_t h) const { return triangle[previous_halfedge(h)]; }
};

/// Finds `twin`. Complexity: O(T log T).
/// Preconditions: triangles counter-clockwise on the lattice, no directed edge twice (`find_bad_triangle`).
void link_twins(LatticeTerrain& terrain);

/// The first triangle that is not counter-clockwise or has a directed edge that an earlier one has; T if there is none.
[[nodiscard]] std::uint32_t find_bad_triangle(std::span<const LatticePoint> position,
                                              std::span<const std::uint32_t> triangle);

/// Height of the terrain at p, which lies in triangle t or on its border: the same whichever of its vertices is first.
[[nodiscard]] double interpolate(const LatticeTerrain& terrain, std::uint32_t t, LatticePoint p);

}  // namespace hydrotin
