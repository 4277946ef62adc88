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

  [[nodiscard]] double extent() const { return std::max(std::fabs(x), std::fabs(y)); }
};

// The cross product; exact for small vectors, else the sign is.
double cross(Vector p, Vector q) {
  const double left = p.x * q.y, right = p.y * q.x;
  const double d = left - right;
  // Below 2^52 the products are exact, or the right one is so large that it decides.
  if (std::fabs(left) < 0x1p52 || std::fabs(d) > 1e-15 * (std::fabs(left) + std::fabs(right))) return d;
  __extension__ using Wide = __int128;
  const auto wide = [](double v) { return static_cast<Wide>(v); };
  return static_cast<double>(wide(p.x) * wide(q.y) - wide(p.y) * wide(q.x));
}

// A point in the pencil of circles through u and s. With u as origin, the circle through u, s and p is
// x.(x - s) = ratio * (x cross s); right of us (positive cross product) a smaller ratio is hit earlier by circles that
// slide to the right, left of us later.
struct Hit {
  VertexId p;
  double ratio;
};

double ratio(Vector p, Vector s, double p_cross_s) {
  return (p.x * (p.x - s.x) + p.y * (p.y - s.y)) / p_cross_s;
}

// Whether the order of two ratios of small vectors is certain as computed; `gap` is their difference.
bool is_certain(const Hit& p, const Hit& q, double gap) {
  return std::fabs(gap) > kRatioError * (std::fabs(p.ratio) + std::fabs(q.ratio));
}

// Points in one pencil. Ratios decide as long as all vectors are small, predicates otherwise.
struct HitList {
  std::vector<Hit> hit;  // the first `size` are in use: no element is built anew
  std::size_t size = 0;
  double extent = 0;  // of all vectors that the ratios are made of

  void restart(Vector s) {
    size = 0;
    extent = s.extent();
  }
  void make_room(std::size_t more) {
    if (hit.size() < size + more) hit.resize(2 * (size + more));
  }
  void add(VertexId p, Vector at, double r) {
    extent = std::max(extent, at.extent());
    hit[size++] = {p, r};
  }
  [[nodiscard]] bool is_exact() const { return extent < kExactExtent; }
  [[nodiscard]] bool has(VertexId p) const {
    for (std::size_t i = 0; i < size; ++i)
      if (hit[i].p == p) return true;
    return false;
  }
};

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
  void copy(const Pencil& other) {
    s = other.s;
    count = other.count;
    std::copy_n(other.inside.begin(), count, inside.begin());
  }
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
  HitList frontier{}, right{}, left{};
  UsefulEdges* edges = nullptr;
  std::vector<DecidingCircle>* beyond = nullptr;

  [[nodiscard]] Vector relative(VertexId p) const {
    const LatticePoint at = tri.position[p];
    return {static_cast<double>(at.x) - at_u.x, static_cast<double>(at.y) - at_u.y};
  }

  // Whether p is hit before q by circles through u and s that slide to the right; both lie right of us.
  [[nodiscard]] bool before(const Hit& p, const Hit& q, VertexId s, bool exact) const {
    const double gap = p.ratio - q.ratio;
    if (exact && is_certain(p, q, gap)) return gap < 0;
    return p.p != q.p && in_circle(tri.position[s], at_u, tri.position[q.p], tri.position[p.p]);
  }

  // Whether `p`, left of uv, lies inside the circle through u, v and `q`, right of uv.
  [[nodiscard]] bool inside_from_left(const Hit& p, const Hit& q, VertexId v, bool exact) const {
    const double gap = p.ratio - q.ratio;
    if (exact && is_certain(p, q, gap)) return gap > 0;
    return in_circle(tri.position[v], at_u, tri.position[q.p], tri.position[p.p]);
  }

  // A disc through u and s lies within a distance of its diameter from u.
  void certify(VertexId s, Vector at_s, const Hit& last) {
    const double diameter2 = (at_s.x * at_s.x + at_s.y * at_s.y) * (1 + last.ratio * last.ratio);
    if (!(diameter2 * (1 + 1e-9) < reach2)) beyond->push_back({u, s, last.p});
  }

  // The neighbours of c right of us that are not inside yet.
  void add_neighbors(VertexId c, const Pencil& pencil, Vector at_s) {
    const auto link = links.of(c);
    frontier.make_room(link.size());
    for (const VertexId w : link) {
      const Vector at = relative(w);
      const double d = cross(at, at_s);
      if (!(d > 0) || pencil.has(w)) continue;  // left of us, or on its line as u and s are
      frontier.add(w, at, ratio(at, at_s, d));
    }
  }

  // Index of the frontier's point that is hit first: the smallest ratio, by predicate where rounding leaves doubt.
  [[nodiscard]] std::size_t first_hit(VertexId s) const {
    const Hit* hit = frontier.hit.data();
    const std::size_t size = frontier.size;
    std::size_t smallest = 0;
    double least = hit[0].ratio;
    for (std::size_t i = 1; i < size; ++i) {
      const bool less = hit[i].ratio < least;
      smallest = less ? i : smallest;
      least = less ? hit[i].ratio : least;
    }
    // Nothing but ratios next to the least one can be in doubt.
    const double doubtful = least + 3 * kRatioError * std::fabs(least);
    std::size_t num_close = 0;
    for (std::size_t i = 0; i < size; ++i) num_close += hit[i].ratio <= doubtful;
    const bool exact = frontier.is_exact();
    if (exact && num_close == 1) return smallest;
    std::size_t best = 0;
    for (std::size_t i = 1; i < size; ++i)
      if (before(hit[i], hit[best], s, exact)) best = i;
    return best;
  }

  // Removes and returns the point hit next; `p` none if nothing lies right of us.
  Hit take_next(const Pencil& pencil) {
    while (frontier.size > 0) {
      const std::size_t best = first_hit(pencil.s);
      const Hit hit = frontier.hit[best];
      frontier.hit[best] = frontier.hit[--frontier.size];
      if (!pencil.has(hit.p)) return hit;  // two points inside may have brought it
    }
    return {VertexId{}, std::numeric_limits<double>::infinity()};
  }

  void slide(Pencil& pencil) {
    const Vector at_s = relative(pencil.s);
    frontier.restart(at_s);
    Vector leftmost = relative(pencil.inside[0]);
    for (int i = 0; i < pencil.count; ++i) {
      const VertexId p = pencil.inside[static_cast<std::size_t>(i)];
      add_neighbors(p, pencil, at_s);
      const Vector at = relative(p);
      if (i > 0 && cross(leftmost, at) > 0) leftmost = at;
    }
    for (;;) {
      const Hit hit = take_next(pencil);
      const bool at_end = hit.p.is_none() || pencil.count == k;
      if (at_end) certify(pencil.s, at_s, hit);
      if (hit.p.is_none()) return;
      const Vector at = relative(hit.p);
      if (cross(leftmost, at) > 0) {
        consider(hit.p, at, pencil);
        leftmost = at;
      }
      if (at_end) return;
      pencil.add(hit.p);
      add_neighbors(hit.p, pencil, at_s);
    }
  }

  // Collects the points left of uv inside the circle through u, v and s2; false if there are more than k.
  bool collect_left(VertexId s1, const Hit& s2, VertexId v, Vector at_v) {
    left.restart({std::max(at_v.extent(), right.extent), 0});
    left.make_room(static_cast<std::size_t>(k) + 1);
    const Vector at_s1 = relative(s1);
    left.add(s1, at_s1, ratio(at_s1, at_v, cross(at_s1, at_v)));
    for (std::size_t i = 0; i < left.size; ++i)
      for (const VertexId w : links.of(left.hit[i].p)) {
        const Vector at = relative(w);
        const double d = cross(at, at_v);
        if (!(d < 0)) continue;
        const Hit hit{w, ratio(at, at_v, d)};
        if (!inside_from_left(hit, s2, v, left.is_exact() && at.extent() < kExactExtent) || left.has(w)) continue;
        if (left.size == static_cast<std::size_t>(k)) return false;
        left.add(w, at, hit.ratio);
      }
    return true;
  }

  // Lemma 2.1 for the edge from u to the hit v, with s1 = the pencil's s and the points inside C(u, v, s1) known.
  void consider(VertexId v, Vector at_v, const Pencil& pencil) {
    right.restart(at_v);
    right.make_room(static_cast<std::size_t>(pencil.count));
    for (int i = 0; i < pencil.count; ++i) {
      const VertexId q = pencil.inside[static_cast<std::size_t>(i)];
      const Vector at = relative(q);
      right.add(q, at, ratio(at, at_v, cross(at, at_v)));
    }
    if (right.size > 1)
      std::sort(right.hit.begin(), right.hit.begin() + static_cast<std::ptrdiff_t>(right.size),
                [&](const Hit& p, const Hit& q) { return before(p, q, v, right.is_exact()); });
    if (!collect_left(pencil.s, right.hit[0], v, at_v)) return;
    certify(v, at_v, right.hit[0]);
    if (at_u < tri.position[v]) emit(v);
    stack.emplace_back().copy(pencil);
    stack.back().s = v;
  }

  void emit(VertexId v) {
    if (left.size > 1)
      std::sort(left.hit.begin(), left.hit.begin() + static_cast<std::ptrdiff_t>(left.size),
                [&](const Hit& p, const Hit& q) {
                  const double gap = p.ratio - q.ratio;
                  if (left.is_exact() && is_certain(p, q, gap)) return gap > 0;
                  return p.p != q.p && in_circle(at_u, tri.position[v], tri.position[q.p], tri.position[p.p]);
                });
    edges->a.push_back(u);
    edges->b.push_back(v);
    edges->useful_order.push_back(static_cast<std::uint8_t>(std::max(right.size, left.size)));
    edges->num_right.push_back(static_cast<std::uint8_t>(right.size));
    edges->entry.push_back(entry);
    for (std::size_t i = 0; i < right.size; ++i) edges->content.push_back(right.hit[i].p);
    for (std::size_t i = 0; i < left.size; ++i) edges->content.push_back(left.hit[i].p);
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
      pencil.copy(stack.back());
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
