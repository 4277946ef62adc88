#include "hydrotin/useful_edges.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

// Products of coordinates below this bound are exact in double.
constexpr double kExactExtent = 1 << 25;
// Two exactly computed ratios that differ by more than this, relatively, are ordered as computed.
constexpr double kRatioError = 2e-15;

struct Vector {
  double x, y;
};

double cross(Vector p, Vector q) {
  return p.x * q.y - p.y * q.x;
}

bool is_small(Vector p) {
  return std::fabs(p.x) < kExactExtent && std::fabs(p.y) < kExactExtent;
}

// A point seen from u in the pencil of circles through u and s. The circle through u, s and p is
// x.(x - s) = ratio * (x cross s); right of us (positive cross product) a smaller ratio is hit earlier by circles that
// slide to the right, left of us later.
struct Hit {
  VertexId p;
  Vector at;  // relative to u
  double ratio;
};

// The edges through u and s, and the points right of us inside the circle at which the pencil stands.
struct Pencil {
  VertexId s;
  int count;
  std::array<VertexId, kMaxOrder + 1> inside;
};

}  // namespace

struct PencilGrowth::Impl {
  TriangulationView tri;
  const VertexLinks& links;
  int k;
  LatticeBox window;

  // State of the vertex being grown.
  VertexId u{};
  LatticePoint at_u{};
  double reach2 = 0;  // squared distance from u to the border of the window
  HalfedgeId entry{};
  std::vector<Pencil> stack{};
  std::vector<Hit> frontier{};
  std::vector<Hit> right{}, left{};
  UsefulEdges* edges = nullptr;
  std::vector<DecidingCircle>* beyond = nullptr;

  [[nodiscard]] Vector relative(VertexId p) const {
    const LatticePoint at = tri.position[p];
    return {static_cast<double>(at.x) - at_u.x, static_cast<double>(at.y) - at_u.y};
  }

  [[nodiscard]] static double ratio(Vector p, Vector s, double p_cross_s) {
    return (p.x * (p.x - s.x) + p.y * (p.y - s.y)) / p_cross_s;
  }

  // Whether p is hit before q by circles through u and s that slide to the right; both lie right of us.
  [[nodiscard]] bool before(const Hit& p, const Hit& q, VertexId s, bool small) const {
    const double gap = p.ratio - q.ratio;
    if (small && is_small(p.at) && is_small(q.at)) {
      const double error = kRatioError * (std::fabs(p.ratio) + std::fabs(q.ratio));
      if (gap < -error) return true;
      if (gap > error) return false;
    }
    if (p.p == q.p) return false;
    return in_circle(tri.position[s], at_u, tri.position[q.p], tri.position[p.p]);
  }

  // Whether `p`, left of uv, lies inside the circle through u, v and `q`, right of uv.
  [[nodiscard]] bool inside_from_left(const Hit& p, const Hit& q, VertexId v, bool small) const {
    if (small && is_small(p.at) && is_small(q.at)) {
      const double gap = p.ratio - q.ratio;
      const double error = kRatioError * (std::fabs(p.ratio) + std::fabs(q.ratio));
      if (gap > error) return true;
      if (gap < -error) return false;
    }
    return in_circle(tri.position[v], at_u, tri.position[q.p], tri.position[p.p]);
  }

  // A disc through u and s lies within a distance of its diameter from u.
  void certify(VertexId s, Vector at_s, const Hit& last) {
    const double diameter2 = (at_s.x * at_s.x + at_s.y * at_s.y) * (1 + last.ratio * last.ratio);
    if (!(diameter2 * (1 + 1e-9) < reach2)) beyond->push_back({u, s, last.p});
  }

  void add_neighbors(VertexId c, const Pencil& pencil, Vector at_s) {
    for (const VertexId w : links.of(c)) {
      const Vector at = relative(w);
      const double d = cross(at, at_s);
      if (!(d > 0)) continue;  // left of us, on its line (u and s among them)
      if (std::find(pencil.inside.begin(), pencil.inside.begin() + pencil.count, w) !=
          pencil.inside.begin() + pencil.count)
        continue;
      frontier.push_back({w, at, ratio(at, at_s, d)});
    }
  }

  // Removes and returns the point hit next; `p` none if nothing lies right of us.
  Hit take_next(const Pencil& pencil, bool small) {
    while (!frontier.empty()) {
      std::size_t best = 0;
      for (std::size_t i = 1; i < frontier.size(); ++i)
        if (before(frontier[i], frontier[best], pencil.s, small)) best = i;
      const Hit hit = frontier[best];
      frontier[best] = frontier.back();
      frontier.pop_back();
      const auto end = pencil.inside.begin() + pencil.count;
      if (std::find(pencil.inside.begin(), end, hit.p) == end) return hit;
    }
    return {VertexId{}, {0, 0}, std::numeric_limits<double>::infinity()};
  }

  void slide(Pencil pencil) {
    const Vector at_s = relative(pencil.s);
    const bool small = is_small(at_s);
    frontier.clear();
    Vector leftmost = relative(pencil.inside[0]);
    for (int i = 0; i < pencil.count; ++i) {
      add_neighbors(pencil.inside[static_cast<std::size_t>(i)], pencil, at_s);
      const Vector at = relative(pencil.inside[static_cast<std::size_t>(i)]);
      if (cross(leftmost, at) > 0) leftmost = at;
    }
    for (;;) {
      const Hit hit = take_next(pencil, small);
      const bool at_end = hit.p.is_none() || pencil.count == k;
      if (at_end) certify(pencil.s, at_s, hit);
      if (hit.p.is_none()) return;
      if (cross(leftmost, hit.at) > 0) {
        consider(hit, pencil);
        leftmost = hit.at;
      }
      if (at_end) return;
      pencil.inside[static_cast<std::size_t>(pencil.count++)] = hit.p;
      add_neighbors(hit.p, pencil, at_s);
    }
  }

  // Collects the points left of uv inside the circle through u, v and s2; false if there are more than k.
  bool collect_left(VertexId s1, const Hit& s2, VertexId v, Vector at_v, bool small) {
    left.clear();
    const auto hit_of = [&](VertexId w, Vector at, double d) { return Hit{w, at, ratio(at, at_v, d)}; };
    const Vector at_s1 = relative(s1);
    left.push_back(hit_of(s1, at_s1, cross(at_s1, at_v)));
    for (std::size_t i = 0; i < left.size(); ++i)
      for (const VertexId w : links.of(left[i].p)) {
        const Vector at = relative(w);
        const double d = cross(at, at_v);
        if (!(d < 0)) continue;
        const Hit hit = hit_of(w, at, d);
        if (!inside_from_left(hit, s2, v, small)) continue;
        if (std::any_of(left.begin(), left.end(), [&](const Hit& known) { return known.p == w; })) continue;
        if (left.size() == static_cast<std::size_t>(k)) return false;
        left.push_back(hit);
      }
    return true;
  }

  // Lemma 2.1 for the edge from u to the hit v, with s1 = the pencil's s and the points inside C(u, v, s1) known.
  void consider(const Hit& hit, const Pencil& pencil) {
    const VertexId v = hit.p;
    const bool small = is_small(hit.at);
    right.clear();
    for (int i = 0; i < pencil.count; ++i) {
      const VertexId q = pencil.inside[static_cast<std::size_t>(i)];
      const Vector at = relative(q);
      right.push_back({q, at, ratio(at, hit.at, cross(at, hit.at))});
    }
    std::sort(right.begin(), right.end(), [&](const Hit& p, const Hit& q) { return before(p, q, v, small); });
    if (!collect_left(pencil.s, right.front(), v, hit.at, small)) return;
    certify(v, hit.at, right.front());
    if (at_u < tri.position[v]) emit(v, small);
    stack.push_back(pencil);
    stack.back().s = v;
  }

  void emit(VertexId v, bool small) {
    std::sort(left.begin(), left.end(), [&](const Hit& p, const Hit& q) {
      const double gap = p.ratio - q.ratio;
      if (small && is_small(p.at) && is_small(q.at)) {
        const double error = kRatioError * (std::fabs(p.ratio) + std::fabs(q.ratio));
        if (gap > error) return true;
        if (gap < -error) return false;
      }
      return p.p != q.p && in_circle(at_u, tri.position[v], tri.position[q.p], tri.position[p.p]);
    });
    edges->a.push_back(u);
    edges->b.push_back(v);
    edges->useful_order.push_back(static_cast<std::uint8_t>(std::max(right.size(), left.size())));
    edges->num_right.push_back(static_cast<std::uint8_t>(right.size()));
    edges->entry.push_back(entry);
    for (const Hit& p : right) edges->content.push_back(p.p);
    for (const Hit& p : left) edges->content.push_back(p.p);
    edges->content_begin.push_back(static_cast<std::uint32_t>(edges->content.size()));
  }

  void grow_cone(VertexId m0, VertexId s0, HalfedgeId across) {
    const LatticePoint m = tri.position[m0], s = tri.position[s0];
    // A cone is narrower than a half turn: with both sides before u, so is everything in it.
    if (m < at_u && s < at_u) return;
    entry = across;
    Pencil first;
    first.s = s0;
    first.count = 1;
    first.inside[0] = m0;
    stack.push_back(first);
    while (!stack.empty()) {
      const Pencil pencil = stack.back();
      stack.pop_back();
      slide(pencil);
    }
  }
};

PencilGrowth::PencilGrowth(const TriangulationView& triangulation, const VertexLinks& links, int k,
                           const LatticeBox& window)
    : impl_(new Impl{triangulation, links, k, window}) {
  assert(k >= 1 && k <= kMaxOrder);
}

PencilGrowth::~PencilGrowth() {
  delete impl_;
}

void PencilGrowth::grow(VertexId u, UsefulEdges& edges, std::vector<DecidingCircle>& beyond) {
  Impl& self = *impl_;
  self.u = u;
  self.at_u = self.tri.position[u];
  self.edges = &edges;
  self.beyond = &beyond;
  const LatticePoint p = self.at_u;
  const std::int64_t reach = std::min({std::int64_t{p.x} - self.window.min.x, std::int64_t{self.window.max.x} - p.x,
                                       std::int64_t{p.y} - self.window.min.y, std::int64_t{self.window.max.y} - p.y});
  self.reach2 = reach < 0 ? 0 : static_cast<double>(reach) * static_cast<double>(reach);
  const std::uint32_t begin = self.links.begin[u.value], end = self.links.begin[u.value + 1];
  for (std::uint32_t i = begin; i < end; ++i) {
    const HalfedgeId spoke = self.links.spoke[i];
    if (spoke.is_none()) continue;  // the last neighbour of a hull vertex: no triangle follows
    const std::uint32_t following = i + 1 == end ? begin : i + 1;
    self.grow_cone(self.links.neighbor[i], self.links.neighbor[following], next(spoke));
  }
}

UsefulEdges useful_edges(const TriangulationView& triangulation, const VertexLinks& links, int k) {
  UsefulEdges edges;
  if (k == 0) return edges;
  constexpr std::int32_t kLow = std::numeric_limits<std::int32_t>::min(),
                         kHigh = std::numeric_limits<std::int32_t>::max();
  PencilGrowth growth(triangulation, links, k, LatticeBox{{kLow, kLow}, {kHigh, kHigh}});
  std::vector<DecidingCircle> beyond;
  for (VertexId u{0}; u.value < triangulation.num_vertices(); ++u.value) {
    growth.grow(u, edges, beyond);
    beyond.clear();
  }
  return edges;
}

}  // namespace hydrotin
