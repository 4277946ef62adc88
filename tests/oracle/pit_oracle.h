#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "oracle/terrain_oracle.h"

/// The water in a pit from its definition.
namespace hydrotin::oracle {

/// The vertices connected to `start` through vertices that `may` allows.
template <class May>
std::set<std::uint32_t> connected(const Neighbors& around, std::uint32_t start, May may) {
  std::set<std::uint32_t> reached{start};
  for (bool grown = true; grown;) {
    grown = false;
    const std::set<std::uint32_t> before = reached;
    for (const std::uint32_t v : before)
      for (const std::uint32_t w : around[v])
        if (may(w)) grown |= reached.insert(w).second;
  }
  return reached;
}

struct Basin {
  std::uint32_t spill_vertex = 0xffffffffu;
  std::int32_t spill_level = 0;
  std::set<std::uint32_t> vertices;
  bool has_parent = false;
  std::uint32_t parent = 0;  ///< vertex
};

/// Raises the water vertex by vertex in the order (z, x, y) until it finds an outlet or a vertex before the bottom.
inline Basin basin(const Neighbors& around, const std::vector<std::int32_t>& height,
                   const std::vector<LatticePoint>& position, const std::vector<std::uint8_t>& is_outlet,
                   std::uint32_t bottom) {
  const auto key = [&](std::uint32_t v) { return std::pair(height[v], position[v]); };
  std::vector<std::uint32_t> order;
  for (std::uint32_t v = 0; v < height.size(); ++v)
    if (key(v) >= key(bottom)) order.push_back(v);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  Basin result;
  std::set<std::uint32_t> pool;
  for (const std::uint32_t top : order) {
    const auto reached = connected(around, bottom, [&](std::uint32_t v) { return key(v) <= key(top); });
    std::uint32_t lowest = bottom;
    bool drains = false;
    for (const std::uint32_t v : reached) {
      if (key(v) < key(lowest)) lowest = v;
      drains |= is_outlet[v] != 0;
    }
    if (drains || lowest != bottom) {
      result.spill_vertex = top;
      result.spill_level = height[top];
      for (const std::uint32_t v : pool)
        if (height[v] < height[top]) result.vertices.insert(v);
      result.has_parent = !drains;
      result.parent = lowest;
      return result;
    }
    pool = reached;
  }
  return result;
}

/// Area of a triangle below a level and volume of the water on it, by clipping.
inline std::pair<double, double> water_on(const std::array<LatticePoint, 3>& corner,
                                          const std::array<std::int32_t, 3>& height, double level) {
  struct P {
    double x, y, z;
  };
  if (height[0] == level && height[1] == level && height[2] == level) return {0, 0};
  std::vector<P> inside;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const P a{double(corner[i].x), double(corner[i].y), double(height[i])},
        b{double(corner[j].x), double(corner[j].y), double(height[j])};
    if (a.z <= level) inside.push_back(a);
    if ((a.z < level && b.z > level) || (a.z > level && b.z < level)) {
      const double s = (level - a.z) / (b.z - a.z);
      inside.push_back({a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), level});
    }
  }
  double area = 0, volume = 0;
  for (std::size_t i = 1; i + 1 < inside.size(); ++i) {
    const P &a = inside[0], &b = inside[i], &c = inside[i + 1];
    const double piece = std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
    area += piece;
    volume += piece * (level - (a.z + b.z + c.z) / 3);
  }
  return {area, volume};
}

}  // namespace hydrotin::oracle
