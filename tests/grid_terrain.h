#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "clouds.h"
#include "hydrotin/lattice.h"

/// Triangulated grids with random diagonals: terrains for tests that need no Delaunay triangulation.
namespace hydrotin::testing {

struct GridTerrain {
  std::vector<LatticePoint> position;   ///< [n]
  std::vector<std::int32_t> height;     ///< [n]
  std::vector<std::uint32_t> triangle;  ///< [3T] counter-clockwise
  std::uint32_t columns = 0, rows = 0;
  std::vector<std::uint32_t> at;  ///< [columns * rows] vertex of a node of the grid, row by row from the bottom

  [[nodiscard]] std::uint32_t num_vertices() const { return static_cast<std::uint32_t>(position.size()); }
  [[nodiscard]] std::size_t num_triangles() const { return triangle.size() / 3; }
};

inline std::int64_t doubled_area(LatticePoint a, LatticePoint b, LatticePoint c) {
  return (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y) - (std::int64_t{b.y} - a.y) * (std::int64_t{c.x} - a.x);
}

/// A grid of columns x rows nodes `spacing` apart, moved by up to `jitter`; all heights 0. Vertices and triangles
/// follow the Z-order curve of the grid.
inline GridTerrain make_grid(std::uint64_t seed, std::uint32_t columns, std::uint32_t rows, std::int32_t spacing,
                             std::int32_t jitter) {
  const auto spread = [](std::uint64_t v) {
    std::uint64_t s = 0;
    for (int bit = 0; bit < 20; ++bit) s |= ((v >> bit) & 1) << (2 * bit);
    return s;
  };
  const std::size_t n = std::size_t{columns} * rows;
  std::vector<std::uint64_t> column_key(columns), row_key(rows);
  for (std::uint32_t c = 0; c < columns; ++c) column_key[c] = spread(c);
  for (std::uint32_t r = 0; r < rows; ++r) row_key[r] = spread(r) << 1;
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return (column_key[a % columns] | row_key[a / columns]) < (column_key[b % columns] | row_key[b / columns]);
  });

  Random random(seed ^ 0xdeadu);
  GridTerrain grid;
  grid.columns = columns;
  grid.rows = rows;
  grid.position.resize(n);
  grid.height.assign(n, 0);
  grid.at.resize(n);
  for (std::uint32_t v = 0; v < n; ++v) {
    const auto c = static_cast<std::int32_t>(order[v] % columns), r = static_cast<std::int32_t>(order[v] / columns);
    grid.at[order[v]] = v;
    grid.position[v] = {c * spacing + random.between(-jitter, jitter), r * spacing + random.between(-jitter, jitter)};
  }
  grid.triangle.reserve(6 * n);
  const auto area = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return doubled_area(grid.position[a], grid.position[b], grid.position[c]);
  };
  for (std::uint32_t v = 0; v < n; ++v) {
    const std::uint32_t c = order[v] % columns, r = order[v] / columns;
    if (c + 1 == columns || r + 1 == rows) continue;
    const std::uint32_t sw = v, se = grid.at[order[v] + 1], nw = grid.at[order[v] + columns],
                        ne = grid.at[order[v] + columns + 1];
    const bool rising = area(sw, se, ne) > 0 && area(sw, ne, nw) > 0;
    const bool falling = area(sw, se, nw) > 0 && area(se, ne, nw) > 0;
    if (rising && (!falling || random.below(2) == 0))
      grid.triangle.insert(grid.triangle.end(), {sw, se, ne, sw, ne, nw});
    else
      grid.triangle.insert(grid.triangle.end(), {sw, se, nw, se, ne, nw});
  }
  return grid;
}

/// Flags of the vertices on the outside of the grid.
inline std::vector<std::uint8_t> hull_flags(const GridTerrain& grid) {
  std::vector<std::uint8_t> flag(grid.num_vertices(), 0);
  for (std::uint32_t i = 0; i < grid.at.size(); ++i) {
    const std::uint32_t c = i % grid.columns, r = i / grid.columns;
    flag[grid.at[i]] = c == 0 || r == 0 || c + 1 == grid.columns || r + 1 == grid.rows;
  }
  return flag;
}

/// A small terrain with outlets, of a kind that depends on the seed: flat, full of ties or hilly; whole, with holes or
/// in pieces; outlets at the hull, at one lowest vertex, at several global minima, at random vertices or nowhere.
struct OutletTerrain {
  GridTerrain grid;
  std::vector<std::uint8_t> is_outlet;
};

inline OutletTerrain make_outlet_terrain(std::uint64_t seed) {
  Random random(seed ^ 0x0ddba11u);
  OutletTerrain terrain;
  GridTerrain& grid = terrain.grid;
  grid = make_grid(seed, 2 + random.below(9), 2 + random.below(9), 10, random.below(2) == 0 ? 0 : 4);
  const std::uint32_t n = grid.num_vertices();
  constexpr std::int32_t kRanges[] = {1, 2, 3, 5, 9, 1000};
  grid.height = random.below(7) == 0 ? relief_heights(seed, grid.position, 40, 30)
                                     : random_heights(seed, n, kRanges[random.below(6)]);
  if (random.below(3) == 0)
    for (auto& z : grid.height) z -= 4;
  if (random.below(3) == 0) {  // holes, pieces, vertices of no triangle
    std::vector<std::uint32_t> kept;
    const std::uint32_t percent = random.below(100);
    for (std::size_t t = 0; t < grid.triangle.size(); t += 3)
      if (random.below(100) < percent) kept.insert(kept.end(), &grid.triangle[t], &grid.triangle[t] + 3);
    grid.triangle = kept;
  }
  terrain.is_outlet.assign(n, 0);
  const std::int32_t lowest = *std::min_element(grid.height.begin(), grid.height.end());
  switch (random.below(5)) {
    case 0:
      terrain.is_outlet = hull_flags(grid);
      break;
    case 1:
      terrain.is_outlet[random.below(n)] = 1;
      break;
    case 2:
      for (std::uint32_t v = 0; v < n; ++v) terrain.is_outlet[v] = grid.height[v] == lowest;
      break;
    case 3:
      for (auto& flag : terrain.is_outlet) flag = random.below(10) == 0;
      break;
    default:
      break;
  }
  return terrain;
}

}  // namespace hydrotin::testing
