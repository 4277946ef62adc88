#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hydrotin/point_set.h"
#include "hydrotin/polygon_batch.h"
#include "hydrotin/reference_location.h"

/// The polygons of one point set while they are solved: problems, answers, and what is known of each.

namespace hydrotin {

/// Everything known about the triangulation before polygons are solved.
struct PointSetGround {
  PointSetGround(std::span<const LatticePoint> position, std::span<const std::int32_t> heights,
                 const PointSetOptions& options, const ReferenceSet& reference);

  Triangulation owner;
  TriangulationView tri;
  std::span<const std::int32_t> height;
  VertexLinks links;
  UsefulEdges edges;
  OrderKTriangles triangles;
  Crossings crossings;
  Subdivision subdivision;
  PolygonCandidates candidates;
  MinimaAssignment assignment;
  ReferenceLocation reference;
  std::vector<std::uint32_t> base_degree;
};

class PointSetPolygons {
 public:
  PointSetPolygons(const PointSetGround& ground, const PointSetOptions& options);

  void solve_all();

  [[nodiscard]] std::uint32_t size() const { return ground_.subdivision.size(); }
  /// The triangles of polygon f's answer, as vertices of the point set.
  [[nodiscard]] std::span<const std::array<std::uint32_t, 3>> answer(std::uint32_t f) const {
    return std::span(answer_).subspan(ground_.subdivision.begin[f], result_size(f));
  }
  [[nodiscard]] const PolygonResult& result(std::uint32_t f) const { return result_[f]; }
  [[nodiscard]] const std::vector<std::array<std::uint32_t, 3>>& answers() const { return answer_; }

  /// Vertices that their polygon left without a lower neighbour.
  [[nodiscard]] const std::vector<VertexId>& unserved() const { return unserved_; }
  /// Vertices of any polygon with an admissible edge down inside it; known under a limit on errors only.
  [[nodiscard]] const std::vector<VertexId>& servable() const { return servable_; }
  /// Solves f again with more vertices to serve, if those of its own do not suffer.
  void adopt(std::uint32_t f, std::span<const VertexId> vertices);
  /// What lies around a polygon: the vertices beyond its sides, or the degrees [n] without its own inner edges.
  struct Surroundings {
    std::span<const std::optional<SurfacePoint>> beyond{};
    std::span<const std::uint32_t> degree{};
  };
  /// Solves f again with what lies around it given. True if the answer changed.
  bool solve_within(std::uint32_t f, const Surroundings& surroundings);

 private:
  [[nodiscard]] std::uint32_t result_size(std::uint32_t f) const {
    return ground_.subdivision.begin[f + 1] - ground_.subdivision.begin[f];
  }
  void keep(std::uint32_t f, const PolygonResult& result);

  const PointSetGround& ground_;
  PolygonSource source_;
  PolygonExtractor extractor_;
  PolygonSolver solver_;
  std::vector<std::array<std::uint32_t, 3>> answer_, scratch_;
  std::vector<PolygonResult> result_;
  std::vector<VertexId> unserved_, servable_;
};

/// Offers vertices without a lower neighbour to the other polygons around them (FINDINGS A6).
void repair_minima(const PointSetGround& ground, PointSetPolygons& polygons);

/// Couples polygons whose objective looks across the edges between them; returns the bound over pairs across them:
/// the least score that the worst of them, or their sum, can have.
double couple_pairs(const PointSetGround& ground, const PointSetOptions& options, PointSetPolygons& polygons);

/// Solves polygons again with the degrees that the others leave, as long as something changes.
void couple_degrees(const PointSetGround& ground, PointSetPolygons& polygons);

}  // namespace hydrotin
