#include "hydrotin/outline_rings.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "boundary_walk.h"

namespace hydrotin {
namespace {

std::vector<DirectedEdge> boundary_of(std::span<const std::uint32_t> triangle) {
  std::vector<DirectedEdge> edge, boundary;
  edge.reserve(triangle.size());
  for (std::size_t h = 0; h < triangle.size(); ++h) edge.push_back({triangle[h], triangle[h % 3 == 2 ? h - 2 : h + 1]});
  std::sort(edge.begin(), edge.end());
  for (const DirectedEdge& e : edge)
    if (!std::binary_search(edge.begin(), edge.end(), DirectedEdge{e.target, e.origin})) boundary.push_back(e);
  return boundary;
}

struct Ring {
  bool is_hole = false;
  std::vector<std::uint32_t> vertex;
};

Ring normal_form(std::vector<std::uint32_t> vertex, std::span<const LatticePoint> position) {
  Ring ring;
  const auto before = [&](std::uint32_t a, std::uint32_t b) { return position[a] < position[b]; };
  std::rotate(vertex.begin(), std::min_element(vertex.begin(), vertex.end(), before), vertex.end());
  Wide doubled_area = 0;
  const LatticePoint origin = position[vertex.front()];
  const auto towards = [&](std::uint32_t v) {
    return Direction{std::int64_t{position[v].x} - origin.x, std::int64_t{position[v].y} - origin.y};
  };
  for (std::size_t i = 0; i < vertex.size(); ++i)
    doubled_area += cross(towards(vertex[i]), towards(vertex[(i + 1) % vertex.size()]));
  ring.is_hole = doubled_area < 0;
  ring.vertex = std::move(vertex);
  return ring;
}

// The simple rings of one walk: a loop is cut off where the walk comes back to a vertex.
void cut_walk(const std::vector<std::uint32_t>& walk, std::span<const LatticePoint> position,
              std::vector<Ring>& rings) {
  std::vector<std::uint32_t> open;
  std::map<std::uint32_t, std::size_t> place;
  for (const std::uint32_t v : walk) {
    const auto [at, is_new] = place.emplace(v, open.size());
    if (!is_new) {
      const std::size_t from = at->second;
      rings.push_back(normal_form({open.begin() + static_cast<std::ptrdiff_t>(from), open.end()}, position));
      for (std::size_t i = from + 1; i < open.size(); ++i) place.erase(open[i]);
      open.resize(from + 1);
      continue;
    }
    open.push_back(v);
  }
  rings.push_back(normal_form(std::move(open), position));
}

}  // namespace

OutlineRings outline_rings(std::span<const std::uint32_t> triangle, std::span<const LatticePoint> position) {
  const std::vector<DirectedEdge> edge = boundary_of(triangle);
  const std::vector<std::uint32_t> next = next_on_walk(edge, position);
  std::vector<Ring> rings;
  std::vector<bool> is_seen(edge.size());
  std::vector<std::uint32_t> walk;
  for (std::uint32_t seed = 0; seed < edge.size(); ++seed) {
    if (is_seen[seed]) continue;
    walk.clear();
    for (std::uint32_t i = seed; !is_seen[i]; i = next[i]) {
      is_seen[i] = true;
      walk.push_back(edge[i].origin);
    }
    cut_walk(walk, position, rings);
  }
  std::sort(rings.begin(), rings.end(), [&](const Ring& a, const Ring& b) {
    if (a.is_hole != b.is_hole) return b.is_hole;
    return std::ranges::lexicographical_compare(
        a.vertex, b.vertex, {}, [&](std::uint32_t v) { return position[v]; },
        [&](std::uint32_t v) { return position[v]; });
  });
  OutlineRings out;
  for (const Ring& ring : rings) {
    out.num_outer += ring.is_hole ? 0 : 1;
    out.vertex.insert(out.vertex.end(), ring.vertex.begin(), ring.vertex.end());
    out.begin.push_back(static_cast<std::uint32_t>(out.vertex.size()));
  }
  return out;
}

}  // namespace hydrotin
