#include "hydrotin/flow_direction.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace hydrotin {

double height_at(const LatticeTerrain& terrain, Place place, LatticePoint p) {
  if (place.kind == PlaceKind::vertex) return terrain.height[place.id];
  if (place.kind == PlaceKind::triangle) return interpolate(terrain, place.id, p);
  // Along an edge by its ends alone, so that both triangles give the same.
  std::uint32_t a = terrain.origin(place.id), b = terrain.target(place.id);
  if (terrain.position[b] < terrain.position[a]) std::swap(a, b);
  const LatticePoint &from = terrain.position[a], &to = terrain.position[b];
  const double dx = static_cast<double>(to.x) - from.x, dy = static_cast<double>(to.y) - from.y;
  const double share =
      dx > std::abs(dy) ? (static_cast<double>(p.x) - from.x) / dx : (static_cast<double>(p.y) - from.y) / dy;
  return terrain.height[a] + share * (terrain.height[b] - terrain.height[a]);
}

std::vector<double> drops_along(const TerrainLocator& locator, const RiverLines& lines) {
  std::vector<double> drops(lines.size(), 0);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto line = lines.line(i);
    std::size_t first = 0, last = line.size();
    Place start, end;
    while (first < line.size() && (start = locator.locate(line[first])).kind == PlaceKind::outside) ++first;
    while (last > first && (end = locator.locate(line[last - 1])).kind == PlaceKind::outside) --last;
    if (last < first + 2) continue;
    drops[i] = height_at(locator.terrain(), start, line[first]) - height_at(locator.terrain(), end, line[last - 1]);
  }
  return drops;
}

FlowVote vote_on_flow(const TerrainLocator& locator, const RiverLines& lines) {
  FlowVote vote;
  const LineNetworks networks = connect_lines(lines);
  vote.num_networks = networks.num_networks;
  vote.drop = drops_along(locator, lines);
  std::vector<std::uint32_t> order(lines.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto p = lines.line(a), q = lines.line(b);
    return std::tuple(std::min(p.front(), p.back()), std::max(p.front(), p.back()), std::abs(vote.drop[a])) <
           std::tuple(std::min(q.front(), q.back()), std::max(q.front(), q.back()), std::abs(vote.drop[b]));
  });
  std::vector<double> sum(networks.num_networks, 0);
  for (const std::uint32_t i : order) sum[networks.network[i]] += vote.drop[i];
  for (const double s : sum) vote.num_turned += s < 0 ? 1 : 0;
  for (std::uint32_t i = 0; i < lines.size(); ++i) {
    vote.is_turned.push_back(sum[networks.network[i]] < 0 ? 1 : 0);
    if (vote.is_turned[i] != 0 && vote.drop[i] != 0) vote.drop[i] = -vote.drop[i];
    if (vote.drop[i] < 0) vote.disagrees.push_back(i);
  }
  return vote;
}

}  // namespace hydrotin
