#include "embed_fill.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "fill_terrain.h"
#include "hydrotin/lifting.h"
#include "hydrotin/pit_removal.h"
#include "hydrotin/pits.h"
#include "hydrotin/valley_floor.h"

namespace hydrotin::app {
namespace {

void set_heights(Mesh& mesh, const std::vector<double>& height) {
  for (std::size_t v = 0; v < height.size(); ++v) mesh.vertex[v][2] = height[v];
}

/// Lifts by comparisons alone: exact whatever the heights are.
void lift_all(Mesh& mesh, const FillTerrain& terrain, const std::vector<std::uint8_t>& is_outlet) {
  const RankedHeights ranked = rank_heights(mesh);
  const auto level = lift(terrain.graph, ranked.height, is_outlet);
  for (std::size_t v = 0; v < level.size(); ++v)
    if (level[v] != ranked.height[v] && level[v] != kNoLevel)
      mesh.vertex[v][2] = ranked.level[static_cast<std::size_t>(level[v])];
}

/// Vertices of rivers, outlet chains and lakes: they stay.
std::vector<std::uint8_t> way_vertices(const EmbedInput& input, const RiverConstraints& constraints) {
  std::vector<std::uint8_t> is_way(input.position.size(), 0);
  for (const auto* edges : {&input.rivers, &input.mouths.edge})
    for (const auto& [from, to] : *edges) is_way[from] = is_way[to] = 1;
  for (const Lake& lake : constraints.lakes)
    for (const std::uint32_t v : lake.vertex) is_way[v] = 1;
  return is_way;
}

/// Raises and lowers, within what the rivers leave open.
void change_least(Mesh& mesh, const FillTerrain& terrain, const EmbedInput& input,
                  const std::vector<std::uint8_t>& is_way, const std::vector<double>& floor) {
  const std::size_t n = terrain.height.size();
  const auto level = lift(terrain.graph, terrain.height, input.is_outlet);
  std::vector<std::int32_t> lower(n, std::numeric_limits<std::int32_t>::min());
  std::vector<std::int32_t> upper(n, kNoLevel - 1);
  for (std::size_t v = 0; v < n; ++v) {
    if (std::isfinite(floor[v])) {
      const double least =
          std::ceil(floor[v] * static_cast<double>(terrain.denominator)) - static_cast<double>(terrain.base);
      lower[v] = least <= -2147483648.0             ? std::numeric_limits<std::int32_t>::min()
                 : least >= terrain.height[v] + 0.0 ? terrain.height[v]
                                                    : static_cast<std::int32_t>(least);
    }
    if (is_way[v] != 0) {
      lower[v] = terrain.height[v];
      upper[v] = level[v] == kNoLevel ? terrain.height[v] : level[v];
    }
  }
  const ChangeableTerrain changeable{&terrain.graph, terrain.height, terrain.position, input.is_outlet, {},
                                     lower,          upper};
  const Removal removal = remove_pits_by_best_search(changeable, {});
  std::map<std::int32_t, double> value;  // heights of the mesh at each level: the highest of those rounded to it
  for (std::size_t v = 0; v < n && !terrain.is_exact; ++v) {
    const auto [at, is_new] = value.emplace(terrain.height[v], mesh.vertex[v][2]);
    if (!is_new) at->second = std::max(at->second, mesh.vertex[v][2]);
  }
  for (std::size_t v = 0; v < n; ++v) {
    if (removal.height[v] == terrain.height[v] || is_way[v] != 0) continue;
    const auto at = value.find(removal.height[v]);
    const double z = at != value.end() ? at->second : terrain.z(removal.height[v]);
    // A rounding error below what a valley asks: the height that the embedding gave is enough.
    mesh.vertex[v][2] = z < floor[v] ? std::max(z, std::min(mesh.vertex[v][2], floor[v])) : z;
  }
}

}  // namespace

RiverFill fill_rivers(const std::string& method, const EmbedInput& input, const RiverConstraints& constraints,
                      const std::vector<double>& embedded, double tolerance) {
  Mesh mesh = input.mesh;
  set_heights(mesh, embedded);
  const FillTerrain terrain = make_fill_terrain("the embedded TIN", mesh);
  const auto is_way = way_vertices(input, constraints);
  RiverFill fill;
  fill.pits_before = count_pits(terrain.graph, rank_heights(mesh).height, input.is_outlet);
  if (method == "least-change") {
    const auto floor = constraints.valley
                           ? valley_floor(input.terrain(), input.rivers, constraints.side_slope, embedded)
                           : std::vector<double>(embedded.size(), -std::numeric_limits<double>::infinity());
    change_least(mesh, terrain, input, is_way, floor);
  }
  lift_all(mesh, terrain, input.is_outlet);
  fill.pits_after = count_pits(terrain.graph, rank_heights(mesh).height, input.is_outlet);
  for (std::size_t v = 0; v < embedded.size(); ++v) {
    fill.height.push_back(mesh.vertex[v][2]);
    const double moved = std::abs(fill.height[v] - embedded[v]);
    if (moved == 0) continue;
    ++fill.moved;
    fill.river_vertices_moved += is_way[v];
    fill.total += moved;
    fill.largest = std::max(fill.largest, moved);
  }
  fill.slopes_beyond_limit =
      count_beyond_slope_limit(input.terrain(), input.rivers, constraints, fill.height, std::max(tolerance, 1e-9));
  return fill;
}

}  // namespace hydrotin::app
