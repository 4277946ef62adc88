#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "hydrotin/polygon_batch.h"

/// Everything that order k says of a point set, made step by step as production does.

namespace hydrotin::testing {

struct OrderKScene {
  /// Precondition: points distinct; heights as many, or none.
  OrderKScene(std::vector<LatticePoint> given, int k, std::vector<std::int32_t> heights = {})
      : points(std::move(given)), height(std::move(heights)), owner(delaunay(points)) {
    links = vertex_links(tri());
    edges = useful_edges(tri(), links, k);
    crossings = find_crossings(tri(), edges);
    subdivision = subdivide(tri(), crossings.crossed);
    triangles = order_k_triangles(tri(), edges);
    candidates = candidates_by_polygon(subdivision, triangles);
    if (!height.empty()) assignment = assign_minima(tri(), links, edges, crossings, height);
  }
  [[nodiscard]] TriangulationView tri() const { return owner.view(); }

  std::vector<LatticePoint> points;
  std::vector<std::int32_t> height;
  Triangulation owner;
  VertexLinks links;
  UsefulEdges edges;
  Crossings crossings;
  Subdivision subdivision;
  OrderKTriangles triangles;
  PolygonCandidates candidates;
  MinimaAssignment assignment;  ///< with heights only
};

}  // namespace hydrotin::testing
