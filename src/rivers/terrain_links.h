#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/river_network.h"

namespace hydrotin {

/// Corners of the triangles at every vertex (CSR): corner c belongs to triangle c / 3.
struct TerrainLinks {
  std::vector<std::uint32_t> begin;   ///< [n + 1]
  std::vector<std::uint32_t> corner;  ///< [3T] by vertex

  [[nodiscard]] std::span<const std::uint32_t> corners(std::uint32_t v) const {
    return {corner.data() + begin[v], corner.data() + begin[v + 1]};
  }
};

[[nodiscard]] TerrainLinks link_terrain(const RiverTerrain& terrain);

/// The other two corners of the triangle of a corner.
struct Opposite {
  std::uint32_t u, w;
};
[[nodiscard]] inline Opposite opposite(const RiverTerrain& terrain, std::uint32_t corner) {
  const std::uint32_t t = corner - corner % 3;
  return {terrain.triangle[t + (corner + 1) % 3], terrain.triangle[t + (corner + 2) % 3]};
}

/// The wingtips of an edge: none if it is no edge.
struct Wingtips {
  std::uint32_t vertex[2] = {0, 0};
  int count = 0;
};
[[nodiscard]] Wingtips wingtips(const RiverTerrain& terrain, const TerrainLinks& links, std::uint32_t a,
                                std::uint32_t b);

}  // namespace hydrotin
