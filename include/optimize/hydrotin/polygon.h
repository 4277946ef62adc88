#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/objective.h"

/// The best order-k triangulation of one polygon of the fixed-edge subdivision.
///
/// Source   thesis, Theorems 3.1, 3.3 and 3.5: dynamic programming over directed useful edges, each solved once;
/// components
///          inside are first tied to the boundary in all the ways of Lemma 3.1 (with rightmost in place of topmost).
///          Over-long products of those ways fall back to changing one tie at a time, starting from the Delaunay ties.
/// Symbols  n = vertices of the polygon, T = its Delaunay triangles, C = its other order-k triangles.
/// Properties
///   (1) The answer depends on coordinates and heights only, never on the numbering of vertices or triangles: the
///       recursion starts at the smallest boundary edge, and equal values are decided first for more Delaunay edges,
///       then for the apex that comes first in (x, y).
///   (2) The answer is never worse than the Delaunay triangulation of the polygon.
///   (3) `optimal` is claimed only if the whole class was searched.
/// Complexity: O((T + C) ways) time, O(T + C) memory, ways = 1 without components. No recursion.
/// Threads  A solver is scratch memory: one per thread.

namespace hydrotin {

struct PolygonProblem {
  std::span<const LatticePoint> position;     ///< [n]
  std::span<const std::int32_t> height;       ///< [n] z lattice
  std::span<const std::uint8_t> wants_lower;  ///< [n] local-minima: this polygon is to give it a lower neighbour
  std::span<const std::array<std::uint32_t, 3>> delaunay;  ///< [T] counter-clockwise
  std::span<const std::uint8_t> fixed;                   ///< [T] bit i: the side from corner i to the next one is fixed
  std::span<const std::array<std::uint32_t, 3>> others;  ///< [C] counter-clockwise
  std::span<const std::uint8_t> others_order;            ///< [C] 1..k
  std::uint32_t components = 0;
};

struct PolygonResult {
  bool optimal = true;
  std::uint32_t ways = 1;       ///< dynamic programs run
  std::uint32_t max_order = 0;  ///< of the triangles of the answer
  std::uint32_t served = 0;     ///< local-minima: vertices that wanted a lower neighbour and got one
};

class PolygonSolver {
 public:
  /// @param max_ways  ways to tie components that are tried before falling back; fewer for polygons of more than 256
  ///                  triangles, so that no polygon costs more than 2^20 visits to a triangle
  explicit PolygonSolver(Objective objective, std::uint32_t max_ways = 4096);
  ~PolygonSolver();
  PolygonSolver(PolygonSolver&&) noexcept;
  PolygonSolver& operator=(PolygonSolver&&) noexcept;

  /// Appends the T triangles of the answer, counter-clockwise, to `triangles`.
  /// Preconditions: the Delaunay triangles form one polygon of the subdivision; `others` are all its order-k triangles
  /// with three useful edges.
  PolygonResult solve(const PolygonProblem& problem, std::vector<std::array<std::uint32_t, 3>>& triangles);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether vertex p is lower than q in the total order of local-minima: by (z, x, y).
[[nodiscard]] inline bool is_lower(std::int32_t zp, LatticePoint p, std::int32_t zq, LatticePoint q) {
  return zp != zq ? zp < zq : p < q;
}

}  // namespace hydrotin
