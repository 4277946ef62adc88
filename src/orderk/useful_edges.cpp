#include "hydrotin/useful_edges.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "hydrotin/predicates.h"
#include "pencil.h"

namespace hydrotin {
namespace {

// Ratios closer than this to a given one, relatively, may be on either side of it.
constexpr double kDoubt = 3 * kRatioError;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The edge us and the points right of it inside the circle at which the pencil stands.
struct Pencil {
  VertexId s;
  std::uint32_t count;
  std::array<VertexId, kMaxOrder + 1> inside;

  void add(VertexId p) { inside[count++] = p; }
  void copy(const Pencil& other) {
    s = other.s;
    count = other.count;
    for (std::uint32_t i = 0; i < count; ++i) inside[i] = other.inside[i];
  }
};

}  // namespace

struct PencilGrowth::Impl {
  Impl(const TriangulationView& triangulation, const VertexLinks& vertex_links, int order, const LatticeBox& known)
      : tri(triangulation),
        links(vertex_links),
        k(static_cast<std::uint32_t>(order)),
        window(known),
        frontier(triangulation.num_vertices()) {
    LatticeBox box;
    for (const LatticePoint p : tri.position.raw()) box.extend(p);
    is_small = !box.is_empty() && static_cast<double>(box.max.x) - box.min.x < kExactExtent &&
               static_cast<double>(box.max.y) - box.min.y < kExactExtent;
    stack.resize(16);
  }

  TriangulationView tri;
  const VertexLinks& links;
  std::uint32_t k;
  LatticeBox window;
  bool is_small = false;  // all vectors between vertices are: their extents need not be watched

  // State of the vertex being grown.
  VertexId u{};
  LatticePoint at_u{};
  Vector origin{};    // of all vectors: u
  double reach2 = 0;  // squared distance from u to the border of the window
  HalfedgeId entry{};
  std::vector<Pencil> stack{};
  std::size_t stack_size = 0;
  Pencil pencil{};  // the one that slides
  Frontier frontier;
  double frontier_extent = 0;  // of all vectors that the pencil's ratios are made of
  HitList right{}, left{};
  UsefulEdges* edges = nullptr;
  std::vector<DecidingCircle>* beyond = nullptr;

  Pencil& push() {
    if (stack_size == stack.size()) stack.resize(2 * stack_size);
    return stack[stack_size++];
  }

  [[nodiscard]] Vector relative(VertexId p) const {
    const LatticePoint at = tri.position[p];
    return {at.x - origin.x, at.y - origin.y};
  }

  // The cross product; exact for small vectors, else its sign is.
  template <bool kSmall>
  [[nodiscard]] static double cross(Vector p, Vector q) {
    return kSmall ? p.x * q.y - p.y * q.x : wide_cross(p, q);
  }
  template <bool kSmall>
  [[nodiscard]] static bool is_exact(double extent) {
    return kSmall || extent < kExactExtent;
  }

  // Whether p is hit before q by circles through u and s that slide to the right; both lie right of us.
  [[nodiscard]] bool before_on_right(const Hit& p, const Hit& q, VertexId s, bool exact) const {
    if (exact && is_certain(p, q)) return p.ratio < q.ratio;
    return p.p != q.p && in_circle(tri.position[s], at_u, tri.position[q.p], tri.position[p.p]);
  }

  // Whether p is hit before q by circles through u and v that slide to the left; both lie left of uv.
  [[nodiscard]] bool before_on_left(const Hit& p, const Hit& q, VertexId v, bool exact) const {
    if (exact && is_certain(p, q)) return p.ratio > q.ratio;
    return p.p != q.p && in_circle(at_u, tri.position[v], tri.position[q.p], tri.position[p.p]);
  }

  // Whether p, left of uv, lies inside the circle through u, v and q, right of uv.
  [[nodiscard]] bool inside_from_left(const Hit& p, const Hit& q, VertexId v, bool exact) const {
    if (exact && is_certain(p, q)) return p.ratio > q.ratio;
    return in_circle(tri.position[v], at_u, tri.position[q.p], tri.position[p.p]);
  }

  // A disc through u and s lies within a distance of its diameter from u.
  void certify(VertexId s, Vector at_s, const Hit& last) {
    const double diameter2 = (at_s.x * at_s.x + at_s.y * at_s.y) * (1 + last.ratio * last.ratio);
    if (!(diameter2 * (1 + 1e-9) < reach2)) beyond->push_back({u, s, last.p});
  }

  // The neighbours of c right of us that are not inside.
  template <bool kSmall>
  void add_neighbors(VertexId c, Vector at_s) {
    const auto link = links.of(c);
    frontier.make_room(link.size() + 1);
    Frontier::Filler fill(frontier);
    if constexpr (kSmall) {
      for (std::size_t i = 0; i < link.size(); i += 2) {
        const VertexId p = link[i], q = link[i + (i + 1 < link.size())];  // an odd one twice: it is added once
        const auto [d, r] = ratios(vectors_between(at_u, tri.position[p], tri.position[q]), at_s);
        const unsigned is_right = positive(d);
        fill.offer(p, r[0], is_right & 1U);
        fill.offer(q, r[1], is_right >> 1U);
      }
    } else {
      for (const VertexId w : link) {
        const Vector at = relative(w);
        const double d = wide_cross(at, at_s);
        if (!(d > 0)) continue;
        fill.offer(w, ratio(at, at_s, d), 1);
        frontier_extent = std::max(frontier_extent, at.extent());
      }
    }
  }

  // Index of the frontier's point that is hit first. Precondition: there is one.
  template <bool kSmall>
  [[nodiscard]] std::uint32_t first_hit(VertexId s) const {
    const bool exact = is_exact<kSmall>(frontier_extent);
    const auto [index, ratio, following] = frontier.least();
    // Nothing but ratios next to the least one can be in doubt.
    if (exact && following > ratio + kDoubt * std::fabs(ratio)) return index;
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < frontier.size(); ++i)
      if (before_on_right(frontier[i], frontier[best], s, exact)) best = i;
    return best;
  }

  template <bool kSmall>
  void slide() {
    const Vector at_s = relative(pencil.s);
    Vector leftmost = relative(pencil.inside[0]);
    frontier.clear();
    if constexpr (!kSmall) frontier_extent = at_s.extent();
    for (std::uint32_t i = 0; i < pencil.count; ++i) frontier.bar(pencil.inside[i]);
    add_neighbors<kSmall>(pencil.inside[0], at_s);
    for (std::uint32_t i = 1; i < pencil.count; ++i) {
      const VertexId p = pencil.inside[i];
      add_neighbors<kSmall>(p, at_s);
      const Vector at = relative(p);
      if (cross<kSmall>(leftmost, at) > 0) leftmost = at;
    }
    for (;;) {
      if (frontier.size() == 0) return certify(pencil.s, at_s, {VertexId{}, kInfinity});
      const std::uint32_t index = first_hit<kSmall>(pencil.s);
      const Hit hit = frontier[index];
      const bool at_end = pencil.count == k;
      if (at_end) certify(pencil.s, at_s, hit);
      const Vector at = relative(hit.p);
      if (cross<kSmall>(leftmost, at) > 0) {
        consider<kSmall>(hit.p, at);
        leftmost = at;
      }
      if (at_end) return;
      frontier.remove(index);
      pencil.add(hit.p);
      add_neighbors<kSmall>(hit.p, at_s);
    }
  }

  // Adds w to the points on the left if it is inside; false if that is one too many.
  bool add_left(const Hit& hit, const Hit& s2, VertexId v, bool exact) {
    if (!inside_from_left(hit, s2, v, exact) || left.has(hit.p)) return true;
    if (left.size() == k) return false;
    left.append(hit);
    return true;
  }

  // Collects the points left of uv inside the circle through u, v and s2; false if there are more than k.
  bool collect_left_small(const Hit& s2, VertexId v, Vector at_v) {
    const double least = s2.ratio - kDoubt * std::fabs(s2.ratio);
    for (std::uint32_t i = 0; i < left.size(); ++i) {
      const auto link = links.of(left[i].p);
      for (std::size_t j = 0; j < link.size(); j += 2) {
        const VertexId p = link[j], q = link[j + (j + 1 < link.size())];
        const auto [d, r] = ratios(vectors_between(at_u, tri.position[p], tri.position[q]), at_v);
        const unsigned close = negative_and_least(d, r, least);
        if (close == 0) continue;
        if ((close & 1U) && !add_left({p, r[0]}, s2, v, true)) return false;
        if ((close & 2U) && !add_left({q, r[1]}, s2, v, true)) return false;
      }
    }
    return true;
  }

  bool collect_left_large(const Hit& s2, VertexId v, Vector at_v) {
    for (std::uint32_t i = 0; i < left.size(); ++i)
      for (const VertexId w : links.of(left[i].p)) {
        const Vector at = relative(w);
        const double d = wide_cross(at, at_v);
        if (!(d < 0)) continue;
        const Hit hit{w, ratio(at, at_v, d)};
        const std::uint32_t before = left.size();
        if (!add_left(hit, s2, v, std::max(left.extent, at.extent()) < kExactExtent)) return false;
        if (left.size() > before) left.extent = std::max(left.extent, at.extent());
      }
    return true;
  }

  template <bool kSmall>
  bool collect_left(VertexId s1, const Hit& s2, VertexId v, Vector at_v) {
    left.clear();
    const Vector at_s1 = relative(s1);
    left.append({s1, ratio(at_s1, at_v, cross<kSmall>(at_s1, at_v))});
    if constexpr (kSmall) return collect_left_small(s2, v, at_v);
    left.extent = std::max(right.extent, at_s1.extent());
    return collect_left_large(s2, v, at_v);
  }

  // Lemma 2.1 for the edge from u to the hit v, with s1 = the pencil's s and the points inside C(u, v, s1) known.
  template <bool kSmall>
  void consider(VertexId v, Vector at_v) {
    right.clear();
    if constexpr (!kSmall) {
      right.extent = at_v.extent();
      for (std::uint32_t i = 0; i < pencil.count; ++i)
        right.extent = std::max(right.extent, relative(pencil.inside[i]).extent());
    }
    for (std::uint32_t i = 0; i < pencil.count; ++i) {
      const Vector at = relative(pencil.inside[i]);
      right.insert({pencil.inside[i], ratio(at, at_v, cross<kSmall>(at, at_v))}, [&](const Hit& p, const Hit& q) {
        return before_on_right(p, q, v, is_exact<kSmall>(right.extent));
      });
    }
    if (!collect_left<kSmall>(pencil.s, right[0], v, at_v)) return;
    certify(v, at_v, right[0]);
    if (at_u < tri.position[v]) emit<kSmall>(v);
    Pencil& next = push();
    next.s = v;
    next.count = right.size();
    for (std::uint32_t i = 0; i < right.size(); ++i) next.inside[i] = right[i].p;
  }

  template <bool kSmall>
  void emit(VertexId v) {
    left.sort([&](const Hit& p, const Hit& q) { return before_on_left(p, q, v, is_exact<kSmall>(left.extent)); });
    edges->a.push_back(u);
    edges->b.push_back(v);
    edges->useful_order.push_back(static_cast<std::uint8_t>(std::max(right.size(), left.size())));
    edges->num_right.push_back(static_cast<std::uint8_t>(right.size()));
    edges->entry.push_back(entry);
    const std::size_t begin = edges->content.size();
    edges->content.resize(begin + right.size() + left.size());
    VertexId* out = edges->content.data() + begin;
    for (std::uint32_t i = 0; i < right.size(); ++i) *out++ = right[i].p;
    for (std::uint32_t i = 0; i < left.size(); ++i) *out++ = left[i].p;
    edges->content_begin.push_back(static_cast<std::uint32_t>(edges->content.size()));
  }

  template <bool kSmall>
  void grow_cone(VertexId m0, VertexId s0, HalfedgeId across) {
    const LatticePoint m = tri.position[m0], s = tri.position[s0];
    // A cone is narrower than a half turn: with both sides before u, so is everything in it.
    if (m < at_u && s < at_u) return;
    // No edge leaves the cone across the hull.
    if (tri.twin[across].is_none()) return;
    entry = across;
    Pencil& first = push();
    first.s = s0;
    first.count = 0;
    first.add(m0);
    while (stack_size > 0) {
      pencil.copy(stack[--stack_size]);
      slide<kSmall>();
    }
  }

  template <bool kSmall>
  void grow_star() {
    const std::uint32_t begin = links.begin[u.value], end = links.begin[u.value + 1];
    for (std::uint32_t i = begin; i < end; ++i) {
      const HalfedgeId spoke = links.spoke[i];
      if (spoke.is_none()) continue;  // the last neighbour of a hull vertex: no triangle follows
      const std::uint32_t following = i + 1 == end ? begin : i + 1;
      grow_cone<kSmall>(links.neighbor[i], links.neighbor[following], next(spoke));
    }
  }
};

PencilGrowth::PencilGrowth(const TriangulationView& triangulation, const VertexLinks& links, int k,
                           const LatticeBox& window)
    : impl_(new Impl(triangulation, links, k, window)) {
  assert(k >= 1 && k <= kMaxOrder);
}

PencilGrowth::~PencilGrowth() {
  delete impl_;
}

void PencilGrowth::grow(VertexId u, UsefulEdges& edges, std::vector<DecidingCircle>& beyond) {
  Impl& self = *impl_;
  const LatticePoint p = self.tri.position[u];
  self.u = u;
  self.at_u = p;
  self.origin = {static_cast<double>(p.x), static_cast<double>(p.y)};
  self.edges = &edges;
  self.beyond = &beyond;
  const std::int64_t reach = std::min({std::int64_t{p.x} - self.window.min.x, std::int64_t{self.window.max.x} - p.x,
                                       std::int64_t{p.y} - self.window.min.y, std::int64_t{self.window.max.y} - p.y});
  self.reach2 = reach < 0 ? 0 : static_cast<double>(reach) * static_cast<double>(reach);
  if (self.is_small)
    self.grow_star<true>();
  else
    self.grow_star<false>();
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

void UsefulEdges::trim() {
  for (auto* ids : {&a, &b, &content}) ids->shrink_to_fit();
  for (auto* numbers : {&useful_order, &num_right}) numbers->shrink_to_fit();
  entry.shrink_to_fit();
  content_begin.shrink_to_fit();
}

UsefulEdges PencilGrowth::grow_range(VertexId begin, VertexId end, std::vector<DecidingCircle>& beyond) {
  UsefulEdges edges;
  for (VertexId u = begin; u < end; ++u.value) grow(u, edges, beyond);
  edges.trim();
  return edges;
}

namespace {

// Moves one array of all parts.
template <class Array>
void concatenate(std::vector<UsefulEdges>& parts, Array UsefulEdges::*array, UsefulEdges& out) {
  std::size_t size = 0;
  for (const UsefulEdges& part : parts) size += (part.*array).size();
  (out.*array).reserve(size);
  for (UsefulEdges& part : parts) {
    (out.*array).insert((out.*array).end(), (part.*array).begin(), (part.*array).end());
    Array().swap(part.*array);
  }
}

}  // namespace

UsefulEdges concatenate(std::vector<UsefulEdges> parts) {
  UsefulEdges out;
  std::size_t num_edges = 0;
  for (const UsefulEdges& part : parts) num_edges += part.size();
  out.content_begin.reserve(num_edges + 1);
  std::uint32_t base = 0;
  for (UsefulEdges& part : parts) {
    for (std::uint32_t e = 0; e < part.size(); ++e) out.content_begin.push_back(base + part.content_begin[e + 1]);
    base = out.content_begin.back();
    std::vector<std::uint32_t>(1).swap(part.content_begin);
  }
  concatenate(parts, &UsefulEdges::content, out);
  concatenate(parts, &UsefulEdges::a, out);
  concatenate(parts, &UsefulEdges::b, out);
  concatenate(parts, &UsefulEdges::useful_order, out);
  concatenate(parts, &UsefulEdges::num_right, out);
  concatenate(parts, &UsefulEdges::entry, out);
  return out;
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
  if (k == 0) return {};
  PencilGrowth growth(triangulation, links, k, kWholePlane);
  std::vector<DecidingCircle> beyond;
  std::vector<UsefulEdges> parts;
  const std::uint32_t n = triangulation.num_vertices();
  for (std::uint32_t begin = 0; begin < n; begin += kGrowthRange) {
    parts.push_back(growth.grow_range(VertexId{begin}, VertexId{std::min(n, begin + kGrowthRange)}, beyond));
    beyond.clear();
  }
  return concatenate(std::move(parts));
}

}  // namespace hydrotin
