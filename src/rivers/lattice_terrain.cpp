#include "hydrotin/lattice_terrain.h"

#include <algorithm>
#include <array>

#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

struct Directed {
  std::uint32_t from, to, halfedge;
  friend bool operator<(const Directed& a, const Directed& b) {
    return std::pair(a.from, a.to) < std::pair(b.from, b.to);
  }
};

std::vector<Directed> sorted_halfedges(std::span<const std::uint32_t> triangle) {
  std::vector<Directed> edges;
  edges.reserve(triangle.size());
  for (std::uint32_t h = 0; h < triangle.size(); ++h) edges.push_back({triangle[h], triangle[next_halfedge(h)], h});
  std::stable_sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace

void link_twins(LatticeTerrain& terrain) {
  const auto edges = sorted_halfedges(terrain.triangle);
  terrain.twin.assign(terrain.triangle.size(), kNoHalfedge);
  for (const Directed& edge : edges) {
    const auto found = std::lower_bound(edges.begin(), edges.end(), Directed{edge.to, edge.from, 0});
    if (found != edges.end() && found->from == edge.to && found->to == edge.from)
      terrain.twin[edge.halfedge] = found->halfedge;
  }
}

std::uint32_t find_bad_triangle(std::span<const LatticePoint> position, std::span<const std::uint32_t> triangle) {
  auto bad = static_cast<std::uint32_t>(triangle.size() / 3);
  for (std::uint32_t t = 0; t < bad; ++t)
    if (orientation(position[triangle[3 * t]], position[triangle[3 * t + 1]], position[triangle[3 * t + 2]]) <= 0)
      bad = t;
  const auto edges = sorted_halfedges(triangle);
  for (std::size_t i = 1; i < edges.size(); ++i)
    if (!(edges[i - 1] < edges[i])) bad = std::min(bad, edges[i].halfedge / 3);
  return bad;
}

double interpolate(const LatticeTerrain& terrain, std::uint32_t t, LatticePoint p) {
  std::array<std::uint32_t, 3> v = {terrain.triangle[3 * t], terrain.triangle[3 * t + 1], terrain.triangle[3 * t + 2]};
  std::sort(v.begin(), v.end(),
            [&](std::uint32_t a, std::uint32_t b) { return terrain.position[a] < terrain.position[b]; });
  const LatticePoint origin = terrain.position[v[0]];
  const auto offset = [&](LatticePoint q) {
    return std::array<double, 2>{static_cast<double>(q.x) - origin.x, static_cast<double>(q.y) - origin.y};
  };
  const auto a = offset(terrain.position[v[1]]), b = offset(terrain.position[v[2]]), q = offset(p);
  const double area = a[0] * b[1] - a[1] * b[0];
  const double x = (q[0] * b[1] - q[1] * b[0]) / area, y = (a[0] * q[1] - a[1] * q[0]) / area;
  return terrain.height[v[0]] + x * (terrain.height[v[1]] - terrain.height[v[0]]) +
         y * (terrain.height[v[2]] - terrain.height[v[0]]);
}

}  // namespace hydrotin
