#include "edits_file.h"

#include <algorithm>
#include <numeric>

#include "hydrotin/outline_rings.h"
#include "hydrotin/pit_edits.h"

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
};

template <class Key>
std::vector<std::uint32_t> order_by(std::size_t n, Key key) {
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  return order;
}

void write_regions(store::Writer& out, const ChangeableTerrain& terrain, std::span<const std::uint32_t> corner,
                   const PitEdits& edits) {
  std::vector<std::int32_t> key, level, lowest, ring_xy;
  std::vector<std::uint64_t> vertices, region_ring_begin{0}, ring_begin{0};
  std::vector<std::int64_t> displacement;
  std::vector<double> volume;
  const Stars stars(edits.region.empty() ? 0 : terrain.height.size(),
                    edits.region.empty() ? std::span<const std::uint32_t>() : corner);
  const auto order = order_by(edits.region.size(), [&](std::uint32_t r) {
    return terrain.position[edits.region_vertex[edits.region_begin[r]]];
  });
  std::vector<std::uint32_t> triangle, inside;
  for (const std::uint32_t r : order) {
    const std::span<const std::uint32_t> vertex(edits.region_vertex.data() + edits.region_begin[r],
                                                edits.region_vertex.data() + edits.region_begin[r + 1]);
    triangle.clear();
    for (const std::uint32_t v : vertex)
      triangle.insert(triangle.end(), stars.triangle.begin() + stars.begin[v],
                      stars.triangle.begin() + stars.begin[v + 1]);
    std::sort(triangle.begin(), triangle.end());
    triangle.erase(std::unique(triangle.begin(), triangle.end()), triangle.end());
    inside.clear();
    for (const std::uint32_t t : triangle)
      inside.insert(inside.end(), corner.begin() + 3 * std::ptrdiff_t{t}, corner.begin() + 3 * std::ptrdiff_t{t} + 3);
    const OutlineRings rings = outline_rings(inside, terrain.position);
    for (std::uint32_t i = 0; i < rings.size(); ++i) {
      for (const std::uint32_t v : rings.ring(i))
        ring_xy.insert(ring_xy.end(), {terrain.position[v].x, terrain.position[v].y});
      ring_begin.push_back(ring_xy.size() / 2);
    }
    region_ring_begin.push_back(ring_begin.size() - 1);
    const LiftedRegion& region = edits.region[r];
    const LatticePoint first = terrain.position[vertex.front()], bottom = terrain.position[region.lowest];
    key.insert(key.end(), {first.x, first.y});
    level.push_back(region.level);
    lowest.insert(lowest.end(), {bottom.x, bottom.y, terrain.height[region.lowest]});
    vertices.push_back(vertex.size());
    displacement.push_back(region.displacement);
    volume.push_back(region.volume);
  }
  out.append("region_key", key, "smallest vertex by (x, y) of each lifted region");
  out.append("region_level", level, "z lattice: its final height");
  out.append("region_lowest", lowest, "its lowest vertex, as measured");
  out.append("region_vertices", vertices);
  out.append("region_displacement", displacement, "z lattice");
  out.append("region_volume", volume, "cubed lattice units");
  out.append("region_ring_begin", region_ring_begin, "offsets into ring_begin, one more than regions");
  out.append("ring_begin", ring_begin, "offsets into ring_xy in points, one more than rings");
  out.append("ring_xy", ring_xy, "rings around the triangles that changed: the outer one, then holes");
}

void write_breaches(store::Writer& out, const ChangeableTerrain& terrain, const PitEdits& edits,
                    std::span<const std::int32_t> height) {
  std::vector<std::int32_t> key, pit, depth, xyz;
  std::vector<std::uint64_t> lowered, begin{0};
  std::vector<std::int64_t> displacement;
  std::vector<double> length, volume;
  const auto order = order_by(edits.breach.size(), [&](std::uint32_t b) {
    return terrain.position[edits.breach_vertex[edits.breach_begin[b]]];
  });
  for (const std::uint32_t b : order) {
    const Breach& breach = edits.breach[b];
    const std::span<const std::uint32_t> vertex(edits.breach_vertex.data() + edits.breach_begin[b],
                                                edits.breach_vertex.data() + edits.breach_begin[b + 1]);
    std::uint64_t moved = 0;
    for (std::size_t i = 0; i < vertex.size(); ++i) {
      xyz.insert(xyz.end(), {terrain.position[vertex[i]].x, terrain.position[vertex[i]].y, height[vertex[i]]});
      moved += height[vertex[i]] < terrain.height[vertex[i]];
    }
    const LatticePoint first = terrain.position[vertex.front()];
    const bool has_pit = breach.pit != kNoVertexNumber;
    const std::uint32_t start = has_pit ? breach.pit : vertex.front();
    key.insert(key.end(), {first.x, first.y});
    pit.insert(pit.end(),
               {terrain.position[start].x, terrain.position[start].y, has_pit ? terrain.height[start] : kNoLevel});
    displacement.push_back(breach.displacement);
    depth.push_back(breach.max_depth);
    lowered.push_back(moved);
    length.push_back(breach.length);
    volume.push_back(breach.volume);
    begin.push_back(xyz.size() / 3);
  }
  out.append("breach_key", key, "first vertex of each breach");
  out.append("breach_pit", pit, "the pit that it drains: smallest vertex by (x, y), height; 2147483647: none");
  out.append("breach_displacement", displacement, "z lattice");
  out.append("breach_depth", depth, "z lattice: the most that a vertex of it was lowered");
  out.append("breach_lowered", lowered, "vertices of the line that were lowered, by it or by the one that it joins");
  out.append("breach_length", length, "lattice units, horizontally");
  out.append("breach_volume", volume, "cubed lattice units");
  out.append("breach_begin", begin, "offsets into breach_xyz in points, one more than breaches");
  out.append("breach_xyz", xyz, "the line with its new heights, from the pit to where it drains");
}

}  // namespace

void ChangeFigures::add(std::int64_t displacement, std::int64_t star) {
  if (displacement == 0) return;
  const std::int64_t size = displacement < 0 ? -displacement : displacement;
  (displacement > 0 ? raised : lowered) += 1;
  (displacement > 0 ? raise_total : lower_total) += size;
  std::int64_t& most = displacement > 0 ? raise_max : lower_max;
  most = std::max(most, size);
  volume.add(static_cast<double>(star) * static_cast<double>(size));
}

void ChangeFigures::add(const ChangeFigures& other) {
  raised += other.raised;
  lowered += other.lowered;
  raise_total += other.raise_total;
  lower_total += other.lower_total;
  raise_max = std::max(raise_max, other.raise_max);
  lower_max = std::max(lower_max, other.lower_max);
  volume.add(other.volume);
  groups += other.groups;
  unguaranteed += other.unguaranteed;
}

void write_figures(store::Writer& out, const ChangeFigures& f) {
  out.append(
      "change",
      std::vector<std::int64_t>{f.raised, f.lowered, f.raise_total, f.lower_total, f.raise_max, f.lower_max,
                                f.volume.high(), static_cast<std::int64_t>(f.volume.low()), f.groups, f.unguaranteed},
      "vertices raised, lowered; totals and maxima of both; sixfold volume (high, low); groups solved; of "
      "these too large for Algorithm 6.1");
}

ChangeFigures read_change_figures(const store::Reader& in) {
  const auto v = in.read<std::int64_t>("change");
  if (v.size() != 10)
    throw Error(ErrorKind::storage, in.path() + ": its figures are cut; delete the file and run again");
  ChangeFigures f{v[0], v[1], v[2], v[3], v[4], v[5], ExactSum(v[6], static_cast<std::uint64_t>(v[7])), v[8], v[9]};
  return f;
}

void write_edits(store::Writer& out, const ChangeableTerrain& terrain, std::span<const std::uint32_t> triangle,
                 const PitComponents& components, std::span<const std::int32_t> height,
                 std::span<const std::int64_t> star) {
  const PitEdits edits = find_edits(terrain, components, height, star);
  write_regions(out, terrain, triangle, edits);
  write_breaches(out, terrain, edits, height);
}

}  // namespace hydrotin
