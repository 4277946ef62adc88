#include "component_ties.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

// The boxes of all triangles in slices along the polygon's longer side, by their lower ends, to find those at a place.
class TriangleIndex {
 public:
  TriangleIndex(const PolygonProblem& problem, const PolygonGraph& graph) : box_(graph.num_triangles()) {
    LatticeBox all;
    for (const LatticePoint p : problem.position) all.extend(p);
    along_x_ = std::int64_t{all.max.x} - all.min.x >= std::int64_t{all.max.y} - all.min.y;
    low_ = at(all.min);
    const std::int64_t num_slices = std::max<std::int64_t>(1, graph.num_triangles() / 4);
    width_ = (at(all.max) - low_) / num_slices + 1;
    begin_.assign(static_cast<std::size_t>(num_slices) + 2, 0);
    for (std::uint32_t t = 0; t < graph.num_triangles(); ++t) {
      for (const std::uint32_t v : graph.triangle(t)) box_[t].extend(problem.position[v]);
      longest_ = std::max(longest_, at(box_[t].max) - at(box_[t].min));
      ++begin_[slice_of(at(box_[t].min)) + 2];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    triangle_.resize(box_.size());
    for (std::uint32_t t = 0; t < graph.num_triangles(); ++t) triangle_[begin_[slice_of(at(box_[t].min)) + 1]++] = t;
  }

  // Calls visit(t) for the triangles whose boxes meet a box.
  template <class Visit>
  void for_meeting(const LatticeBox& box, Visit visit) const {
    const std::size_t from = slice_of(std::max(at(box.min) - longest_, low_)), to = slice_of(at(box.max));
    for (std::uint32_t i = begin_[from]; i < begin_[to + 1]; ++i)
      if (box_[triangle_[i]].intersects(box)) visit(triangle_[i]);
  }

 private:
  [[nodiscard]] std::int64_t at(LatticePoint p) const { return along_x_ ? p.x : p.y; }
  [[nodiscard]] std::size_t slice_of(std::int64_t place) const {
    return static_cast<std::size_t>((place - low_) / width_);
  }

  std::vector<LatticeBox> box_;
  std::vector<std::uint32_t> begin_, triangle_;  // CSR by slice
  std::int64_t low_ = 0, width_ = 1, longest_ = 0;
  bool along_x_ = true;
};

// The order of points along a direction, then across it. Long polygons are swept across, so that ties soon lead to the
// boundary.
class Sweep {
 public:
  explicit Sweep(const PolygonProblem& problem) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& direction : kDirections) {
      std::int64_t low = std::numeric_limits<std::int64_t>::max(), high = std::numeric_limits<std::int64_t>::min();
      for (const LatticePoint p : problem.position) {
        low = std::min(low, along(direction, p));
        high = std::max(high, along(direction, p));
      }
      const double width = static_cast<double>(high - low) /
                           std::hypot(static_cast<double>(direction[0]), static_cast<double>(direction[1]));
      if (width >= least) continue;
      least = width;
      direction_ = direction;
    }
  }

  [[nodiscard]] bool is_before(LatticePoint p, LatticePoint q) const { return key(p) < key(q); }

 private:
  using Direction = std::array<std::int64_t, 2>;
  static constexpr std::array<Direction, 8> kDirections{
      {{1, 0}, {12, 5}, {1, 1}, {5, 12}, {0, 1}, {-5, 12}, {-1, 1}, {-12, 5}}};

  [[nodiscard]] static std::int64_t along(const Direction& d, LatticePoint p) { return d[0] * p.x + d[1] * p.y; }
  [[nodiscard]] std::pair<std::int64_t, std::int64_t> key(LatticePoint p) const {
    return {along(direction_, p), along({-direction_[1], direction_[0]}, p)};
  }

  Direction direction_ = kDirections[0];
};

LatticeBox box_of(LatticePoint a, LatticePoint b) {
  LatticeBox box;
  box.extend(a);
  box.extend(b);
  return box;
}

// Last vertices of the components that do not hang on the outer boundary, in the order of the sweep; and the component
// of each vertex.
std::vector<std::uint32_t> component_ends(const PolygonProblem& problem, const PolygonGraph& graph, const Sweep& sweep,
                                          std::vector<std::uint32_t>& component) {
  const auto n = static_cast<std::uint32_t>(problem.position.size());
  std::vector<std::uint32_t> root(n);
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (std::uint32_t e = 0; e < graph.num_edges(); ++e)
    if (graph.edge(e).is_boundary) root[find(graph.edge(e).origin)] = find(graph.edge(e).target);
  const auto by_sweep = [&](std::uint32_t a, std::uint32_t b) {
    return sweep.is_before(problem.position[a], problem.position[b]);
  };
  std::vector<std::uint32_t> order(n), end(n, kNoEdge), ends;
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), by_sweep);
  for (const std::uint32_t v : order) end[find(v)] = v;
  // The first vertex of a polygon lies on its outer boundary.
  for (std::uint32_t v = 0; v < n; ++v)
    if (end[v] != kNoEdge && v != find(order.front())) ends.push_back(end[v]);
  std::sort(ends.begin(), ends.end(), by_sweep);
  std::vector<std::uint32_t> number(n, kNoEdge);
  for (std::uint32_t c = 0; c < ends.size(); ++c) number[find(ends[c])] = c;
  component.resize(n);
  for (std::uint32_t v = 0; v < n; ++v) component[v] = number[find(v)];
  return ends;
}

// Finds the ties of a component's last vertex.
class TieFinder {
 public:
  TieFinder(const PolygonProblem& problem, const PolygonGraph& graph, const Sweep& sweep, const TriangleIndex& index,
            const std::vector<std::uint32_t>& component)
      : problem_(problem), graph_(graph), sweep_(sweep), index_(index), component_(component) {}

  // Their ends, the first first.
  [[nodiscard]] std::vector<std::uint32_t> ends(std::uint32_t u) const {
    const std::uint32_t first = problem_.rim.empty() ? first_end(u) : kNoEdge;
    std::vector<std::uint32_t> out;
    for_triangles_at(u, first == kNoEdge ? u : first, [&](std::uint32_t, std::uint32_t x, std::uint32_t y) {
      if (first == kNoEdge) {
        for (const std::uint32_t w : {x, y})
          if (is_beyond(u, w)) out.push_back(w);
      } else if (properly_cross(at(u), at(first), at(x), at(y))) {
        out.push_back(!is_beyond(u, y) || (is_beyond(u, x) && is_better(x, y)) ? x : y);
      }
    });
    std::sort(out.begin(), out.end(), [&](std::uint32_t a, std::uint32_t b) { return at(a) < at(b); });
    out.erase(std::unique(out.begin(), out.end()), out.end());
    if (first != kNoEdge) {
      std::erase(out, first);
      out.insert(out.begin(), first);
    }
    return out;
  }

 private:
  [[nodiscard]] LatticePoint at(std::uint32_t v) const { return problem_.position[v]; }
  [[nodiscard]] bool is_beyond(std::uint32_t u, std::uint32_t v) const { return sweep_.is_before(at(u), at(v)); }
  // Ends on the outer boundary make short chains.
  [[nodiscard]] bool is_better(std::uint32_t v, std::uint32_t w) const {
    const bool v_outer = component_[v] == kNoEdge, w_outer = component_[w] == kNoEdge;
    return v_outer != w_outer ? v_outer : sweep_.is_before(at(v), at(w));
  }

  // Calls visit(t, x, y) for the triangles with a corner at u and the others at x and y, near the segment uw.
  template <class Visit>
  void for_triangles_at(std::uint32_t u, std::uint32_t w, Visit visit) const {
    index_.for_meeting(box_of(at(u), at(w)), [&](std::uint32_t t) {
      const auto& v = graph_.triangle(t);
      for (std::size_t i = 0; i < 3; ++i)
        if (v[i] == u) visit(t, v[(i + 1) % 3], v[(i + 2) % 3]);
    });
  }

  // The best vertex beyond u that a Delaunay edge joins to it.
  [[nodiscard]] std::uint32_t first_end(std::uint32_t u) const {
    std::uint32_t best = kNoEdge;
    for_triangles_at(u, u, [&](std::uint32_t t, std::uint32_t x, std::uint32_t y) {
      if (t >= problem_.delaunay.size()) return;
      for (const std::uint32_t v : {x, y})
        if (is_beyond(u, v) && (best == kNoEdge || is_better(v, best))) best = v;
    });
    assert(best != kNoEdge && "the region beyond a component belongs to the polygon");
    return best;
  }

  const PolygonProblem& problem_;
  const PolygonGraph& graph_;
  const Sweep& sweep_;
  const TriangleIndex& index_;
  const std::vector<std::uint32_t>& component_;
};

// Triangles that the segment ab properly cuts.
void add_blocked(const PolygonProblem& problem, const PolygonGraph& graph, const TriangleIndex& index, LatticePoint a,
                 LatticePoint b, std::vector<std::uint32_t>& out) {
  index.for_meeting(box_of(a, b), [&](std::uint32_t t) {
    const auto& v = graph.triangle(t);
    const std::array<LatticePoint, 3> p{problem.position[v[0]], problem.position[v[1]], problem.position[v[2]]};
    if (properly_cross(a, b, p[0], p[1]) || properly_cross(a, b, p[1], p[2]) || properly_cross(a, b, p[2], p[0]))
      out.push_back(t);
  });
}

}  // namespace

std::uint64_t ComponentTies::num_ways(std::uint64_t most) const {
  std::uint64_t ways = 1;
  for (std::uint32_t c = 0; c < num_components(); ++c) {
    ways *= num_ties(c);
    if (ways > most) return most + 1;
  }
  return ways;
}

ComponentTies find_component_ties(const PolygonProblem& problem, const PolygonGraph& graph) {
  ComponentTies out;
  const Sweep sweep(problem);
  const std::vector<std::uint32_t> ends = component_ends(problem, graph, sweep, out.component);
  const TriangleIndex index(problem, graph);
  const TieFinder finder(problem, graph, sweep, index, out.component);
  for (const std::uint32_t u : ends) {
    for (const std::uint32_t w : finder.ends(u)) {
      const std::uint32_t tie = graph.find(u, w);
      out.tie.push_back({tie, PolygonGraph::twin(tie)});
      add_blocked(problem, graph, index, problem.position[u], problem.position[w], out.blocked);
      out.blocked_begin.push_back(static_cast<std::uint32_t>(out.blocked.size()));
    }
    out.begin.push_back(static_cast<std::uint32_t>(out.tie.size()));
  }
  return out;
}

}  // namespace hydrotin
