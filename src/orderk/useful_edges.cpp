#include "hydrotin/useful_edges.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

// Products of coordinates below this bound, and sums of two of them, are exact in double.
constexpr double kExactExtent = 1 << 25;
// Two exactly computed ratios that differ by more than this, relatively, are ordered as computed.
constexpr double kRatioError = 2e-15;

struct Vector {
  double x, y;
};

bool is_small(Vector p) {
  return std::max(std::fabs(p.x), std::fabs(p.y)) < kExactExtent;
}

// The cross product; exact if both are small, else the sign is.
double cross(Vector p, Vector q, bool small) {
  const double left = p.x * q.y, right = p.y * q.x;
  const double d = left - right;
  if (small || std::fabs(d) > 1e-15 * (std::fabs(left) + std::fabs(right))) return d;
  __extension__ using Wide = __int128;
  const auto wide = [](double v) { return static_cast<Wide>(v); };
  return static_cast<double>(wide(p.x) * wide(q.y) - wide(p.y) * wide(q.x));
}

// A point seen from u in the pencil of circles through u and s. The circle through u, s and p is
// x.(x - s) = ratio * (x cross s); right of us (positive cross product) a smaller ratio is hit earlier by circles that
// slide to the right, left of us later.
struct Hit {
  VertexId p;
  bool small;
  Vector at;  // relative to u
  double ratio;
};

double ratio(Vector p, Vector s, double p_cross_s) {
  return (p.x * (p.x - s.x) + p.y * (p.y - s.y)) / p_cross_s;
}

// Whether the order of two ratios is certain as computed; `gap` is their difference.
bool is_certain(const Hit& p, const Hit& q, double gap) {
  return p.small && q.small && std::fabs(gap) > kRatioError * (std::fabs(p.ratio) + std::fabs(q.ratio));
}

// The edge us and the points right of it inside the circle at which the pencil stands.
struct Pencil {
  VertexId s;
  int count = 0;
  std::array<VertexId, kMaxOrder + 1> inside;

  [[nodiscard]] bool has(VertexId p) const {
    for (int i = 0; i < count; ++i)
      if (inside[static_cast<std::size_t>(i)] == p) return true;
    return false;
  }
  void add(VertexId p) { inside[static_cast<std::size_t>(count++)] = p; }
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
  std::vector<Hit> frontier{};  // the first frontier_size are in use: no element is built anew
  std::size_t frontier_size = 0;
  std::vector<Hit> right{}, left{};
  UsefulEdges* edges = nullptr;
  std::vector<DecidingCircle>* beyond = nullptr;

  [[nodiscard]] Vector relative(VertexId p) const {
    const LatticePoint at = tri.position[p];
    return {static_cast<double>(at.x) - at_u.x, static_cast<double>(at.y) - at_u.y};
  }

  // Whether p is hit before q by circles through u and s that slide to the right; both lie right of us.
  [[nodiscard]] bool before(const Hit& p, const Hit& q, VertexId s) const {
    const double gap = p.ratio - q.ratio;
    if (is_certain(p, q, gap)) return gap < 0;
    return p.p != q.p && in_circle(tri.position[s], at_u, tri.position[q.p], tri.position[p.p]);
  }

  // Whether `p`, left of uv, lies inside the circle through u, v and `q`, right of uv.
  [[nodiscard]] bool inside_from_left(const Hit& p, const Hit& q, VertexId v) const {
    const double gap = p.ratio - q.ratio;
    if (is_certain(p, q, gap)) return gap > 0;
    return in_circle(tri.position[v], at_u, tri.position[q.p], tri.position[p.p]);
  }

  // A disc through u and s lies within a distance of its diameter from u.
  void certify(VertexId s, Vector at_s, double last_ratio, VertexId last) {
    const double diameter2 = (at_s.x * at_s.x + at_s.y * at_s.y) * (1 + last_ratio * last_ratio);
    if (!(diameter2 * (1 + 1e-9) < reach2)) beyond->push_back({u, s, last});
  }

  // The neighbours of c right of us that are not inside yet.
  void add_neighbors(VertexId c, const Pencil& pencil, Vector at_s, bool small_s) {
    const auto link = links.of(c);
    if (frontier.size() < frontier_size + link.size()) frontier.resize(2 * (frontier_size + link.size()));
    Hit* end = frontier.data() + frontier_size;
    for (const VertexId w : link) {
      const Vector at = relative(w);
      const bool small = small_s && is_small(at);
      const double d = cross(at, at_s, small);
      if (!(d > 0) || pencil.has(w)) continue;  // left of us, or on its line as u and s are
      *end++ = {w, small, at, ratio(at, at_s, d)};
    }
    frontier_size = static_cast<std::size_t>(end - frontier.data());
  }

  // Index of the frontier's point that is hit first: the smallest ratio, by predicate where rounding leaves doubt.
  [[nodiscard]] std::size_t first_hit(VertexId s) const {
    std::size_t smallest = 0;
    double least = frontier[0].ratio;
    bool all_small = frontier[0].small;
    for (std::size_t i = 1; i < frontier_size; ++i) {
      const bool less = frontier[i].ratio < least;
      smallest = less ? i : smallest;
      least = less ? frontier[i].ratio : least;
      all_small &= frontier[i].small;
    }
    // Nothing but ratios next to the least one can be in doubt.
    const double doubtful = least + 3 * kRatioError * std::fabs(least);
    std::size_t num_close = 0;
    for (std::size_t i = 0; i < frontier_size; ++i) num_close += frontier[i].ratio <= doubtful;
    if (all_small && num_close == 1) return smallest;
    std::size_t best = 0;
    for (std::size_t i = 1; i < frontier_size; ++i)
      if (before(frontier[i], frontier[best], s)) best = i;
    return best;
  }

  // Removes and returns the point hit next; `p` none if nothing lies right of us.
  Hit take_next(const Pencil& pencil) {
    while (frontier_size > 0) {
      const std::size_t best = first_hit(pencil.s);
      const Hit hit = frontier[best];
      frontier[best] = frontier[--frontier_size];
      if (!pencil.has(hit.p)) return hit;  // two points inside may have brought it
    }
    return {VertexId{}, true, {0, 0}, std::numeric_limits<double>::infinity()};
  }

  void slide(Pencil& pencil) {
    const Vector at_s = relative(pencil.s);
    const bool small_s = is_small(at_s);
    frontier_size = 0;
    Vector leftmost = relative(pencil.inside[0]);
    bool small_leftmost = is_small(leftmost);
    const auto is_left_of_all = [&](Vector at, bool small) { return cross(leftmost, at, small && small_leftmost) > 0; };
    for (int i = 0; i < pencil.count; ++i) {
      const VertexId p = pencil.inside[static_cast<std::size_t>(i)];
      add_neighbors(p, pencil, at_s, small_s);
      const Vector at = relative(p);
      if (i > 0 && is_left_of_all(at, is_small(at))) {
        leftmost = at;
        small_leftmost = is_small(at);
      }
    }
    for (;;) {
      const Hit hit = take_next(pencil);
      const bool at_end = hit.p.is_none() || pencil.count == k;
      if (at_end) certify(pencil.s, at_s, hit.ratio, hit.p);
      if (hit.p.is_none()) return;
      if (is_left_of_all(hit.at, is_small(hit.at))) {
        consider(hit, pencil);
        leftmost = hit.at;
        small_leftmost = is_small(hit.at);
      }
      if (at_end) return;
      pencil.add(hit.p);
      add_neighbors(hit.p, pencil, at_s, small_s);
    }
  }

  // Collects the points left of uv inside the circle through u, v and s2; false if there are more than k.
  bool collect_left(VertexId s1, const Hit& s2, VertexId v, Vector at_v, bool small_v) {
    left.clear();
    const auto hit_of = [&](VertexId w, Vector at, bool small, double d) {
      return Hit{w, small, at, ratio(at, at_v, d)};
    };
    const Vector at_s1 = relative(s1);
    const bool small_s1 = small_v && is_small(at_s1);
    left.push_back(hit_of(s1, at_s1, small_s1, cross(at_s1, at_v, small_s1)));
    for (std::size_t i = 0; i < left.size(); ++i)
      for (const VertexId w : links.of(left[i].p)) {
        const Vector at = relative(w);
        const bool small = small_v && is_small(at);
        const double d = cross(at, at_v, small);
        if (!(d < 0)) continue;
        const Hit hit = hit_of(w, at, small, d);
        if (!inside_from_left(hit, s2, v)) continue;
        if (std::any_of(left.begin(), left.end(), [&](const Hit& known) { return known.p == w; })) continue;
        if (left.size() == static_cast<std::size_t>(k)) return false;
        left.push_back(hit);
      }
    return true;
  }

  // Lemma 2.1 for the edge from u to the hit v, with s1 = the pencil's s and the points inside C(u, v, s1) known.
  void consider(const Hit& hit, const Pencil& pencil) {
    const VertexId v = hit.p;
    const bool small_v = is_small(hit.at);
    right.clear();
    for (int i = 0; i < pencil.count; ++i) {
      const VertexId q = pencil.inside[static_cast<std::size_t>(i)];
      const Vector at = relative(q);
      const bool small = small_v && is_small(at);
      right.push_back({q, small, at, ratio(at, hit.at, cross(at, hit.at, small))});
    }
    if (right.size() > 1)
      std::sort(right.begin(), right.end(), [&](const Hit& p, const Hit& q) { return before(p, q, v); });
    if (!collect_left(pencil.s, right.front(), v, hit.at, small_v)) return;
    certify(v, hit.at, right.front().ratio, right.front().p);
    if (at_u < tri.position[v]) emit(v);
    Pencil& child = stack.emplace_back();
    child.s = v;
    for (int i = 0; i < pencil.count; ++i) child.add(pencil.inside[static_cast<std::size_t>(i)]);
  }

  void emit(VertexId v) {
    if (left.size() > 1)
      std::sort(left.begin(), left.end(), [&](const Hit& p, const Hit& q) {
        const double gap = p.ratio - q.ratio;
        if (is_certain(p, q, gap)) return gap > 0;
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
    // No edge leaves the cone across the hull.
    if (tri.twin[across].is_none()) return;
    entry = across;
    Pencil pencil;
    pencil.s = s0;
    pencil.add(m0);
    slide(pencil);
    while (!stack.empty()) {
      pencil.s = stack.back().s;
      pencil.count = 0;
      for (int i = 0; i < stack.back().count; ++i) pencil.add(stack.back().inside[static_cast<std::size_t>(i)]);
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

void UsefulEdges::truncate(std::uint32_t size) {
  a.resize(size);
  b.resize(size);
  useful_order.resize(size);
  num_right.resize(size);
  entry.resize(size);
  content_begin.resize(size + 1);
  content.resize(content_begin.back());
}

void locate_entries(const TriangulationView& tri, const VertexLinks& links, UsefulEdges& edges) {
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const VertexId a = edges.a[e];
    const LatticePoint at_a = tri.position[a], at_b = tri.position[edges.b[e]];
    const std::uint32_t begin = links.begin[a.value], end = links.begin[a.value + 1];
    for (std::uint32_t i = begin; i < end; ++i) {
      const HalfedgeId spoke = links.spoke[i];
      if (spoke.is_none()) continue;
      const VertexId right = links.neighbor[i], left = links.neighbor[i + 1 == end ? begin : i + 1];
      if (orientation(at_a, tri.position[right], at_b) <= 0 || orientation(at_a, tri.position[left], at_b) >= 0)
        continue;
      edges.entry[e] = next(spoke);
      break;
    }
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
