#include "terrain_links.h"

#include <algorithm>
#include <numeric>

namespace hydrotin {

TerrainLinks link_terrain(const RiverTerrain& terrain) {
  TerrainLinks links;
  links.begin.assign(std::size_t{terrain.num_vertices()} + 1, 0);
  for (const std::uint32_t v : terrain.triangle) ++links.begin[v + 1];
  std::partial_sum(links.begin.begin(), links.begin.end(), links.begin.begin());
  links.corner.resize(terrain.triangle.size());
  std::vector<std::uint32_t> next(links.begin.begin(), links.begin.end() - 1);
  for (std::uint32_t c = 0; c < terrain.triangle.size(); ++c) links.corner[next[terrain.triangle[c]]++] = c;
  return links;
}

Wingtips wingtips(const RiverTerrain& terrain, const TerrainLinks& links, std::uint32_t a, std::uint32_t b) {
  Wingtips found;
  for (const std::uint32_t corner : links.corners(a)) {
    const auto [u, w] = opposite(terrain, corner);
    if ((u == b || w == b) && found.count < 2) found.vertex[found.count++] = u == b ? w : u;
  }
  if (found.count == 2 && terrain.position[found.vertex[1]] < terrain.position[found.vertex[0]])
    std::swap(found.vertex[0], found.vertex[1]);
  return found;
}

}  // namespace hydrotin
