#include "hydrotin/polygon_batch.h"

#include <numeric>

namespace hydrotin {

PolygonCandidates candidates_by_polygon(const Subdivision& subdivision, const OrderKTriangles& triangles) {
  PolygonCandidates out;
  out.begin.resize(subdivision.size() + 1);
  const auto polygon = [&](std::uint32_t c) { return subdivision.polygon[triangle_of(triangles.entry[c]).value]; };
  for (std::uint32_t c = 0; c < triangles.size(); ++c) ++out.begin[polygon(c) + 1];
  std::partial_sum(out.begin.begin(), out.begin.end(), out.begin.begin());
  out.candidate.resize(triangles.size());
  std::vector<std::uint32_t> at(out.begin.begin(), out.begin.end() - 1);
  for (std::uint32_t c = 0; c < triangles.size(); ++c) out.candidate[at[polygon(c)]++] = c;
  return out;
}

PolygonExtractor::PolygonExtractor(const PolygonSource& source)
    : source_(source), local_of_(source.triangulation.num_vertices()) {}

std::uint32_t PolygonExtractor::local(VertexId v) {
  std::uint32_t& number = local_of_[v.value];
  if (number == 0) {
    vertices_.push_back(v);
    position_.push_back(source_.triangulation.position[v]);
    height_.push_back(source_.height[v.value]);
    number = static_cast<std::uint32_t>(vertices_.size());
  }
  return number - 1;
}

const PolygonProblem& PolygonExtractor::extract(std::uint32_t f) {
  const TriangulationView& tri = source_.triangulation;
  for (const VertexId v : vertices_) local_of_[v.value] = 0;
  vertices_.clear();
  position_.clear();
  height_.clear();
  fixed_.clear();
  delaunay_.clear();
  others_.clear();
  others_order_.clear();
  for (const TriangleId t : source_.subdivision.triangles_of(f)) {
    const HalfedgeId h = first_halfedge(t);
    delaunay_.push_back({local(tri.origin[h]), local(tri.target(h)), local(tri.apex(h))});
    std::uint8_t mask = 0;
    for (std::uint32_t i = 0; i < 3; ++i)
      if (!source_.crossings.crossed[h.value + i]) mask = static_cast<std::uint8_t>(mask | 1U << i);
    fixed_.push_back(mask);
  }
  for (std::uint32_t i = source_.candidates.begin[f]; i < source_.candidates.begin[f + 1]; ++i) {
    const auto& v = source_.triangles.vertices[source_.candidates.candidate[i]];
    others_.push_back({local(v[0]), local(v[1]), local(v[2])});
    others_order_.push_back(source_.triangles.order[source_.candidates.candidate[i]]);
  }
  wants_lower_.assign(vertices_.size(), 0);
  if (source_.assignment)
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      const TriangleId where = source_.assignment->where[vertices_[i].value];
      if (!where.is_none() && source_.subdivision.polygon[where.value] == f) wants_lower_[i] = 2;
    }
  problem_ = {position_, height_, wants_lower_,  delaunay_,
              fixed_,    others_, others_order_, source_.subdivision.components[f]};
  if (source_.reference) add_reference(f);
  if (!source_.base_degree.empty()) {
    base_degree_.clear();
    for (const VertexId v : vertices_) base_degree_.push_back(source_.base_degree[v.value]);
    problem_.base_degree = base_degree_;
  }
  return problem_;
}

void PolygonExtractor::add_reference(std::uint32_t f) {
  reference_.clear();
  const auto triangles = source_.subdivision.triangles_of(f);
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (ReferencePoint p : source_.reference->of(triangles[t].value)) {
      p.triangle = t;
      reference_.push_back(p);
    }
  problem_.reference = reference_;
}

const PolygonProblem& PolygonExtractor::adopt(std::span<const VertexId> vertices) {
  for (const VertexId v : vertices) {
    const std::uint32_t number = local_of_[v.value];
    if (number != 0 && wants_lower_[number - 1] == 0) wants_lower_[number - 1] = 1;
  }
  return problem_;
}

}  // namespace hydrotin
