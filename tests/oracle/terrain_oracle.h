#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "hydrotin/lattice.h"

/// Slow, obvious answers for the terrain room, written from the definitions.
namespace hydrotin::oracle {

using Neighbors = std::vector<std::set<std::uint32_t>>;

inline Neighbors neighbors(std::size_t num_vertices, const std::vector<std::uint32_t>& triangle) {
  Neighbors result(num_vertices);
  for (std::size_t t = 0; t < triangle.size(); t += 3)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        if (i != j) result[triangle[t + i]].insert(triangle[t + j]);
  return result;
}

inline std::set<std::pair<std::uint32_t, std::uint32_t>> edges_without_twin(
    const std::vector<std::uint32_t>& triangle) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> all, single;
  for (std::size_t t = 0; t < triangle.size(); t += 3)
    for (std::size_t i = 0; i < 3; ++i) all.insert({triangle[t + i], triangle[t + (i + 1) % 3]});
  for (const auto& [a, b] : all)
    if (!all.contains({b, a})) single.insert({a, b});
  return single;
}

/// The greatest solution of f(v) = max(h(v), min f(neighbours)), f = h at outlets, by iterating down from infinity.
inline std::vector<std::int32_t> lift(const Neighbors& around, const std::vector<std::int32_t>& height,
                                      const std::vector<std::uint8_t>& is_outlet) {
  std::vector<std::int32_t> level(height.size(), std::numeric_limits<std::int32_t>::max());
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t v = 0; v < height.size(); ++v) {
      std::int32_t best = is_outlet[v] ? height[v] : std::numeric_limits<std::int32_t>::max();
      for (const std::uint32_t w : around[v]) best = std::min(best, std::max(height[v], level[w]));
      if (best < level[v]) {
        level[v] = best;
        changed = true;
      }
    }
  }
  return level;
}

struct Pit {
  LatticePoint representative;
  std::uint32_t vertex;
  std::int32_t height;
  std::size_t num_vertices;
  friend auto operator<=>(const Pit&, const Pit&) = default;
};

/// Maximal connected sets of equal height without a lower neighbour and without an outlet: the set of a vertex is grown
/// by repeated sweeps over all vertices.
inline std::vector<Pit> pits(const Neighbors& around, const std::vector<std::int32_t>& height,
                             const std::vector<LatticePoint>& position, const std::vector<std::uint8_t>& is_outlet) {
  std::set<Pit> result;
  for (std::uint32_t seed = 0; seed < height.size(); ++seed) {
    std::set<std::uint32_t> plateau{seed};
    bool is_pit = true;
    for (bool grown = true; grown;) {
      grown = false;
      const std::set<std::uint32_t> before = plateau;
      for (const std::uint32_t v : before) {
        if (is_outlet[v]) is_pit = false;
        for (const std::uint32_t w : around[v]) {
          if (height[w] < height[v]) is_pit = false;
          if (height[w] == height[v] && plateau.insert(w).second) grown = true;
        }
      }
    }
    if (!is_pit) continue;
    Pit pit{position[seed], seed, height[seed], plateau.size()};
    for (const std::uint32_t v : plateau)
      if (position[v] < pit.representative) pit.representative = position[v], pit.vertex = v;
    result.insert(pit);
  }
  return {result.begin(), result.end()};
}

}  // namespace hydrotin::oracle
