#include "hydrotin/hull_heuristic.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <vector>

#include "hydrotin/local_minima.h"
#include "hydrotin/order_k_triangles.h"
#include "hydrotin/predicates.h"
#include "hydrotin/subdivision.h"

namespace hydrotin {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

std::uint64_t key(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

// The hull of a useful edge ab: the triangles it crosses, and the vertices on both sides from a to b.
struct Hull {
  std::vector<TriangleId> triangle;
  std::vector<std::uint32_t> left, right;
  std::vector<std::uint64_t> crossed;  // edges
};

class HullHeuristic {
 public:
  HullHeuristic(std::span<const LatticePoint> position, std::span<const std::int32_t> height, int k)
      : owner_(delaunay(position)), tri_(owner_.view()), height_(height) {
    if (tri_.num_triangles() == 0) return;
    links_ = vertex_links(tri_);
    edges_ = useful_edges(tri_, links_, k);
    collect_orders();
    used_.assign(tri_.num_triangles(), 0);
    lower_.assign(tri_.num_vertices(), 0);
    for (HalfedgeId h{0}; h.value < tri_.origin.size(); ++h.value)
      if (tri_.twin[h].is_none() || h < tri_.twin[h]) count(tri_.origin[h].value, tri_.target(h).value, 1);
  }

  PointSetTriangulation run() {
    PointSetTriangulation out;
    if (tri_.num_triangles() == 0) return out;
    for (const std::uint32_t v : minima_upwards())
      for (const std::uint32_t e : edges_down(v))
        if (lower_[v] > 0 || insert(e)) break;
    for (TriangleId t{0}; t.value < tri_.num_triangles(); ++t.value)
      if (!used_[t.value]) out.triangles.push_back(corners(t));
    out.triangles.insert(out.triangles.end(), added_.begin(), added_.end());
    out.max_order = max_order_;
    out.values = {static_cast<double>(std::count(lower_.begin(), lower_.end(), 0U))};
    out.bound = bound();
    out.optimal = out.value() == out.bound;
    return out;
  }

 private:
  [[nodiscard]] LatticePoint at(std::uint32_t v) const { return tri_.position[VertexId{v}]; }
  [[nodiscard]] bool is_lower_vertex(std::uint32_t p, std::uint32_t q) const {
    return is_lower(height_[p], at(p), height_[q], at(q));
  }
  [[nodiscard]] Triangle corners(TriangleId t) const {
    const HalfedgeId h = first_halfedge(t);
    return {tri_.origin[h].value, tri_.target(h).value, tri_.apex(h).value};
  }

  void collect_orders() {
    const OrderKTriangles triangles = order_k_triangles(tri_, edges_);
    for (std::uint32_t c = 0; c < triangles.size(); ++c) {
      Triangle t{triangles.vertices[c][0].value, triangles.vertices[c][1].value, triangles.vertices[c][2].value};
      std::sort(t.begin(), t.end());
      order_.emplace(key(t[0], t[1]) * 0x9e3779b97f4a7c15ULL + t[2], std::pair{t, triangles.order[c]});
    }
  }

  // The order of a triangle, or nothing if it is not one of order k with useful edges.
  [[nodiscard]] std::optional<std::uint32_t> order_of(Triangle t) const {
    std::sort(t.begin(), t.end());
    const auto [first, last] = order_.equal_range(key(t[0], t[1]) * 0x9e3779b97f4a7c15ULL + t[2]);
    for (auto i = first; i != last; ++i)
      if (i->second.first == t) return i->second.second;
    return std::nullopt;
  }

  void count(std::uint32_t a, std::uint32_t b, int change) {
    std::uint32_t& lower = lower_[is_lower_vertex(a, b) ? b : a];
    lower = static_cast<std::uint32_t>(static_cast<int>(lower) + change);
  }

  [[nodiscard]] std::vector<std::uint32_t> minima_upwards() const {
    std::vector<std::uint32_t> minima;
    for (std::uint32_t v = 0; v < lower_.size(); ++v)
      if (lower_[v] == 0) minima.push_back(v);
    std::sort(minima.begin(), minima.end(), [&](std::uint32_t a, std::uint32_t b) { return is_lower_vertex(a, b); });
    return minima;
  }

  [[nodiscard]] std::vector<std::uint32_t> edges_down(std::uint32_t v) {
    if (edges_at_.empty()) {
      for (std::uint32_t e = 0; e < edges_.size(); ++e) {
        const std::uint32_t a = edges_.a(tri_, e).value, b = edges_.b[e].value;
        edges_at_.emplace(is_lower_vertex(a, b) ? b : a, e);
      }
    }
    std::vector<std::uint32_t> out;
    const auto [first, last] = edges_at_.equal_range(v);
    for (auto i = first; i != last; ++i) out.push_back(i->second);
    const auto other = [&](std::uint32_t e) {
      return at(edges_.a(tri_, e).value == v ? edges_.b[e].value : edges_.a(tri_, e).value);
    };
    std::sort(out.begin(), out.end(), [&](std::uint32_t e, std::uint32_t f) {
      return std::pair{edges_.useful_order(e), other(e)} < std::pair{edges_.useful_order(f), other(f)};
    });
    return out;
  }

  // Nothing if a triangle is taken.
  [[nodiscard]] std::optional<Hull> hull_of(std::uint32_t e) const {
    const std::uint32_t a = edges_.a(tri_, e).value, b = edges_.b[e].value;
    Hull hull;
    HalfedgeId h = edges_.entry[e];  // a on its left: it runs from the right side of ab to the left side
    hull.triangle.push_back(triangle_of(h));
    hull.right.push_back(tri_.origin[h].value);
    hull.left.push_back(tri_.target(h).value);
    for (;;) {
      hull.crossed.push_back(key(tri_.origin[h].value, tri_.target(h).value));
      const HalfedgeId beyond = tri_.twin[h];
      hull.triangle.push_back(triangle_of(beyond));
      const std::uint32_t apex = tri_.apex(beyond).value;
      if (apex == b) break;
      // beyond runs from left to right; its other sides are right -> apex and apex -> left.
      if (orientation(at(a), at(b), at(apex)) > 0) {
        hull.left.push_back(apex);
        h = next(beyond);
      } else {
        hull.right.push_back(apex);
        h = previous(beyond);
      }
    }
    for (const TriangleId t : hull.triangle)
      if (used_[t.value]) return std::nullopt;
    return hull;
  }

  // Delaunay triangles of the chain from a to b (on its left) over the given vertices; false if one is not allowed.
  bool fill_side(std::uint32_t a, std::uint32_t b, std::span<const std::uint32_t> chain, std::vector<Triangle>& out) {
    if (chain.empty()) return true;
    std::size_t apex = 0;
    for (std::size_t i = 1; i < chain.size(); ++i)
      if (chain[i] != chain[apex] && in_circle(at(a), at(b), at(chain[apex]), at(chain[i]))) apex = i;
    const Triangle t{a, b, chain[apex]};
    if (!order_of(t)) return false;
    out.push_back(t);
    return fill_side(a, chain[apex], chain.first(apex), out) && fill_side(chain[apex], b, chain.subspan(apex + 1), out);
  }

  bool insert(std::uint32_t e) {
    const auto hull = hull_of(e);
    if (!hull) return false;
    const std::uint32_t a = edges_.a(tri_, e).value, b = edges_.b[e].value;
    std::vector<Triangle> fresh;
    std::vector<std::uint32_t> back(hull->right.rbegin(), hull->right.rend());
    if (!fill_side(a, b, hull->left, fresh) || !fill_side(b, a, back, fresh)) return false;
    if (fresh.size() != hull->triangle.size() || !lowers_minima(*hull, fresh)) return false;
    for (const TriangleId t : hull->triangle) used_[t.value] = 1;
    for (const Triangle& t : fresh) max_order_ = std::max(max_order_, *order_of(t));
    added_.insert(added_.end(), fresh.begin(), fresh.end());
    return true;
  }

  // Edges inside the hull: each is a side of two of its triangles.
  [[nodiscard]] static std::vector<std::uint64_t> inner_edges(const std::vector<Triangle>& triangles) {
    std::vector<std::uint64_t> sides;
    for (const Triangle& t : triangles)
      for (std::size_t i = 0; i < 3; ++i) sides.push_back(key(t[i], t[(i + 1) % 3]));
    std::sort(sides.begin(), sides.end());
    std::vector<std::uint64_t> out;
    for (std::size_t i = 1; i < sides.size(); ++i)
      if (sides[i] == sides[i - 1]) out.push_back(sides[i]);
    return out;
  }

  bool lowers_minima(const Hull& hull, const std::vector<Triangle>& fresh) {
    std::vector<std::uint32_t> touched(hull.left);
    touched.insert(touched.end(), hull.right.begin(), hull.right.end());
    touched.push_back(fresh.front()[0]);
    touched.push_back(fresh.front()[1]);
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    const auto minima = [&] {
      return std::count_if(touched.begin(), touched.end(), [&](std::uint32_t v) { return lower_[v] == 0; });
    };
    const auto change = [&](const std::vector<std::uint64_t>& edges, int by) {
      for (const std::uint64_t e : edges) count(static_cast<std::uint32_t>(e >> 32), static_cast<std::uint32_t>(e), by);
    };
    const std::vector<std::uint64_t> added = inner_edges(fresh);
    const auto before = minima();
    change(hull.crossed, -1);
    change(added, 1);
    if (minima() < before) return true;
    change(added, -1);
    change(hull.crossed, 1);
    return false;
  }

  [[nodiscard]] double bound() const {
    const auto assignment = assign_minima(tri_, links_, edges_, find_crossings(tri_, edges_), height_);
    return static_cast<double>(std::count(assignment.fate.begin(), assignment.fate.end(), MinimumFate::always));
  }

  Triangulation owner_;
  TriangulationView tri_;
  std::span<const std::int32_t> height_;
  VertexLinks links_;
  UsefulEdges edges_;
  std::unordered_multimap<std::uint64_t, std::pair<Triangle, std::uint32_t>> order_;
  std::unordered_multimap<std::uint32_t, std::uint32_t> edges_at_;
  std::vector<std::uint8_t> used_;
  std::vector<std::uint32_t> lower_;  // lower neighbours, by vertex
  std::vector<Triangle> added_;
  std::uint32_t max_order_ = 0;
};

}  // namespace

PointSetTriangulation hull_heuristic(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                                     int k) {
  return HullHeuristic(position, height, k).run();
}

}  // namespace hydrotin
