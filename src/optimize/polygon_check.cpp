#include <algorithm>
#include <numeric>
#include <string>

#include "hydrotin/error.h"
#include "hydrotin/exact_sum.h"
#include "hydrotin/predicates.h"
#include "polygon_candidates.h"

namespace hydrotin {
namespace {

[[noreturn]] void refuse(const std::string& text) {
  throw Error(ErrorKind::input, text);
}

bool on_open_segment(LatticePoint a, LatticePoint b, LatticePoint p) {
  return p != a && p != b && orientation(a, b, p) == 0 && std::min(a, b) < p && p < std::max(a, b);
}

std::string edge_text(const std::array<std::uint32_t, 2>& e) {
  return std::string("(").append(std::to_string(e[0])).append(", ").append(std::to_string(e[1])).append(")");
}

// Undirected edges of boundary and inside.
std::vector<std::array<std::uint32_t, 2>> all_edges(const SimplePolygon& polygon) {
  std::vector<std::array<std::uint32_t, 2>> out;
  for (std::uint32_t i = 0; i < polygon.boundary; ++i) out.push_back({i, (i + 1) % polygon.boundary});
  out.insert(out.end(), polygon.edges.begin(), polygon.edges.end());
  return out;
}

void refuse_crossings(const SimplePolygon& polygon) {
  const auto edges = all_edges(polygon);
  const auto at = [&](std::uint32_t v) { return polygon.position[v]; };
  const auto low = [&](std::uint32_t e) { return std::min(at(edges[e][0]), at(edges[e][1])); };
  const auto high = [&](std::uint32_t e) { return std::max(at(edges[e][0]), at(edges[e][1])); };
  std::vector<std::uint32_t> order(edges.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t e, std::uint32_t f) { return low(e) < low(f); });
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && low(order[j]).x <= high(order[i]).x; ++j) {
      const auto &e = edges[order[i]], &f = edges[order[j]];
      const LatticePoint a = at(e[0]), b = at(e[1]), c = at(f[0]), d = at(f[1]);
      const bool same = (e[0] == f[0] && e[1] == f[1]) || (e[0] == f[1] && e[1] == f[0]);
      const bool touch =
          on_open_segment(a, b, c) || on_open_segment(a, b, d) || on_open_segment(c, d, a) || on_open_segment(c, d, b);
      if (same) refuse("the edge " + edge_text(e) + " is given twice; give every side and edge once");
      if (touch || properly_cross(a, b, c, d))
        refuse("the edges " + edge_text(e) + " and " + edge_text(f) +
               " cross or touch; a polygon must be simple, and edges inside may meet at points only");
    }
}

// Whether p lies strictly inside the ring; points on sides were refused or are vertices.
bool is_inside(const SimplePolygon& polygon, LatticePoint p) {
  bool inside = false;
  for (std::uint32_t i = 0; i < polygon.boundary; ++i) {
    const LatticePoint a = polygon.position[i], b = polygon.position[(i + 1) % polygon.boundary];
    if ((a.y > p.y) == (b.y > p.y)) continue;
    const int side = orientation(a, b, p);
    if ((b.y > a.y) == (side > 0)) inside = !inside;
  }
  return inside;
}

void refuse_outside(const SimplePolygon& polygon) {
  for (std::uint32_t v = polygon.boundary; v < polygon.position.size(); ++v) {
    for (std::uint32_t i = 0; i < polygon.boundary; ++i)
      if (on_open_segment(polygon.position[i], polygon.position[(i + 1) % polygon.boundary], polygon.position[v]))
        refuse("point " + std::to_string(v) + " lies on the side of the polygon that starts at vertex " +
               std::to_string(i) + "; make it a vertex, or leave it out");
    if (!is_inside(polygon, polygon.position[v]))
      refuse("point " + std::to_string(v) + " lies outside the polygon; give the vertices first, then points inside");
  }
}

Wide twice_signed_area(const SimplePolygon& polygon) {
  Wide area = 0;
  for (std::uint32_t i = 0; i < polygon.boundary; ++i) {
    const LatticePoint p = polygon.position[i], q = polygon.position[(i + 1) % polygon.boundary];
    area += Wide{p.x} * q.y - Wide{p.y} * q.x;
  }
  return area;
}

// An edge between two vertices of the boundary may run outside.
void refuse_outer_edges(const SimplePolygon& polygon) {
  const std::uint32_t m = polygon.boundary;
  const bool ccw = twice_signed_area(polygon) > 0;
  for (const auto& e : polygon.edges) {
    if (e[0] >= m || e[1] >= m) continue;
    const LatticePoint a = polygon.position[e[0]], b = polygon.position[e[1]];
    const LatticePoint next = polygon.position[(e[0] + 1) % m], previous = polygon.position[(e[0] + m - 1) % m];
    const LatticePoint first = ccw ? next : previous, last = ccw ? previous : next;
    const bool convex = orientation(last, a, first) > 0;
    const bool inside = convex ? orientation(a, first, b) > 0 && orientation(a, b, last) > 0
                               : !(orientation(a, last, b) >= 0 && orientation(a, b, first) >= 0);
    if (!inside) refuse("the edge " + edge_text(e) + " runs outside the polygon");
  }
}

std::uint32_t count_components(const SimplePolygon& polygon) {
  std::vector<std::uint32_t> root(polygon.position.size());
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const auto& e : all_edges(polygon)) root[find(e[0])] = find(e[1]);
  std::uint32_t count = 0;
  for (std::uint32_t v = 0; v < root.size(); ++v) count += find(v) == v;
  return count - 1;
}

}  // namespace

SoundPolygon check_polygon(const SimplePolygon& polygon) {
  if (polygon.boundary < 3) refuse("a polygon needs three vertices, these are " + std::to_string(polygon.boundary));
  for (const auto& e : polygon.edges)
    if (e[0] >= polygon.position.size() || e[1] >= polygon.position.size() || e[0] == e[1])
      refuse("the edge " + edge_text(e) + " does not join two of the " + std::to_string(polygon.position.size()) +
             " points");
  refuse_crossings(polygon);
  const Wide area = twice_signed_area(polygon);
  if (area == 0) refuse("the vertices of the polygon lie on one line: it has no inside");
  refuse_outside(polygon);
  refuse_outer_edges(polygon);
  SoundPolygon out{polygon, {}, {}, count_components(polygon)};
  out.ring.resize(polygon.boundary);
  std::iota(out.ring.begin(), out.ring.end(), 0U);
  if (area < 0) std::reverse(out.ring.begin(), out.ring.end());
  for (std::size_t i = 0; i < out.ring.size(); ++i)
    out.rim.push_back({out.ring[i], out.ring[(i + 1) % out.ring.size()]});
  for (const auto& e : polygon.edges) {
    out.rim.push_back({e[0], e[1]});
    out.rim.push_back({e[1], e[0]});
  }
  return out;
}

}  // namespace hydrotin
