#include "hydrotin/pencil_growth.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>

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
        frontier(triangulation.num_vertices()),
        neighbor(triangulation.num_vertices()) {
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
  bool is_first_before = false;  // the cone's first side is: with a point that is, too, all between them are
  std::vector<Pencil> stack{};
  std::size_t stack_size = 0;
  Pencil pencil{};  // the one that slides
  Frontier frontier;
  double frontier_extent = 0;      // of all vectors that the pencil's ratios are made of
  Marks neighbor;                  // over useful edges
  std::vector<VertexId> inside{};  // of each edge of u: the points on its right, then those on its left
  HitList right{}, left{};
  UsefulEdges* edges = nullptr;  // of the vertices grown so far
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
        const FractionPair f = fractions(vectors_between(at_u, tri.position[p], tri.position[q]), at_s);
        const Pair r = f.ratio();
        const unsigned is_right = positive(f.cross);
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
        if (!is_first_before || at_u < tri.position[hit.p]) consider<kSmall>(hit.p, at);
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
        const FractionPair f = fractions(vectors_between(at_u, tri.position[p], tri.position[q]), at_v);
        const unsigned close = left_and_least(f, least);
        if (close == 0) continue;
        const Pair r = f.ratio();
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
    neighbor.add(v);
    if (at_u < tri.position[v]) emit<kSmall>(v);
    Pencil& next = push();
    next.s = v;
    next.count = right.size();
    for (std::uint32_t i = 0; i < right.size(); ++i) next.inside[i] = right[i].p;
  }

  template <bool kSmall>
  void emit(VertexId v) {
    left.sort([&](const Hit& p, const Hit& q) { return before_on_left(p, q, v, is_exact<kSmall>(left.extent)); });
    edges->b.push_back(v);
    edges->left.push_back(left[0].p);
    edges->right.push_back(right[0].p);
    edges->num_left.push_back(static_cast<std::uint8_t>(left.size()));
    edges->num_right.push_back(static_cast<std::uint8_t>(right.size()));
    edges->entry.push_back(entry);
    // The first points are always corners of triangles.
    for (std::uint32_t i = 0; i < right.size(); ++i) inside.push_back(right[i].p);
    for (std::uint32_t i = 0; i < left.size(); ++i) inside.push_back(left[i].p);
  }

  // Looks among the points inside the circles of u's edges for apexes, when all useful neighbours after u are known.
  void find_apexes() {
    for (std::uint32_t i = links.begin[u.value]; i < links.begin[u.value + 1]; ++i) neighbor.add(links.neighbor[i]);
    const std::uint32_t first = edges->begin.back();
    std::size_t begin = 0;
    for (std::uint32_t e = first; e < edges->size(); ++e) {
      const auto all = std::span<const VertexId>(inside).subspan(begin);
      const auto right_side = all.first(edges->num_right[e]);
      const auto left_side = all.subspan(edges->num_right[e], edges->num_left[e]);
      begin += right_side.size() + left_side.size();
      const VertexId v = edges->b[e];
      find_apexes_of(e, v, u, right_side, left_side, true);
      find_apexes_of(e, u, v, left_side, right_side, false);
    }
    inside.clear();
    neighbor.clear();
  }

  // Keeps the points of one side, left of the edge from `from` to `to`, whose triangle with it is empty and of order at
  // most k. Both lists are in the order in which circles that slide to their side hit the points.
  void find_apexes_of(std::uint32_t e, VertexId from, VertexId to, std::span<const VertexId> own,
                      std::span<const VertexId> opposite, bool is_right) {
    const LatticePoint at_from = tri.position[from], at_to = tri.position[to];
    const auto at = [&](VertexId p) { return tri.position[p]; };
    for (std::size_t rank = 1; rank < own.size(); ++rank) {
      const LatticePoint w = at(own[rank]);
      if (at_u < w && !neighbor.has(own[rank])) continue;  // edges from w to u are for w to find
      const bool is_empty = std::none_of(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(rank), [&](VertexId p) {
        return orientation(at_to, w, at(p)) >= 0 && orientation(w, at_from, at(p)) >= 0;
      });
      if (!is_empty) continue;
      std::size_t order = rank;
      for (const VertexId p : opposite) {  // the farther from its side's first point, the earlier outside
        if (order > k || !in_circle(at_from, at_to, w, at(p))) break;
        ++order;
      }
      if (order <= k) edges->apex.push_back({e, own[rank], static_cast<std::uint8_t>(order), is_right});
    }
  }

  template <bool kSmall>
  void grow_cone(VertexId m0, VertexId s0, HalfedgeId across) {
    const LatticePoint m = tri.position[m0], s = tri.position[s0];
    // A cone is narrower than a half turn: with both sides before u, so is everything in it.
    if (m < at_u && s < at_u) return;
    // No edge leaves the cone across the hull.
    if (tri.twin[across].is_none()) return;
    entry = across;
    is_first_before = m < at_u;
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

void PencilGrowth::grow(VertexId u, GrownEdges& grown, std::vector<DecidingCircle>& beyond) {
  Impl& self = *impl_;
  const LatticePoint p = self.tri.position[u];
  self.u = u;
  self.at_u = p;
  self.origin = {static_cast<double>(p.x), static_cast<double>(p.y)};
  self.edges = &grown.edges;
  self.beyond = &beyond;
  const std::int64_t reach = std::min({std::int64_t{p.x} - self.window.min.x, std::int64_t{self.window.max.x} - p.x,
                                       std::int64_t{p.y} - self.window.min.y, std::int64_t{self.window.max.y} - p.y});
  self.reach2 = reach < 0 ? 0 : static_cast<double>(reach) * static_cast<double>(reach);
  if (self.is_small)
    self.grow_star<true>();
  else
    self.grow_star<false>();
  self.find_apexes();
  grown.vertex.push_back(u);
  grown.edges.begin.push_back(grown.edges.size());
}

}  // namespace hydrotin
