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

// The boxes of the triangles near some places, in slices along the polygon's longer side by their lower ends, to find
// those at a place. Few triangles of a large polygon lie near a component's last vertex, and the others are passed over
// quickly: they touch no slice, across or along, that a place does.
class TriangleIndex {
 public:
  TriangleIndex(const PolygonProblem& problem, const PolygonGraph& graph, const std::vector<LatticeBox>& places) {
    LatticeBox all;
    for (const LatticePoint p : problem.position) all.extend(p);
    along_x_ = std::int64_t{all.max.x} - all.min.x >= std::int64_t{all.max.y} - all.min.y;
    low_ = at(all.min);
    std::vector<Member> near;
    for (const std::uint32_t t : triangles_near(problem, graph, all, places)) {
      near.push_back({{}, t});
      for (const std::uint32_t v : graph.triangle(t)) near.back().box.extend(problem.position[v]);
      longest_ = std::max(longest_, at(near.back().box.max) - at(near.back().box.min));
    }
    const auto num_slices = std::max<std::int64_t>(1, static_cast<std::int64_t>(near.size()) / 4);
    width_ = (at(all.max) - low_) / num_slices + 1;
    begin_.assign(static_cast<std::size_t>(num_slices) + 2, 0);
    for (const Member& member : near) ++begin_[slice_of(at(member.box.min)) + 2];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    member_.resize(near.size());
    for (const Member& member : near) member_[begin_[slice_of(at(member.box.min)) + 1]++] = member;
  }

  // Calls visit(t) for the triangles whose boxes meet a box inside one of the places.
  template <class Visit>
  void for_meeting(const LatticeBox& box, Visit visit) const {
    const std::size_t from = slice_of(std::max(at(box.min) - longest_, low_)), to = slice_of(at(box.max));
    for (std::uint32_t i = begin_[from]; i < begin_[to + 1]; ++i)
      if (member_[i].box.intersects(box)) visit(member_[i].triangle);
  }

 private:
  struct Member {
    LatticeBox box;
    std::uint32_t triangle;
  };

  static constexpr std::int64_t kMostParts = 1024;

  // One axis in equal parts, and of each the next one that a place touches.
  class Parts {
   public:
    Parts(std::int64_t low, std::int64_t high) : low_(low), shift_(0) {
      while ((high - low) >> shift_ >= kMostParts) ++shift_;
      next_.assign(static_cast<std::size_t>((high - low) >> shift_) + 1, 0);
    }
    [[nodiscard]] std::uint16_t part_of(std::int64_t place) const {
      return static_cast<std::uint16_t>((place - low_) >> shift_);
    }
    void touch(std::int64_t from, std::int64_t to) {
      for (std::size_t i = part_of(from); i <= part_of(to); ++i) next_[i] = 1;
    }
    void finish() {
      std::uint16_t next = kMostParts;
      for (std::size_t i = next_.size(); i-- > 0;) {
        if (next_[i] != 0) next = static_cast<std::uint16_t>(i);
        next_[i] = next;
      }
    }
    [[nodiscard]] bool is_touched(std::uint16_t from, std::uint16_t to) const { return next_[from] <= to; }

   private:
    std::int64_t low_;
    int shift_;
    std::vector<std::uint16_t> next_;
  };

  [[nodiscard]] static std::vector<std::uint32_t> triangles_near(const PolygonProblem& problem,
                                                                 const PolygonGraph& graph, const LatticeBox& all,
                                                                 const std::vector<LatticeBox>& places) {
    Parts x(all.min.x, all.max.x), y(all.min.y, all.max.y);
    for (const LatticeBox& place : places) {
      x.touch(place.min.x, place.max.x);
      y.touch(place.min.y, place.max.y);
    }
    x.finish();
    y.finish();
    std::vector<std::array<std::uint16_t, 2>> part;
    part.reserve(problem.position.size());
    std::vector<std::uint32_t> near;
    for (const LatticePoint p : problem.position) part.push_back({x.part_of(p.x), y.part_of(p.y)});
    for (std::uint32_t t = 0; t < graph.num_triangles(); ++t) {
      const auto& v = graph.triangle(t);
      const auto &a = part[v[0]], &b = part[v[1]], &c = part[v[2]];
      if (x.is_touched(std::min({a[0], b[0], c[0]}), std::max({a[0], b[0], c[0]})) &&
          y.is_touched(std::min({a[1], b[1], c[1]}), std::max({a[1], b[1], c[1]})))
        near.push_back(t);
    }
    return near;
  }

  [[nodiscard]] std::int64_t at(LatticePoint p) const { return along_x_ ? p.x : p.y; }
  [[nodiscard]] std::size_t slice_of(std::int64_t place) const {
    return static_cast<std::size_t>((place - low_) / width_);
  }

  std::vector<Member> member_;
  std::vector<std::uint32_t> begin_;  // of the members, by slice
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
std::vector<std::uint32_t> component_ends(const PolygonProblem& problem, const Sweep& sweep,
                                          std::vector<std::uint32_t>& component) {
  const auto n = static_cast<std::uint32_t>(problem.position.size());
  std::vector<std::uint32_t> root(n);
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const auto& [a, b] : problem.rim) root[find(a)] = find(b);
  if (problem.rim.empty())
    for (std::size_t t = 0; t < problem.delaunay.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i)
        if (problem.fixed[t] >> i & 1U) root[find(problem.delaunay[t][i])] = find(problem.delaunay[t][(i + 1) % 3]);
  const auto by_sweep = [&](std::uint32_t a, std::uint32_t b) {
    return sweep.is_before(problem.position[a], problem.position[b]);
  };
  std::vector<std::uint32_t> end(n, kNoEdge), ends;
  std::uint32_t first = 0;
  for (std::uint32_t v = 0; v < n; ++v) {
    std::uint32_t& last = end[find(v)];
    if (last == kNoEdge || by_sweep(last, v)) last = v;
    if (by_sweep(v, first)) first = v;
  }
  // The first vertex of a polygon lies on its outer boundary.
  for (std::uint32_t v = 0; v < n; ++v)
    if (end[v] != kNoEdge && v != find(first)) ends.push_back(end[v]);
  std::sort(ends.begin(), ends.end(), by_sweep);
  std::vector<std::uint32_t> number(n, kNoEdge);
  for (std::uint32_t c = 0; c < ends.size(); ++c) number[find(ends[c])] = c;
  component.resize(n);
  for (std::uint32_t v = 0; v < n; ++v) component[v] = number[find(v)];
  return ends;
}

// What lies around some vertices, as far as an edge reaches.
std::vector<LatticeBox> boxes_around(const PolygonProblem& problem, const PolygonGraph& graph,
                                     const std::vector<std::uint32_t>& vertices) {
  std::vector<LatticeBox> box(vertices.size());
  std::vector<std::uint32_t> number(problem.position.size(), kNoEdge);
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    number[vertices[i]] = i;
    box[i].extend(problem.position[vertices[i]]);
  }
  for (std::uint32_t e = 0; e < graph.num_edges(); ++e) {
    const std::uint32_t i = number[graph.edge(e).origin];
    if (i != kNoEdge) box[i].extend(problem.position[graph.edge(e).target]);
  }
  return box;
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
    const std::array<int, 3> side{orientation(a, b, p[0]), orientation(a, b, p[1]), orientation(a, b, p[2])};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      if (side[i] * side[j] < 0 && orientation(p[i], p[j], a) * orientation(p[i], p[j], b) < 0) return out.push_back(t);
    }
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
  const std::vector<std::uint32_t> ends = component_ends(problem, sweep, out.component);
  const TriangleIndex index(problem, graph, boxes_around(problem, graph, ends));
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
