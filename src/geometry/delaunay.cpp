#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cassert>

#include "hydrotin/triangulation.h"

namespace hydrotin {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<std::uint32_t, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>>;

constexpr std::uint32_t kUnnumbered = static_cast<std::uint32_t>(-1);

}  // namespace

struct DelaunayBuilder::Impl {
  Delaunay dt;
  std::vector<LatticePoint> position;
  std::vector<Delaunay::Vertex_handle> handle;  // [n]

  // Faces in the order of their smallest vertex: vertices come in curve order, so neighbours get near numbers.
  std::vector<Delaunay::Face_handle> number_faces() {
    std::vector<Delaunay::Face_handle> faces;
    faces.reserve(dt.number_of_faces());
    for (auto face = dt.finite_faces_begin(); face != dt.finite_faces_end(); ++face) face->info() = kUnnumbered;
    for (std::uint32_t v = 0; v < handle.size(); ++v) {
      auto face = handle[v]->face();
      const auto first = face;
      do {
        const int i = face->index(handle[v]);
        const auto a = face->vertex(Delaunay::ccw(i)), b = face->vertex(Delaunay::cw(i));
        if (!dt.is_infinite(a) && !dt.is_infinite(b) && a->info() > v && b->info() > v) {
          face->info() = static_cast<std::uint32_t>(faces.size());
          faces.push_back(face);
        }
        face = face->neighbor(Delaunay::ccw(i));
      } while (face != first);
    }
    return faces;
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
  const auto faces = impl_->number_faces();
  assert(faces.size() == impl_->dt.number_of_faces());
  out.origin.resize(3 * faces.size());
  out.twin.resize(3 * faces.size());
  for (std::uint32_t t = 0; t < faces.size(); ++t) {
    const auto& face = faces[t];
    // Half-edge i runs from vertex i to vertex i + 1; it lies opposite vertex i + 2.
    for (int i = 0; i < 3; ++i) {
      const auto h = 3 * t + static_cast<std::uint32_t>(i);
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
