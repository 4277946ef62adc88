#include "reference_errors.h"

#include <algorithm>
#include <numeric>

#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

class Flood {
 public:
  Flood(const PolygonGraph& graph, const ErrorLimit* limit) : graph_(graph), limit_(limit) {
    const PolygonProblem& problem = graph.problem();
    if (!problem.rim.empty()) {
      sort_by_place();
      return;
    }
    begin_.assign(problem.delaunay.size() + 1, 0);
    for (const ReferencePoint& p : problem.reference) ++begin_[p.triangle + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    point_.resize(problem.reference.size());
    std::vector<std::uint32_t> at(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t i = 0; i < problem.reference.size(); ++i) point_[at[problem.reference[i].triangle]++] = i;
    seen_.assign(problem.delaunay.size(), 0);
  }

  TriangleError measure(std::uint32_t t) {
    const PolygonProblem& problem = graph_.problem();
    found_.clear();
    if (!problem.rim.empty()) {
      search(t);
    } else if (t < problem.delaunay.size()) {
      found_.insert(found_.end(), point_.begin() + begin_[t], point_.begin() + begin_[t + 1]);
    } else {
      flood(t);
    }
    return total(t);
  }

 private:
  [[nodiscard]] std::array<LatticePoint, 3> corners(std::uint32_t t) const {
    const auto& v = graph_.triangle(t);
    return {graph_.problem().position[v[0]], graph_.problem().position[v[1]], graph_.problem().position[v[2]]};
  }

  // In a simple polygon, which the Delaunay triangles need not cover, points are searched by x.
  void sort_by_place() {
    point_.resize(graph_.problem().reference.size());
    std::iota(point_.begin(), point_.end(), 0U);
    std::sort(point_.begin(), point_.end(), [&](std::uint32_t i, std::uint32_t j) { return place(i) < place(j); });
  }

  [[nodiscard]] LatticePoint place(std::uint32_t i) const { return graph_.problem().reference[i].position; }

  void search(std::uint32_t t) {
    const auto c = corners(t);
    LatticeBox box;
    for (const LatticePoint p : c) box.extend(p);
    const auto first = std::lower_bound(point_.begin(), point_.end(), box.min.x,
                                        [&](std::uint32_t i, std::int32_t x) { return place(i).x < x; });
    for (auto i = first; i != point_.end() && place(*i).x <= box.max.x; ++i)
      if (owns(c[0], c[1], c[2], place(*i), graph_.problem().reference[*i].on_rim)) found_.push_back(*i);
  }

  // Whether the insides meet: no side of either has the other triangle on its right.
  [[nodiscard]] bool overlap(std::uint32_t s, std::uint32_t t) const {
    const auto a = corners(s), b = corners(t);
    const auto separates = [](const auto& p, const auto& q) {
      for (std::size_t i = 0; i < 3; ++i) {
        const auto right = [&](LatticePoint c) { return orientation(p[i], p[(i + 1) % 3], c) <= 0; };
        if (right(q[0]) && right(q[1]) && right(q[2])) return true;
      }
      return false;
    };
    return !separates(a, b) && !separates(b, a);
  }

  [[nodiscard]] std::uint32_t delaunay_left_of(std::uint32_t e) const {
    for (std::uint32_t o = graph_.edge(e).first_option; o != kNoEdge; o = graph_.option(o).next)
      if (PolygonGraph::triangle_of(o) < graph_.problem().delaunay.size()) return PolygonGraph::triangle_of(o);
    return kNoEdge;
  }

  void visit(std::uint32_t d, std::uint32_t t) {
    if (seen_[d] == t + 1 || !overlap(d, t)) return;
    seen_[d] = t + 1;
    stack_.push_back(d);
  }

  void flood(std::uint32_t t) {
    const auto c = corners(t);
    start(t);
    while (!stack_.empty()) {
      const std::uint32_t d = stack_.back();
      stack_.pop_back();
      for (std::uint32_t i = begin_[d]; i < begin_[d + 1]; ++i) {
        const ReferencePoint& p = graph_.problem().reference[point_[i]];
        if (owns(c[0], c[1], c[2], p.position, p.on_rim)) found_.push_back(point_[i]);
      }
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t beyond = delaunay_left_of(PolygonGraph::twin(graph_.side(d, i)));
        if (beyond != kNoEdge) visit(beyond, t);
      }
    }
  }

  // No vertex lies inside t, so the Delaunay triangles that overlap it hang together across edges.
  void start(std::uint32_t t) {
    for (std::uint32_t d : delaunay_at(graph_.triangle(t)[0])) visit(d, t);
  }

  // Delaunay triangles of the polygon at a vertex.
  [[nodiscard]] std::span<const std::uint32_t> delaunay_at(std::uint32_t v) {
    if (at_begin_.empty()) {
      const auto& problem = graph_.problem();
      at_begin_.assign(problem.position.size() + 1, 0);
      for (const auto& d : problem.delaunay)
        for (const std::uint32_t u : d) ++at_begin_[u + 1];
      std::partial_sum(at_begin_.begin(), at_begin_.end(), at_begin_.begin());
      at_.resize(at_begin_.back());
      std::vector<std::uint32_t> next(at_begin_.begin(), at_begin_.end() - 1);
      for (std::uint32_t d = 0; d < problem.delaunay.size(); ++d)
        for (const std::uint32_t u : problem.delaunay[d]) at_[next[u]++] = d;
    }
    return std::span(at_).subspan(at_begin_[v], at_begin_[v + 1] - at_begin_[v]);
  }

  TriangleError total(std::uint32_t t) {
    const PolygonProblem& problem = graph_.problem();
    const auto& v = graph_.triangle(t);
    const auto corner = [&](std::size_t i) { return SurfacePoint{problem.position[v[i]], problem.height[v[i]]}; };
    TriangleError error;
    for (const std::uint32_t i : found_)
      error.add(vertical_distance(corner(0), corner(1), corner(2), problem.reference[i].position,
                                  problem.reference[i].height),
                limit_);
    return error;
  }

  const PolygonGraph& graph_;
  const ErrorLimit* limit_;
  std::vector<std::uint32_t> begin_, point_;  // reference points by Delaunay triangle
  std::vector<std::uint32_t> at_begin_, at_;  // Delaunay triangles by vertex
  std::vector<std::uint32_t> seen_, stack_, found_;
};

}  // namespace

std::vector<TriangleError> reference_errors(const PolygonGraph& graph, const ErrorLimit* limit) {
  std::vector<TriangleError> out(graph.num_triangles());
  if (graph.problem().reference.empty()) return out;
  Flood flood(graph, limit);
  for (std::uint32_t t = 0; t < graph.num_triangles(); ++t) out[t] = flood.measure(t);
  return out;
}

}  // namespace hydrotin
