#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/local_minima.h"
#include "hydrotin/order_k_triangles.h"
#include "hydrotin/polygon.h"
#include "hydrotin/reference_location.h"
#include "hydrotin/subdivision.h"

/// Cuts the polygons of a subdivision out as problems of their own, and writes the answers back.
///
/// Symbols  n = vertices, T = Delaunay triangles, F = polygons, C = other order-k triangles.
/// Threads  `solve` is safe to call concurrently with one solver and one output per thread.

namespace hydrotin {

/// The order-k triangles of each polygon (CSR): candidate[begin[f] .. begin[f + 1]) are numbers of `triangles`.
struct PolygonCandidates {
  std::vector<std::uint32_t> begin;      ///< [F + 1]
  std::vector<std::uint32_t> candidate;  ///< [C]
};

[[nodiscard]] PolygonCandidates candidates_by_polygon(const Subdivision& subdivision, const OrderKTriangles& triangles);

/// The useful edges of some polygons (CSR), as runs of edges with consecutive numbers: first[begin[f] .. begin[f + 1])
/// are the first edges of the runs of polygon f, ascending.
struct EdgesByPolygon {
  std::vector<std::uint32_t> begin;  ///< [F + 1]
  std::vector<std::uint32_t> first;  ///< [runs]

  /// Calls visit(edge) for all edges of polygon f, ascending.
  template <class Visit>
  void for_each(std::uint32_t f, const Subdivision& subdivision, const UsefulEdges& edges, Visit visit) const {
    for (std::uint32_t r = begin[f]; r < begin[f + 1]; ++r)
      for (std::uint32_t e = first[r]; e < edges.size() && polygon_of(e, subdivision, edges) == f; ++e) visit(e);
  }
  [[nodiscard]] static std::uint32_t polygon_of(std::uint32_t e, const Subdivision& subdivision,
                                                const UsefulEdges& edges) {
    return subdivision.polygon[triangle_of(edges.entry[e]).value];
  }
};

/// Those of the polygons with a 1 in `wanted` [F]. O(E + F).
[[nodiscard]] EdgesByPolygon edges_by_polygon(const Subdivision& subdivision, const UsefulEdges& edges,
                                              std::span<const std::uint8_t> wanted);

/// Everything known about a triangulation that its polygons need.
struct PolygonSource {
  TriangulationView triangulation;
  std::span<const std::int32_t> height;  ///< [n]
  const Crossings& crossings;
  const Subdivision& subdivision;
  const OrderKTriangles& triangles;
  const PolygonCandidates& candidates;
  const MinimaAssignment* assignment = nullptr;  ///< for local-minima only
  const ReferenceLocation* reference = nullptr;  ///< for vertical errors only
  std::span<const std::uint32_t> base_degree{};  ///< [n] for min-max-degree only
};

/// Which polygons have to be solved (1); of the others the Delaunay triangles are known to be the best answer (0),
/// because nothing else can be made of them or because, for local-minima, they serve all vertices that want it.
/// Polygons with components, and polygons that touch themselves, are only left out if nobody wants anything of them.
/// The order-k triangles of the others are never needed.
/// Complexity: O(n + T). Precondition: `assignment` is there for local-minima.
[[nodiscard]] std::vector<std::uint8_t> polygons_to_solve(const TriangulationView& triangulation,
                                                          const VertexLinks& links,
                                                          std::span<const std::int32_t> height,
                                                          const Crossings& crossings, const Subdivision& subdivision,
                                                          Objective objective, const MinimaAssignment* assignment,
                                                          const Executor& executor = serially);

/// Copies one polygon at a time into local arrays. Its scratch memory is that of the largest polygon so far.
class PolygonExtractor {
 public:
  explicit PolygonExtractor(const PolygonSource& source);

  /// The problem of polygon f; valid until the next call. `vertices()` maps its vertices back.
  const PolygonProblem& extract(std::uint32_t f);
  /// The last problem with more vertices that may be served (`wants_lower` 1); those it does not hold are passed over.
  const PolygonProblem& adopt(std::span<const VertexId> vertices);
  /// The same with order-k triangles given: `triangles` and `candidates` of the source are not looked at.
  const PolygonProblem& extract(std::uint32_t f, const OrderKTriangles& others);
  [[nodiscard]] std::span<const VertexId> vertices() const { return vertices_; }

 private:
  struct Numbered {
    VertexId vertex{};
    std::uint32_t local = 0;
  };
  [[nodiscard]] std::size_t slot_of(VertexId v) const;
  std::uint32_t local(VertexId v);
  std::uint32_t add_vertex(VertexId v);
  void add_reference(std::uint32_t f);
  void make_slots(std::size_t num_vertices);
  void extract_delaunay(std::uint32_t f);
  void add_other(const std::array<VertexId, 3>& triangle, std::uint8_t order);
  const PolygonProblem& finish(std::uint32_t f);

  const PolygonSource& source_;
  PolygonProblem problem_;
  std::vector<Numbered> slot_;             // open addressing
  std::array<Numbered, 2> edge_before_{};  // the first two corners of the triangle before
  std::vector<VertexId> vertices_;
  std::vector<LatticePoint> position_;
  std::vector<std::int32_t> height_;
  std::vector<std::uint8_t> wants_lower_, fixed_, others_order_;
  std::vector<std::array<std::uint32_t, 3>> delaunay_, others_;
  std::vector<ReferencePoint> reference_;
  std::vector<std::uint32_t> base_degree_;
};

/// What was found in a range of polygons.
struct BatchFigures {
  std::uint32_t max_order = 0;  ///< of the triangles of the answers
  std::uint32_t fallbacks = 0;  ///< polygons of which not the whole class was searched
};

/// Solves the polygons [begin, end). Those of polygon f go where its Delaunay triangles stand in the subdivision:
/// triangles[subdivision.begin[f] .. subdivision.begin[f + 1]), counter-clockwise, as vertices of the triangulation.
/// Ranges may be solved concurrently, each with its own extractor and solver: the result is the same for every way of
/// cutting.
/// @param to_solve   [F] of `polygons_to_solve`; the order-k triangles of the others need not be there
/// @param triangles  [T]
BatchFigures solve_polygons(const PolygonSource& source, std::span<const std::uint8_t> to_solve, std::uint32_t begin,
                            std::uint32_t end, PolygonExtractor& extractor, PolygonSolver& solver,
                            std::span<std::array<VertexId, 3>> triangles);

/// The same with the order-k triangles made where they are needed, one polygon at a time: no more than the edges has to
/// be kept for all polygons. `triangles` and `candidates` of the source are not looked at.
/// @param edges_of  at least the edges of the polygons to solve
BatchFigures solve_polygons(const PolygonSource& source, std::span<const std::uint8_t> to_solve,
                            const UsefulEdges& edges, const EdgesByPolygon& edges_of, std::uint32_t begin,
                            std::uint32_t end, PolygonExtractor& extractor, PolygonSolver& solver,
                            std::span<std::array<VertexId, 3>> triangles);

}  // namespace hydrotin
