#include "river_state.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "embedded_rivers.h"
#include "hydrotin/river_statistics.h"
#include "river_edges.h"

namespace hydrotin {
namespace {

std::vector<std::uint8_t> way_flags(const EmbeddedRivers& rivers, const Part& part) {
  std::vector<std::uint8_t> out(part.num_vertices(), 0);
  for (std::uint32_t v = 0; v < part.num_vertices(); ++v) {
    const auto bound = rivers.bound.find(part.point[v]);
    out[v] = bound != rivers.bound.end() && bound->second.is_way ? 1 : 0;
  }
  return out;
}

void find_edges(const EmbeddedRivers& rivers, const Part& part, std::span<const std::uint8_t> is_way, RiverState& out) {
  const auto& edges = rivers.edge;
  for (std::size_t t = 0; t < part.triangle.size(); t += 3)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = part.triangle[t + i], b = part.triangle[t + (i + 1) % 3];
      if (is_way[a] == 0 || is_way[b] == 0) continue;
      if (std::binary_search(edges.begin(), edges.end(), std::pair(part.point[a], part.point[b])))
        out.edge.push_back({a, b});
      if (std::binary_search(edges.begin(), edges.end(), std::pair(part.point[b], part.point[a])))
        out.edge.push_back({b, a});
    }
  std::sort(out.edge.begin(), out.edge.end());
  out.edge.erase(std::unique(out.edge.begin(), out.edge.end()), out.edge.end());
}

// In the unit of the coordinates, from the same numbers in every tile: so the slopes are the same to the last bit.
void find_ways(const RunContext& context, const Part& part, std::span<const std::int32_t> height,
               std::span<const std::uint8_t> is_way, RiverState& out) {
  const auto& edges = context.rivers->edge;
  std::vector<std::uint8_t> is_source(part.num_vertices(), 0);
  for (std::uint32_t v = 0; v < part.num_vertices(); ++v) {
    if (is_way[v] == 0) continue;
    const auto at = std::lower_bound(edges.begin(), edges.end(), std::pair(part.point[v], std::uint64_t{0}));
    if (at == edges.end() || at->first != part.point[v]) continue;
    is_source[v] = 1;
    out.source.push_back(v);
  }
  if (out.source.empty()) return;
  std::vector<std::uint32_t> triangle, used;
  for (std::size_t t = 0; t < part.triangle.size(); t += 3) {
    const std::uint32_t* v = &part.triangle[t];
    if (is_source[v[0]] != 0 || is_source[v[1]] != 0 || is_source[v[2]] != 0) triangle.insert(triangle.end(), v, v + 3);
  }
  used = triangle;
  used.insert(used.end(), out.source.begin(), out.source.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto number = [&](std::uint32_t v) {
    return static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin());
  };
  for (std::uint32_t& v : triangle) v = number(v);
  const Lattice& l = context.plan.lattice;
  std::vector<std::array<double, 2>> place;
  std::vector<double> z;
  for (const std::uint32_t v : used) {
    place.push_back({part.position[v].x * l.scale_xy, part.position[v].y * l.scale_xy});
    z.push_back(height[v] * l.scale_z);
  }
  std::vector<std::uint32_t> source;
  for (const std::uint32_t v : out.source) source.push_back(number(v));
  out.steepest = steepest_ways({place, z, triangle}, z, source);
}

// Each edge once: by the triangle on its left from the smaller end, or by the only one at the edge of the data.
std::uint64_t count_slopes(const RunContext& context, const Part& part, std::span<const std::int32_t> height,
                           std::span<const std::uint8_t> is_way) {
  const RiverConstraints& rows = context.options.rivers.constraints;
  if (!rows.limit_edge_slope) return 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> hull;
  for (const DirectedEdge& e : part.hull_edge) hull.emplace_back(e.origin, e.target);
  std::sort(hull.begin(), hull.end());
  std::uint64_t count = 0;
  for (std::size_t t = 0; t < part.triangle.size(); t += 3)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = part.triangle[t + i], b = part.triangle[t + (i + 1) % 3];
      if (height[a] == part.height[a] && height[b] == part.height[b]) continue;
      if (is_way[a] != 0 || is_way[b] != 0) continue;
      if (part.position[b] < part.position[a] && !std::binary_search(hull.begin(), hull.end(), std::pair(a, b)))
        continue;
      const auto change = [&](std::span<const std::int32_t> now) {
        return static_cast<double>(
            std::abs((std::int64_t{now[a]} - part.measured[a]) - (std::int64_t{now[b]} - part.measured[b])));
      };
      const double limit =
          rows.edge_slope_change * static_cast<double>(std::abs(std::int64_t{part.measured[a]} - part.measured[b]));
      if (!(limit > 1)) continue;  // no room for the margins of the quantum: it counts as flat
      const double most = limit * (1 + 1e-12);
      count += change(height) > most && !(change(part.height) > most) ? 1 : 0;
    }
  return count;
}

}  // namespace

RiverState river_state(const RunContext& context, const Part& part, std::span<const std::int32_t> height) {
  RiverState out;
  const std::vector<std::uint8_t> is_way = way_flags(*context.rivers, part);
  find_edges(*context.rivers, part, is_way, out);
  const RiverConstraints& rows = context.options.rivers.constraints;
  out.invalid = invalid_river_edges(part.position, height, part.triangle, out.edge, rows.flow, rows.valley);
  out.no_valley = invalid_river_edges(part.position, height, part.triangle, out.edge, false, true);
  find_ways(context, part, height, is_way, out);
  out.slopes_beyond_limit = count_slopes(context, part, height, is_way);
  return out;
}

}  // namespace hydrotin
