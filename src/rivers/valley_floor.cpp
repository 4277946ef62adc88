#include "hydrotin/valley_floor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "exact_edges.h"
#include "river_rows.h"
#include "terrain_links.h"

namespace hydrotin {

std::vector<double> valley_floor(const RiverTerrain& terrain, std::span<const RiverEdge> rivers, double side_slope,
                                 std::span<const double> height) {
  std::vector<double> floor(terrain.num_vertices(), -std::numeric_limits<double>::infinity());
  const TerrainLinks links = link_terrain(terrain);
  for (const auto& [from, to] : rivers) {
    const Wingtips tips = wingtips(terrain, links, from, to);
    const auto &a = terrain.position[from], &b = terrain.position[to];
    for (int i = 0; i < tips.count; ++i) {
      const auto& w = terrain.position[tips.vertex[i]];
      const double x = b[0] - a[0], y = b[1] - a[1], u = w[0] - a[0], v = w[1] - a[1];
      const double size = x * x + y * y, t = (u * x + v * y) / size;
      double level =
          height[from] + t * (height[to] - height[from]) + side_slope * std::abs(x * v - y * u) / std::sqrt(size);
      double step = std::numeric_limits<double>::epsilon() * std::max(std::abs(level), 1e-300);
      while (valley_sign(a, b, w, height[from], height[to], level) < 0) {
        level += step;
        step *= 2;
      }
      floor[tips.vertex[i]] = std::max(floor[tips.vertex[i]], level);
    }
  }
  return floor;
}

std::vector<BindingLimit> binding_limits(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                         const RiverConstraints& constraints, std::span<const double> height,
                                         double tolerance, double quantum) {
  std::vector<double> d(height.size());
  for (std::size_t v = 0; v < d.size(); ++v) d[v] = height[v] - terrain.height[v];
  const RowCatalog catalog(terrain, rivers, constraints, quantum);
  tolerance += quantum;  // what rounding may have taken from a row that had no room
  std::vector<BindingLimit> limits;
  catalog.visit_all(d, [&](const Row& row) {
    if (row.kind != RowKind::slope_limit && row.kind != RowKind::triangle_slope) return;
    if (row.violation(d) < -tolerance) return;
    limits.push_back({row.kind, false, {row.vertex.begin(), row.vertex.begin() + row.size}});
  });
  for (std::uint32_t v = 0; constraints.max_change > 0 && v < d.size(); ++v)
    if (std::abs(d[v]) >= constraints.max_change - tolerance) limits.push_back({RowKind::flow, true, {v}});
  const auto key = [&](const BindingLimit& limit) {
    std::vector<std::array<double, 2>> place;
    for (const std::uint32_t v : limit.vertex) place.push_back(terrain.position[v]);
    return std::tuple(limit.is_largest_change, limit.kind, place);
  };
  std::sort(limits.begin(), limits.end(),
            [&](const BindingLimit& a, const BindingLimit& b) { return key(a) < key(b); });
  const auto same = [](const BindingLimit& a, const BindingLimit& b) {
    return a.kind == b.kind && a.vertex == b.vertex && a.is_largest_change == b.is_largest_change;
  };
  limits.erase(std::unique(limits.begin(), limits.end(), same), limits.end());
  return limits;
}

std::uint64_t count_beyond_slope_limit(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                       const RiverConstraints& constraints, std::span<const double> height,
                                       double tolerance) {
  RiverConstraints limits = constraints;
  limits.limit_edge_slope = true;
  limits.directions.clear();
  std::vector<double> d(height.size());
  for (std::size_t v = 0; v < d.size(); ++v) d[v] = height[v] - terrain.height[v];
  const RowCatalog catalog(terrain, rivers, limits, 0);
  std::vector<std::uint64_t> beyond;
  catalog.visit_all(d, [&](const Row& row) {
    if (row.kind == RowKind::slope_limit && row.violation(d) > tolerance) beyond.push_back(row.key);
  });
  std::sort(beyond.begin(), beyond.end());
  return static_cast<std::uint64_t>(std::unique(beyond.begin(), beyond.end()) - beyond.begin());
}

}  // namespace hydrotin
