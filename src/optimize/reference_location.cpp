#include "hydrotin/reference_location.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <optional>

#include "hydrotin/hilbert.h"
#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

class Walk {
 public:
  struct Place {
    TriangleId triangle;
    std::optional<VertexId> vertex;
    bool on_rim = false;
  };

  explicit Walk(const TriangulationView& tri) : tri_(tri) {}

  // Nothing if p lies outside the hull.
  std::optional<Place> locate(LatticePoint p) {
    for (;;) {
      std::optional<Place> end;
      bool inside = true, moved = false, outside = false;
      for (std::uint32_t i = 0; i < 3 && !moved; ++i) {
        const HalfedgeId h{first_halfedge(at_).value + i};
        const LatticePoint a = tri_.position[tri_.origin[h]], b = tri_.position[tri_.target(h)];
        const int side = orientation(a, b, p);
        if (side > 0 || (side == 0 && is_left_perturbed(a, b))) continue;
        inside = false;
        if (const HalfedgeId twin = tri_.twin[h]; !twin.is_none()) {
          at_ = triangle_of(twin);
          moved = true;
        } else if (side < 0) {
          outside = true;
        } else if (std::min(a, b) <= p && p <= std::max(a, b)) {
          end = Place{at_, std::nullopt, true};
        }
      }
      if (moved) continue;
      if (end || inside) return with_vertex(inside ? Place{at_, std::nullopt, false} : *end, p);
      assert(outside && "beyond a collinear side another one is passed");
      if (outside) return std::nullopt;
    }
  }

 private:
  // Whether a point on the line, moved by (e, e^2), lies left of the line from a to b.
  static bool is_left_perturbed(LatticePoint a, LatticePoint b) { return a.y != b.y ? a.y > b.y : a.x < b.x; }

  [[nodiscard]] Place with_vertex(Place place, LatticePoint p) const {
    for (std::uint32_t i = 0; i < 3; ++i) {
      const VertexId v = tri_.origin[HalfedgeId{first_halfedge(place.triangle).value + i}];
      if (tri_.position[v] == p) place.vertex = v;
    }
    return place;
  }

  const TriangulationView& tri_;
  TriangleId at_{0};
};

}  // namespace

ReferenceLocation locate_reference(const TriangulationView& tri, std::span<const std::int32_t> height,
                                   std::span<const LatticePoint> position,
                                   std::span<const std::int32_t> reference_height, const ErrorLimit* limit) {
  ReferenceLocation out;
  out.begin.assign(std::size_t{tri.num_triangles()} + 1, 0);
  if (tri.num_triangles() == 0) {
    out.outside = position.size();
    return out;
  }
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  for (std::uint32_t i = 0; i < position.size(); ++i) order.emplace_back(hilbert_key(position[i]), i);
  std::sort(order.begin(), order.end());
  std::vector<ReferencePoint> found;
  Walk walk(tri);
  for (const auto& [key, i] : order) {
    const auto place = walk.locate(position[i]);
    if (!place) {
      ++out.outside;
    } else if (place->vertex) {
      ++out.at_vertices;
      const VerticalDistance distance{std::int64_t{reference_height[i]} - height[place->vertex->value], 1};
      out.vertex_error.add(distance, limit);
      if (limit != nullptr && !limit->allows(distance)) ++out.beyond_limit;
    } else {
      found.push_back({position[i], reference_height[i], place->triangle.value, place->on_rim});
      ++out.begin[place->triangle.value + 1];
    }
  }
  std::partial_sum(out.begin.begin(), out.begin.end(), out.begin.begin());
  out.point.resize(found.size());
  std::vector<std::uint32_t> next(out.begin.begin(), out.begin.end() - 1);
  for (const ReferencePoint& p : found) out.point[next[p.triangle]++] = p;
  return out;
}

}  // namespace hydrotin
