#include "thin_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "hydrotin/predicates.h"
#include "hydrotin/triangulation.h"

namespace hydrotin::thinning {
namespace {

// Whether a point on the line, moved by (e, e^2), lies left of the line from a to b.
bool is_left_perturbed(LatticePoint a, LatticePoint b) {
  return a.y != b.y ? a.y > b.y : a.x < b.x;
}

// The plane over a triangle, and what a point's place in the triangle costs.
struct Plane {
  LatticePoint a, b, c;
  std::int32_t height = 0;
  std::int64_t bx = 0, by = 0, cx = 0, cy = 0, bz = 0, cz = 0;
  bool is_short = false;  // products of places and heights fit 64 bits
  Wide area = 0;
  WideSize most = 0;  // numerators beyond it are beyond the limit
  WideSize worst = 0;

  Plane(LatticePoint pa, LatticePoint pb, LatticePoint pc, std::int32_t za, std::int32_t zb, std::int32_t zc)
      : a(pa), b(pb), c(pc), height(za) {
    bx = std::int64_t{b.x} - a.x;
    by = std::int64_t{b.y} - a.y;
    cx = std::int64_t{c.x} - a.x;
    cy = std::int64_t{c.y} - a.y;
    bz = std::int64_t{zb} - za;
    cz = std::int64_t{zc} - za;
    constexpr std::int64_t kShort = std::int64_t{1} << 19;
    const auto in = [](std::int64_t v) { return v < kShort && v > -kShort; };
    is_short = in(bx) && in(by) && in(cx) && in(cy) && in(bz) && in(cz);
    area = static_cast<Wide>(bx) * cy - static_cast<Wide>(by) * cx;
  }

  void limit_by(std::int64_t millionths) {
    constexpr unsigned kMillion = 1'000'000;
    const auto product = static_cast<WideSize>(area) * static_cast<WideSize>(millionths);
    most = product >> 64 == 0 ? static_cast<std::uint64_t>(product) / kMillion : product / kMillion;
  }

  // Twice the areas that p cuts off beside c and beside b: weights of b and c in its place.
  template <class Int>
  void weights(LatticePoint p, Int& at_b, Int& at_c) const {
    const Int wx = std::int64_t{p.x} - a.x, wy = std::int64_t{p.y} - a.y;
    at_b = wx * static_cast<Int>(cy) - wy * static_cast<Int>(cx);
    at_c = static_cast<Int>(bx) * wy - static_cast<Int>(by) * wx;
  }

  template <class Int>
  [[nodiscard]] bool holds_by(Int at_b, Int at_c) const {
    const Int at_a = static_cast<Int>(area) - at_b - at_c;
    if (at_a < 0 || at_b < 0 || at_c < 0) return false;
    if (at_c == 0 && !is_left_perturbed(a, b)) return false;
    if (at_a == 0 && !is_left_perturbed(b, c)) return false;
    return at_b != 0 || is_left_perturbed(c, a);
  }

  // Numerator of p's distance, if the triangle holds it.
  template <class Int>
  bool measure_by(LatticePoint p, std::int32_t z, bool is_closed, Wide& numerator) const {
    Int at_b, at_c;
    weights<Int>(p, at_b, at_c);
    const bool is_in =
        is_closed ? at_b >= 0 && at_c >= 0 && at_b + at_c <= static_cast<Int>(area) : holds_by<Int>(at_b, at_c);
    if (!is_in) return false;
    const Int dz = std::int64_t{z} - height;
    numerator = dz * static_cast<Int>(area) - static_cast<Int>(bz) * at_b - static_cast<Int>(cz) * at_c;
    return true;
  }

  bool measure(LatticePoint p, std::int32_t z, bool is_closed, Wide& numerator) const {
    constexpr std::int64_t kShort = std::int64_t{1} << 19;
    const auto near = [](std::int64_t v) { return v < kShort && v > -kShort; };
    if (is_short && near(std::int64_t{z} - height) && near(std::int64_t{p.x} - a.x) && near(std::int64_t{p.y} - a.y))
      return measure_by<std::int64_t>(p, z, is_closed, numerator);
    return measure_by<Wide>(p, z, is_closed, numerator);
  }
};

// Which triangle holds a point of their union; a point on the hull may lie beyond all by an infinitesimal.
const Plane* holder_of(std::span<const Plane> plane, LatticePoint p, std::int32_t z, Wide& numerator) {
  for (const bool is_closed : {false, true})
    for (const Plane& at : plane)
      if (at.measure(p, z, is_closed, numerator)) return &at;
  return nullptr;
}

WideSize magnitude(Wide v) {
  return static_cast<WideSize>(v < 0 ? -v : v);
}

// The circle through three points, whatever their order: radius squared, and a box around it.
struct Circle {
  double x = 0, y = 0, radius2 = 0;

  Circle(LatticePoint a, LatticePoint b, LatticePoint c) {
    std::array<LatticePoint, 3> v{a, b, c};
    std::sort(v.begin(), v.end());
    const double bx = static_cast<double>(v[1].x) - v[0].x, by = static_cast<double>(v[1].y) - v[0].y;
    const double cx = static_cast<double>(v[2].x) - v[0].x, cy = static_cast<double>(v[2].y) - v[0].y;
    const double d = 2 * (bx * cy - by * cx);
    const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
    const double ux = (cy * b2 - by * c2) / d, uy = (bx * c2 - cx * b2) / d;
    radius2 = ux * ux + uy * uy;
    x = v[0].x + ux;
    y = v[0].y + uy;
  }

  // A little too large: the circles asked for are no wider than some cells, so a unit covers all rounding.
  [[nodiscard]] LatticeBox box() const {
    const double r = std::sqrt(radius2) * (1 + 1e-6) + 2;
    const auto clamp = [](double v) { return static_cast<std::int32_t>(std::clamp(v, -2147483647.0, 2147483647.0)); };
    return {{clamp(std::floor(x - r)), clamp(std::floor(y - r))}, {clamp(std::ceil(x + r)), clamp(std::ceil(y + r))}};
  }
};

}  // namespace

int side(LatticePoint a, LatticePoint b, LatticePoint p) {
  const int o = orientation(a, b, p);
  return o != 0 ? o : is_left_perturbed(a, b) ? 1 : -1;
}

ThinMesh::ThinMesh(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                   std::span<const std::uint32_t> first, std::int64_t limit_millionths, double local_radius)
    : position_(position),
      height_(height),
      limit_millionths_(limit_millionths),
      local_radius2_(local_radius * local_radius),
      next_(position.size(), kNone),
      owner_(position.size(), kNone),
      starts_(position.size(), kNone) {
  std::vector<LatticePoint> place;
  for (const std::uint32_t p : first) place.push_back(position[p]);
  const Triangulation start = delaunay(place);
  const TriangulationView tri = start.view();
  triangle_.resize(tri.num_triangles());
  for (TriangleId t{0}; t.value < tri.num_triangles(); ++t.value) {
    Triangle& out = triangle_[t.value];
    out.is_live = true;
    for (std::uint32_t i = 0; i < 3; ++i) {
      const HalfedgeId h{first_halfedge(t).value + i};
      out.corner[i] = first[tri.origin[h].value];
      out.across[i] = tri.twin[h].is_none() ? kNone : triangle_of(tri.twin[h]).value;
    }
    take_shape(t.value);
  }
  stamp_.resize(triangle_.size(), 0);
  if (!triangle_.empty()) load_points();
}

void ThinMesh::load_points() {
  for (const Triangle& t : triangle_)
    for (const std::uint32_t v : t.corner) owner_[v] = static_cast<std::uint32_t>(&t - triangle_.data());
  std::uint32_t at = 0;
  for (std::uint32_t p = static_cast<std::uint32_t>(position_.size()); p-- > 0;) {
    if (owner_[p] != kNone) {
      at = owner_[p];
      continue;
    }
    at = locate(position_[p], at);
    put(p, at);
  }
  for (std::uint32_t t = 0; t < triangle_.size(); ++t) rate(t);
}

std::uint32_t ThinMesh::locate(LatticePoint p, std::uint32_t at) const {
  for (;;) {
    const Triangle& t = triangle_[at];
    std::uint32_t beyond = kNone;
    [[maybe_unused]] bool on_rim = false, is_in = true;  // only asserted
    for (std::size_t i = 0; i < 3 && beyond == kNone; ++i) {
      const LatticePoint a = position_[t.corner[i]], b = position_[t.corner[(i + 1) % 3]];
      if (side(a, b, p) > 0) continue;
      is_in = false;
      beyond = t.across[i];
      on_rim = on_rim || (beyond == kNone && orientation(a, b, p) == 0 && std::min(a, b) <= p && p <= std::max(a, b));
    }
    if (beyond == kNone) {
      assert((is_in || on_rim) && "all points lie within the hull");
      return at;
    }
    at = beyond;
  }
}

std::uint32_t ThinMesh::take_slot() {
  if (!free_.empty()) {
    const std::uint32_t t = free_.back();
    free_.pop_back();
    triangle_[t] = {};
    triangle_[t].is_live = true;
    return t;
  }
  triangle_.emplace_back().is_live = true;
  stamp_.push_back(0);
  return static_cast<std::uint32_t>(triangle_.size() - 1);
}

void ThinMesh::give_back(std::uint32_t t) {
  triangle_[t].is_live = false;
  triangle_[t].head = triangle_[t].worst = kNone;
  free_.push_back(t);
}

void ThinMesh::take_shape(std::uint32_t t) {
  Triangle& out = triangle_[t];
  const Circle circle(position_[out.corner[0]], position_[out.corner[1]], position_[out.corner[2]]);
  out.is_local = circle.radius2 <= local_radius2_;
  if (out.is_local) out.reach = circle.box();
  for (const std::uint32_t v : out.corner) owner_[v] = t;
}

void ThinMesh::link_to(std::uint32_t t, std::uint32_t i, std::uint32_t beyond) {
  triangle_[t].across[i] = beyond;
  if (beyond == kNone) return;
  const std::uint32_t from = triangle_[t].corner[i];
  Triangle& other = triangle_[beyond];
  for (std::size_t j = 0; j < 3; ++j)
    if (other.corner[(j + 1) % 3] == from) other.across[j] = t;
}

void ThinMesh::put(std::uint32_t p, std::uint32_t t) {
  owner_[p] = t;
  next_[p] = triangle_[t].head;
  triangle_[t].head = p;
}

void ThinMesh::rate(std::uint32_t t) {
  Triangle& out = triangle_[t];
  out.worst = kNone;
  out.error = 0;
  if (out.head == kNone) return;
  const auto& v = out.corner;
  Plane plane(position_[v[0]], position_[v[1]], position_[v[2]], height_[v[0]], height_[v[1]], height_[v[2]]);
  plane.limit_by(limit_millionths_);
  WideSize worst = plane.most;
  for (std::uint32_t p = out.head; p != kNone; p = next_[p]) {
    Wide numerator = 0;
    const bool is_in = plane.measure(position_[p], height_[p], true, numerator);
    assert(is_in);
    static_cast<void>(is_in);
    const auto size = magnitude(numerator);
    if (size < worst || size <= plane.most) continue;
    if (size == worst && !(position_[p] < position_[out.worst])) continue;
    worst = size;
    out.worst = p;
  }
  if (out.worst != kNone) out.error = static_cast<double>(worst) / static_cast<double>(plane.area);
}

void ThinMesh::find_cavity(std::uint32_t p) {
  cavity_.assign(1, owner_[p]);
  rim_.clear();
  ++turn_;
  stamp_[owner_[p]] = turn_;
  for (std::size_t i = 0; i < cavity_.size(); ++i) {
    const Triangle& t = triangle_[cavity_[i]];
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t beyond = t.across[e], from = t.corner[e], to = t.corner[(e + 1) % 3];
      if (beyond != kNone) {
        if (stamp_[beyond] == turn_) continue;
        const auto& v = triangle_[beyond].corner;
        if (in_circle(position_[v[0]], position_[v[1]], position_[v[2]], position_[p])) {
          stamp_[beyond] = turn_;
          cavity_.push_back(beyond);
          continue;
        }
      } else if (orientation(position_[from], position_[to], position_[p]) == 0) {
        continue;  // p splits an edge of the hull
      }
      rim_.push_back({from, to, beyond, kNone});
    }
  }
}

// Gives the points of the cavity to the new triangles, which start at fresh[first].
void ThinMesh::share_points(std::uint32_t p, std::vector<std::uint32_t>& fresh, std::size_t first) {
  std::vector<Plane> plane;
  plane.reserve(fresh.size() - first);
  for (std::size_t i = first; i < fresh.size(); ++i) {
    const auto& v = triangle_[fresh[i]].corner;
    plane.emplace_back(position_[v[0]], position_[v[1]], position_[v[2]], height_[v[0]], height_[v[1]], height_[v[2]]);
    plane.back().limit_by(limit_millionths_);
    plane.back().worst = plane.back().most;
  }
  for (const std::uint32_t q : loose_) {
    if (q == p) continue;
    Wide numerator = 0;
    const Plane* holder = holder_of(plane, position_[q], height_[q], numerator);
    assert(holder != nullptr && "the new triangles cover the old ones");
    const auto at = static_cast<std::size_t>(holder - plane.data());
    const std::uint32_t t = fresh[first + at];
    put(q, t);
    const auto size = magnitude(numerator);
    if (size < plane[at].worst || size <= plane[at].most) continue;
    if (size == plane[at].worst && !(position_[q] < position_[triangle_[t].worst])) continue;
    plane[at].worst = size;
    triangle_[t].worst = q;
  }
  for (std::size_t i = 0; i < plane.size(); ++i)
    if (Triangle& t = triangle_[fresh[first + i]]; t.worst != kNone)
      t.error = static_cast<double>(plane[i].worst) / static_cast<double>(plane[i].area);
}

void ThinMesh::insert(std::uint32_t p, std::vector<std::uint32_t>& fresh) {
  find_cavity(p);
  loose_.clear();
  for (const std::uint32_t t : cavity_) {
    for (std::uint32_t q = triangle_[t].head; q != kNone; q = next_[q]) loose_.push_back(q);
    give_back(t);
  }
  const std::size_t first = fresh.size();
  for (std::uint32_t i = 0; i < rim_.size(); ++i) {
    Edge& edge = rim_[i];
    edge.fresh = take_slot();
    fresh.push_back(edge.fresh);
    triangle_[edge.fresh].corner = {edge.from, edge.to, p};
    starts_[edge.from] = i;
  }
  for (const Edge& edge : rim_) {
    link_to(edge.fresh, 0, edge.beyond);
    const std::uint32_t following = starts_[edge.to];
    if (following < rim_.size() && rim_[following].from == edge.to) {
      triangle_[edge.fresh].across[1] = rim_[following].fresh;
      triangle_[rim_[following].fresh].across[2] = edge.fresh;
    }
    take_shape(edge.fresh);
  }
  next_[p] = kNone;
  share_points(p, fresh, first);
}

bool ThinMesh::star(std::uint32_t v, std::vector<std::uint32_t>& triangles, std::vector<std::uint32_t>& link) const {
  triangles.clear();
  link.clear();
  const std::uint32_t begin = owner_[v];
  std::uint32_t t = begin;
  do {
    const Triangle& at = triangle_[t];
    const std::size_t i = at.corner[0] == v ? 0 : at.corner[1] == v ? 1 : 2;
    assert(at.is_live && at.corner[i] == v);
    triangles.push_back(t);
    link.push_back(at.corner[(i + 1) % 3]);
    t = at.across[(i + 2) % 3];  // beyond the edge from the far corner back to v
  } while (t != kNone && t != begin);
  return t == begin;
}

bool ThinMesh::fill_hole(std::span<const std::uint32_t> link, std::vector<std::array<std::uint32_t, 3>>& fill) const {
  fill.clear();
  std::vector<std::array<std::uint32_t, 2>> chain{{0, static_cast<std::uint32_t>(link.size() - 1)}};
  while (!chain.empty()) {
    const auto [i, j] = chain.back();
    chain.pop_back();
    if (j - i < 2) continue;
    const LatticePoint from = position_[link[j]], to = position_[link[i]];
    std::uint32_t apex = kNone;
    for (std::uint32_t k = i + 1; k < j; ++k) {
      const LatticePoint p = position_[link[k]];
      if (orientation(from, to, p) <= 0) continue;
      if (apex == kNone || in_circle(from, to, position_[link[apex]], p)) apex = k;
    }
    assert(apex != kNone && "a link is a simple polygon");
    if (Circle(from, to, position_[link[apex]]).radius2 > local_radius2_) return false;
    fill.push_back({j, i, apex});
    chain.push_back({i, apex});
    chain.push_back({apex, j});
  }
  return true;
}

double ThinMesh::error_without(std::uint32_t v, std::span<const std::uint32_t> triangles,
                               std::span<const std::uint32_t> link,
                               std::span<const std::array<std::uint32_t, 3>> fill) const {
  std::vector<Plane> plane;
  plane.reserve(fill.size());
  for (const auto& [a, b, c] : fill) {
    const std::uint32_t i = link[a], j = link[b], k = link[c];
    plane.emplace_back(position_[i], position_[j], position_[k], height_[i], height_[j], height_[k]);
    plane.back().limit_by(limit_millionths_);
  }
  double worst = 0;
  const auto stays = [&](std::uint32_t p) {
    Wide numerator = 0;
    const Plane* at = holder_of(plane, position_[p], height_[p], numerator);
    if (at == nullptr || magnitude(numerator) > at->most) return false;
    worst = std::max(worst, static_cast<double>(magnitude(numerator)) / static_cast<double>(at->area));
    return true;
  };
  if (!stays(v)) return -1;
  for (const std::uint32_t t : triangles)
    for (std::uint32_t p = triangle_[t].head; p != kNone; p = next_[p])
      if (!stays(p)) return -1;
  return worst;
}

void ThinMesh::remove(std::uint32_t v, std::span<const std::uint32_t> triangles, std::span<const std::uint32_t> link,
                      std::span<const std::array<std::uint32_t, 3>> fill, std::vector<std::uint32_t>& fresh) {
  loose_.assign(1, v);
  rim_.clear();
  const auto m = static_cast<std::uint32_t>(link.size());
  for (std::uint32_t i = 0; i < m; ++i) {
    const Triangle& t = triangle_[triangles[i]];
    const std::size_t at = t.corner[0] == v ? 0 : t.corner[1] == v ? 1 : 2;
    rim_.push_back({link[i], link[(i + 1) % m], t.across[(at + 1) % 3], kNone});
    for (std::uint32_t q = t.head; q != kNone; q = next_[q]) loose_.push_back(q);
  }
  for (const std::uint32_t t : triangles) give_back(t);
  const std::size_t first = fresh.size();
  for (const auto& [a, b, c] : fill) {
    const std::uint32_t t = take_slot();
    triangle_[t].corner = {link[a], link[b], link[c]};
    fresh.push_back(t);
  }
  // Edges of the fill are links of the rim or meet another triangle of the fill.
  const auto edge_of = [&](std::size_t f, std::size_t e) { return std::pair{fill[f][e], fill[f][(e + 1) % 3]}; };
  for (std::size_t f = 0; f < fill.size(); ++f)
    for (std::uint32_t e = 0; e < 3; ++e) {
      const auto [from, to] = edge_of(f, e);
      if (to == (from + 1) % m) {
        link_to(fresh[first + f], e, rim_[from].beyond);
        continue;
      }
      for (std::size_t g = 0; g < fill.size(); ++g)
        for (std::uint32_t d = 0; d < 3; ++d)
          if (edge_of(g, d) == std::pair{to, from}) triangle_[fresh[first + f]].across[e] = fresh[first + g];
    }
  for (std::size_t i = first; i < fresh.size(); ++i) take_shape(fresh[i]);
  share_points(kNone, fresh, first);
}

Distance ThinMesh::distance(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t p) const {
  const Plane plane(position_[a], position_[b], position_[c], height_[a], height_[b], height_[c]);
  Wide at_b, at_c;
  plane.weights<Wide>(position_[p], at_b, at_c);
  return {(std::int64_t{height_[p]} - height_[a]) * plane.area - plane.bz * at_b - plane.cz * at_c, plane.area};
}

bool ThinMesh::is_beyond(const Distance& d) const {
  const auto limit = static_cast<WideSize>(d.denominator) * static_cast<WideSize>(limit_millionths_);
  return magnitude(d.numerator) > limit / 1'000'000U;
}

bool ThinMesh::holds(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t p) const {
  return side(position_[a], position_[b], position_[p]) > 0 && side(position_[b], position_[c], position_[p]) > 0 &&
         side(position_[c], position_[a], position_[p]) > 0;
}

}  // namespace hydrotin::thinning
