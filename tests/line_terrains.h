#pragma once

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "hydrotin/lattice_terrain.h"
#include "hydrotin/river_lines.h"
#include "hydrotin/triangulation.h"

/// Terrains and river lines on the lattice for tests.
namespace hydrotin::testing {

/// A Delaunay terrain of n points, `spread` units wide; on a coarse grid if asked; with holes: triangles left out.
inline LatticeTerrain lattice_terrain(std::uint32_t seed, std::uint32_t n, std::int32_t spread, bool grid, bool holes,
                                      LatticePoint origin = {0, 0}) {
  std::mt19937 random(seed);
  std::set<LatticePoint> places;
  const std::int32_t step = grid ? std::max(1, spread / 8) : 1;
  n = grid ? std::min(n, 50u) : n;
  while (places.size() < n) {
    const auto pick = [&] { return static_cast<std::int32_t>(random() % static_cast<unsigned>(spread / step)) * step; };
    const std::int32_t x = pick(), y = pick();
    places.insert({origin.x + x, origin.y + y});
  }
  std::vector<LatticePoint> points(places.begin(), places.end());
  std::shuffle(points.begin(), points.end(), random);
  const Triangulation of = delaunay(points);
  LatticeTerrain terrain;
  terrain.position = of.position;
  for (std::size_t v = 0; v < terrain.position.size(); ++v)
    terrain.height.push_back(static_cast<double>(random() % 1000) / 10);
  for (std::size_t t = 0; t < of.origin.size(); t += 3) {
    if (holes && random() % 6 == 0) continue;
    for (std::size_t i = 0; i < 3; ++i) terrain.triangle.push_back(of.origin[t + i].value);
  }
  link_twins(terrain);
  return terrain;
}

/// Random chains, some through vertices of the terrain and along its edges, some outside, with repeats and spikes.
inline RiverLines random_lines(const LatticeTerrain& terrain, std::uint32_t seed, std::uint32_t count,
                               std::int32_t spread, LatticePoint origin = {0, 0}) {
  std::mt19937 random(seed + 99);
  RiverLines lines;
  std::vector<LatticePoint> used;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::vector<LatticePoint> chain;
    const std::uint32_t length = 2 + static_cast<std::uint32_t>(random() % 6);
    while (chain.size() < length) {
      const auto pick = [&] {
        return static_cast<std::int32_t>(random() % static_cast<unsigned>(3 * spread / 2)) - spread / 4;
      };
      LatticePoint p{origin.x, origin.y};
      p.x += pick();
      p.y += pick();
      switch (random() % 6) {
        case 0:
        case 1:
          p = terrain.position[random() % terrain.position.size()];
          break;
        case 2:
          if (!used.empty()) p = used[random() % used.size()];
          break;
        case 3:
          if (!chain.empty()) p = chain[random() % chain.size()];
          break;
        default:
          break;
      }
      chain.push_back(p);
    }
    if (random() % 5 == 0 && !terrain.triangle.empty()) {  // along an edge
      const std::size_t t = random() % (terrain.triangle.size() / 3) * 3;
      chain.push_back(terrain.position[terrain.triangle[t]]);
      chain.push_back(terrain.position[terrain.triangle[t + 1]]);
    }
    used.insert(used.end(), chain.begin(), chain.end());
    lines.add(chain, i);
  }
  return lines;
}

}  // namespace hydrotin::testing
