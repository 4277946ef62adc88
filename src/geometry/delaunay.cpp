#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cassert>
#include <numeric>

#include "hydrotin/triangulation.h"

namespace hydrotin {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<std::uint32_t, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>>;

}  // namespace

struct DelaunayBuilder::Impl {
  Delaunay dt;
  std::vector<LatticePoint> position;
  std::vector<Delaunay::Vertex_handle> handle;  // [n]

  // Numbers the faces in the order of their smallest vertex: vertices come in curve order, so neighbours get near
  // numbers. Faces are visited as they lie in memory.
  std::uint32_t number_faces() {
    const auto smallest = [](const auto& face) {
      return std::min({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
    };
    std::vector<std::uint32_t> begin(handle.size() + 1);
    for (auto face = dt.finite_faces_begin(); face != dt.finite_faces_end(); ++face) ++begin[smallest(face) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    for (auto face = dt.finite_faces_begin(); face != dt.finite_faces_end(); ++face)
      face->info() = begin[smallest(face)]++;
    return begin.back();
  }
};

DelaunayBuilder::DelaunayBuilder() : impl_(std::make_unique<Impl>()) {}
DelaunayBuilder::~DelaunayBuilder() = default;
DelaunayBuilder::DelaunayBuilder(DelaunayBuilder&&) noexcept = default;
DelaunayBuilder& DelaunayBuilder::operator=(DelaunayBuilder&&) noexcept = default;

void DelaunayBuilder::insert(std::span<const LatticePoint> points) {
  auto& [dt, position, handle] = *impl_;
  position.insert(position.end(), points.begin(), points.end());
  handle.reserve(position.size());
  Delaunay::Face_handle hint = handle.empty() ? Delaunay::Face_handle{} : handle.back()->face();
  for (const LatticePoint p : points) {
    const auto vertex = dt.insert(Kernel::Point_2(p.x, p.y), hint);
    vertex->info() = static_cast<std::uint32_t>(handle.size());
    handle.push_back(vertex);
    hint = vertex->face();
  }
  assert(dt.number_of_vertices() == handle.size() && "points must be distinct");
}

Triangulation DelaunayBuilder::extract() {
  Triangulation out;
  out.position = impl_->position;
  if (impl_->dt.dimension() < 2) return out;
  const std::uint32_t num_triangles = impl_->number_faces();
  out.origin.resize(std::size_t{3} * num_triangles);
  out.twin.resize(std::size_t{3} * num_triangles);
  for (auto face = impl_->dt.finite_faces_begin(); face != impl_->dt.finite_faces_end(); ++face) {
    // Half-edge i runs from vertex i to vertex i + 1; it lies opposite vertex i + 2.
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t h = 3 * face->info() + static_cast<std::uint32_t>(i);
      out.origin[h] = VertexId{face->vertex(i)->info()};
      const auto across = face->neighbor(Delaunay::cw(i));
      if (impl_->dt.is_infinite(across)) continue;
      const int start = across->index(face->vertex(Delaunay::ccw(i)));
      out.twin[h] = HalfedgeId{3 * across->info() + static_cast<std::uint32_t>(start)};
    }
  }
  return out;
}

Triangulation delaunay(std::span<const LatticePoint> points) {
  DelaunayBuilder builder;
  builder.insert(points);
  return builder.extract();
}

}  // namespace hydrotin
