#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include "hydrotin/river_network.h"
#include "hydrotin/triangulation.h"

/// Small terrains with river edges for tests.
namespace hydrotin::testing {

struct TestTerrain {
  std::vector<std::array<double, 2>> position;
  std::vector<double> height;
  std::vector<std::uint32_t> triangle;
  std::vector<RiverEdge> rivers;

  [[nodiscard]] RiverTerrain view() const { return {position, height, triangle}; }
};

/// A Delaunay terrain of n points at centimetres with heights of full centimetres; on a lattice of whole metres if
/// asked.
inline TestTerrain random_terrain(std::uint32_t seed, std::uint32_t n, bool lattice) {
  std::mt19937 random(seed);
  std::set<LatticePoint> places;
  while (places.size() < n) {
    const auto pick = [&] {
      return lattice ? static_cast<std::int32_t>(random() % 8) * 100 : static_cast<std::int32_t>(random() % 1000);
    };
    const std::int32_t x = pick(), y = pick();
    places.insert({x, y});
  }
  std::vector<LatticePoint> points(places.begin(), places.end());
  std::shuffle(points.begin(), points.end(), random);
  const Triangulation delaunay_of = delaunay(points);
  TestTerrain terrain;
  for (const auto& p : delaunay_of.position) {
    terrain.position.push_back({p.x / 100.0, p.y / 100.0});
    terrain.height.push_back(static_cast<double>(random() % (lattice ? 5 : 500)) / (lattice ? 1 : 100));
  }
  for (const VertexId v : delaunay_of.origin) terrain.triangle.push_back(v.value);
  return terrain;
}

inline std::vector<std::vector<std::uint32_t>> neighbors_of(const TestTerrain& terrain) {
  std::vector<std::set<std::uint32_t>> sets(terrain.position.size());
  for (std::size_t t = 0; t < terrain.triangle.size(); t += 3)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        if (i != j) sets[terrain.triangle[t + i]].insert(terrain.triangle[t + j]);
  std::vector<std::vector<std::uint32_t>> lists;
  for (const auto& s : sets) lists.emplace_back(s.begin(), s.end());
  return lists;
}

/// Random walks that end at a vertex seen before: forests. With `clean` no triangle has three river vertices or two
/// that no river edge joins.
inline void add_rivers(TestTerrain& terrain, std::uint32_t seed, std::uint32_t walks, std::uint32_t longest,
                       bool clean) {
  std::mt19937 random(seed + 77777);
  const auto links = neighbors_of(terrain);
  std::vector<std::uint8_t> used(terrain.position.size(), 0);
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  const auto fits = [&](std::uint32_t from, std::uint32_t to) {
    if (!clean) return true;
    for (const std::uint32_t w : links[from])  // the new vertex may touch the network only at the vertex it drains to
      if (w != to && used[w] != 0) return false;
    return true;
  };
  for (std::uint32_t walk = 0; walk < walks; ++walk) {
    // Upstream from a mouth: either fresh or on the network.
    std::uint32_t v = static_cast<std::uint32_t>(random() % terrain.position.size());
    if (used[v] == 0) {
      bool touches = false;
      for (const std::uint32_t w : links[v]) touches = touches || used[w] != 0;
      if (clean && touches) continue;
    }
    for (std::uint32_t step = 0; step < longest; ++step) {
      std::vector<std::uint32_t> choice;
      for (const std::uint32_t w : links[v])
        if (used[w] == 0 && fits(w, v)) choice.push_back(w);
      if (choice.empty()) break;
      const std::uint32_t up = choice[random() % choice.size()];
      used[v] = used[up] = 1;
      edges.insert({up, v});
      v = up;
    }
  }
  for (const auto& [from, to] : edges) terrain.rivers.push_back({from, to});
  std::shuffle(terrain.rivers.begin(), terrain.rivers.end(), random);
}

}  // namespace hydrotin::testing
