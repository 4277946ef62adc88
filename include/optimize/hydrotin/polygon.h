#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/objective.h"
#include "hydrotin/vertical_error.h"

/// The best order-k triangulation of one polygon.
///
/// Source   thesis, Theorems 3.1 to 3.5: dynamic programming over directed edges, each solved once. Components inside
///          are tied to the boundary as in Lemma 3.1, but not in all combinations: a tie is chosen where a triangle
///          reaches the component, so that the ways of components add up instead of multiplying (quadrilaterals and
///          degrees need all combinations). Where one component has too many, a linear program over the triangles (the
///          triangles left and right of every edge are equally many) is solved, with its dual as certificate, and
///          branched on if it is not integral. Vertices that local-minima would count twice are branched on.
///          For local-minima alone flips are tried before it: if they serve every vertex, nothing can be better.
///          A bottleneck is the least threshold under which the objectives before it keep their values.
/// Symbols  n = vertices of the polygon, T = its Delaunay triangles, C = its other order-k triangles.
/// Properties
///   (1) The answer depends on coordinates and heights only, never on the numbering of vertices or triangles: the
///       recursion starts at the smallest boundary edge, and equal values are decided first for more Delaunay edges,
///       then for the apex that comes first in (x, y). (Where flips serve all, the first such answer is taken.)
///   (2) The answer is never worse than the Delaunay triangulation of the polygon, if that is admissible.
///   (3) `optimal` is claimed only if the whole class was searched, or a bound is met.
/// Complexity: O((T + C) ways) time, O(T + C) memory, ways = those of a component; a bottleneck adds a factor log C, a
/// quadrilateral the number of triangles on an edge, a degree its value. No recursion.
/// Threads  A solver is scratch memory: one per thread.

namespace hydrotin {

struct PolygonProblem {
  std::span<const LatticePoint> position;     ///< [n]
  std::span<const std::int32_t> height;       ///< [n] z lattice
  std::span<const std::uint8_t> wants_lower;  ///< [n] local-minima: 2: this polygon is to give it a lower neighbour; 1:
                                              ///< it may, if those of 2 do not suffer; 0: it need not
  std::span<const std::array<std::uint32_t, 3>> delaunay;  ///< [T] counter-clockwise
  std::span<const std::uint8_t> fixed;                   ///< [T] bit i: the side from corner i to the next one is fixed
  std::span<const std::array<std::uint32_t, 3>> others;  ///< [C] counter-clockwise
  std::span<const std::uint8_t> others_order;            ///< [C] 1..k
  std::uint32_t components = 0;
  std::span<const ReferencePoint> reference{};   ///< points owned by the Delaunay triangles
  std::span<const std::uint32_t> base_degree{};  ///< [n] min-max-degree: edges that are not inside this polygon
  /// Quadrilaterals: per fixed side (t, i), at 3 t + i, the vertex of the triangle beyond it, or none; may be empty.
  std::span<const std::optional<SurfacePoint>> beyond{};
  /// A simple polygon that is not a face of a subdivision: its directed sides, inside on the left, both directions of
  /// edges inside. Then `fixed` is not read, the Delaunay triangles need not cover it, and `num_triangles` is their
  /// number in any triangulation.
  std::span<const std::array<std::uint32_t, 2>> rim{};
  std::uint32_t num_triangles = 0;
};

/// What the components inside a polygon are searched with.
enum class ComponentMethod : std::uint8_t {
  automatic,       ///< ties if their ways are few, else the linear program
  ties,            ///< ties, however many ways (up to 65,535 a component)
  linear_program,  ///< also where nothing is loose
  flips            ///< no search: Delaunay improved by flips, everywhere
};

/// What one polygon may cost. Beyond it the Delaunay triangles are improved by flips, with a bound.
struct PolygonBudget {
  std::uint32_t max_triangles = 1U << 22;  ///< T + C of a polygon that is searched
  std::uint32_t max_ways = 64;             ///< ways to tie one component before the linear program takes over
  std::uint32_t max_program = 8'000;       ///< columns of a linear program
  std::uint32_t max_branches = 40;         ///< programs per polygon that the first one does not decide

  friend bool operator==(const PolygonBudget&, const PolygonBudget&) = default;
};

struct PolygonOptions {
  Objectives objectives{Objective::local_minima};
  std::optional<ErrorLimit> max_error{};  ///< triangles that exceed it are not admissible
  double z_per_xy = 1;                    ///< z lattice unit in x and y lattice units
  ComponentMethod method = ComponentMethod::automatic;
  PolygonBudget budget{};
};

/// A polygon beyond `max_triangles`, `max_program` or `max_branches` falls back to its Delaunay triangulation, improved
/// by flips. The answer of a polygon whose limit on errors cannot be kept has the least largest error instead.
struct PolygonResult {
  bool optimal = true;  ///< for the first objective
  bool fell_back = false;
  bool limit_missed = false;
  bool is_triangulated = true;  ///< false: a simple polygon without a triangulation of these triangles
  std::uint32_t programs = 0;   ///< dynamic and linear programs run
  std::uint32_t max_order = 0;  ///< of the triangles of the answer
  std::uint32_t served = 0;     ///< local-minima: vertices of 2 that got a lower neighbour
  TriangleError error{};        ///< of the reference points under the answer
  double gap = 0;               ///< first objective a sum: at most this much above the optimum
  double bound = 0;             ///< first objective a bottleneck: no answer has a smaller score
};

class PolygonSolver {
 public:
  /// Preconditions: objection_to(options.objectives) is nothing.
  explicit PolygonSolver(PolygonOptions options);
  ~PolygonSolver();
  PolygonSolver(PolygonSolver&&) noexcept;
  PolygonSolver& operator=(PolygonSolver&&) noexcept;

  /// Appends the triangles of the answer, counter-clockwise, to `triangles`.
  /// Preconditions: the Delaunay triangles form one polygon of the subdivision and `others` are all its order-k
  /// triangles with three useful edges; or `rim` is given.
  PolygonResult solve(const PolygonProblem& problem, std::vector<std::array<std::uint32_t, 3>>& triangles);

  /// Vertices of the last problem (local-minima) that wanted a lower neighbour and got none. Valid until `solve`.
  [[nodiscard]] std::span<const std::uint32_t> unserved() const;
  /// Vertices of the last problem with a lower neighbour over an inner edge that has an admissible triangle on both
  /// sides: local-minima under a limit on errors; else empty. Valid until `solve`.
  [[nodiscard]] std::span<const std::uint32_t> servable() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether vertex p is lower than q in the total order of local-minima: by (z, x, y).
[[nodiscard]] inline bool is_lower(std::int32_t zp, LatticePoint p, std::int32_t zq, LatticePoint q) {
  return zp != zq ? zp < zq : p < q;
}

}  // namespace hydrotin
