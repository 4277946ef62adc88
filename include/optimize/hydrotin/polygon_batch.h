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

/// Copies one polygon at a time into local arrays.
class PolygonExtractor {
 public:
  explicit PolygonExtractor(const PolygonSource& source);

  /// The problem of polygon f; valid until the next call. `vertices()` maps its vertices back.
  const PolygonProblem& extract(std::uint32_t f);
  /// The last problem with more vertices that may be served (`wants_lower` 1); those it does not hold are passed over.
  const PolygonProblem& adopt(std::span<const VertexId> vertices);
  [[nodiscard]] std::span<const VertexId> vertices() const { return vertices_; }

 private:
  std::uint32_t local(VertexId v);
  void add_reference(std::uint32_t f);

  const PolygonSource& source_;
  PolygonProblem problem_;
  std::vector<std::uint32_t> local_of_;  // [n] scratch: local number + 1
  std::vector<VertexId> vertices_;
  std::vector<LatticePoint> position_;
  std::vector<std::int32_t> height_;
  std::vector<std::uint8_t> wants_lower_, fixed_, others_order_;
  std::vector<std::array<std::uint32_t, 3>> delaunay_, others_;
  std::vector<ReferencePoint> reference_;
  std::vector<std::uint32_t> base_degree_;
};

}  // namespace hydrotin
