#include "hydrotin/edit_features.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "hydrotin/outline_rings.h"

namespace hydrotin {
namespace {

// Triangles around each vertex, as CSR.
struct Stars {
  std::vector<std::uint32_t> begin, triangle;

  Stars(std::size_t num_vertices, std::span<const std::uint32_t> corner) : begin(num_vertices + 1, 0) {
    for (const std::uint32_t v : corner) ++begin[v + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    triangle.resize(corner.size());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (std::size_t h = 0; h < corner.size(); ++h) triangle[next[corner[h]]++] = static_cast<std::uint32_t>(h / 3);
  }

  // Triangles around any of some vertices, each once.
  void around(std::span<const std::uint32_t> vertex, std::vector<std::uint32_t>& found) const {
    found.clear();
    for (const std::uint32_t v : vertex)
      found.insert(found.end(), triangle.begin() + begin[v], triangle.begin() + begin[v + 1]);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
  }
};

template <class Key>
std::vector<std::uint32_t> order_by(std::size_t n, Key key) {
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  return order;
}

}  // namespace

RegionFeatures region_features(const ChangeableTerrain& terrain, std::span<const std::uint32_t> triangle_vertex,
                               const PitEdits& edits) {
  RegionFeatures out;
  if (edits.region.empty()) return out;
  const Stars stars(terrain.height.size(), triangle_vertex);
  const auto order = order_by(edits.region.size(), [&](std::uint32_t r) {
    return terrain.position[edits.region_vertex[edits.region_begin[r]]];
  });
  std::vector<std::uint32_t> triangle, inside;
  for (const std::uint32_t r : order) {
    const std::span<const std::uint32_t> vertex(edits.region_vertex.data() + edits.region_begin[r],
                                                edits.region_vertex.data() + edits.region_begin[r + 1]);
    stars.around(vertex, triangle);
    inside.clear();
    for (const std::uint32_t t : triangle)
      inside.insert(inside.end(), triangle_vertex.begin() + 3 * std::ptrdiff_t{t},
                    triangle_vertex.begin() + 3 * std::ptrdiff_t{t} + 3);
    const OutlineRings rings = outline_rings(inside, terrain.position);
    for (std::uint32_t i = 0; i < rings.size(); ++i) {
      for (const std::uint32_t v : rings.ring(i))
        out.ring_xy.insert(out.ring_xy.end(), {terrain.position[v].x, terrain.position[v].y});
      out.ring_begin.push_back(out.ring_xy.size() / 2);
    }
    out.region_ring_begin.push_back(out.ring_begin.size() - 1);
    const LiftedRegion& region = edits.region[r];
    const LatticePoint first = terrain.position[vertex.front()], bottom = terrain.position[region.lowest];
    out.key.insert(out.key.end(), {first.x, first.y});
    out.level.push_back(region.level);
    out.lowest.insert(out.lowest.end(), {bottom.x, bottom.y, terrain.height[region.lowest]});
    out.vertices.push_back(vertex.size());
    out.displacement.push_back(region.displacement);
    out.volume.push_back(region.volume);
  }
  return out;
}

BreachFeatures breach_features(const ChangeableTerrain& terrain, const PitEdits& edits,
                               std::span<const std::int32_t> height) {
  assert(height.size() == terrain.height.size() && "one entry per vertex");
  BreachFeatures out;
  const auto order = order_by(edits.breach.size(), [&](std::uint32_t b) {
    return terrain.position[edits.breach_vertex[edits.breach_begin[b]]];
  });
  for (const std::uint32_t b : order) {
    const Breach& breach = edits.breach[b];
    const std::span<const std::uint32_t> vertex(edits.breach_vertex.data() + edits.breach_begin[b],
                                                edits.breach_vertex.data() + edits.breach_begin[b + 1]);
    std::uint64_t moved = 0;
    for (const std::uint32_t v : vertex) {
      out.xyz.insert(out.xyz.end(), {terrain.position[v].x, terrain.position[v].y, height[v]});
      moved += height[v] < terrain.height[v];
    }
    const LatticePoint first = terrain.position[vertex.front()];
    const bool has_pit = breach.pit != kNoVertexNumber;
    const std::uint32_t start = has_pit ? breach.pit : vertex.front();
    out.key.insert(out.key.end(), {first.x, first.y});
    out.pit.insert(out.pit.end(),
                   {terrain.position[start].x, terrain.position[start].y, has_pit ? terrain.height[start] : kNoLevel});
    out.displacement.push_back(breach.displacement);
    out.depth.push_back(breach.max_depth);
    out.lowered.push_back(moved);
    out.length.push_back(breach.length);
    out.volume.push_back(breach.volume);
    out.begin.push_back(out.xyz.size() / 3);
  }
  return out;
}

void keep_changed_triangles(std::span<const std::int32_t> change, std::vector<std::uint32_t>& triangle_vertex) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangle_vertex.size(); t += 3) {
    const std::uint32_t* v = &triangle_vertex[t];
    if (change[v[0]] == 0 && change[v[1]] == 0 && change[v[2]] == 0) continue;
    std::copy_n(v, 3, &triangle_vertex[kept]);
    kept += 3;
  }
  triangle_vertex.resize(kept);
}

}  // namespace hydrotin
