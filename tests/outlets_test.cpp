#include "hydrotin/outlets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "grid_terrain.h"
#include "oracle/pit_oracle.h"

namespace hydrotin {
namespace {

using testing::make_outlet_terrain;

bool contains(const std::vector<LatticePoint>& position, const std::uint32_t* t, double x, double y) {
  int left = 0, right = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const LatticePoint a = position[t[i]], b = position[t[(i + 1) % 3]];
    const double side = (double(b.x) - a.x) * (y - a.y) - (double(b.y) - a.y) * (x - a.x);
    left += side > 0;
    right += side < 0;
  }
  return left == 0 || right == 0;
}

bool crosses(const std::vector<LatticePoint>& position, std::uint32_t u, std::uint32_t v, double ax, double ay,
             double bx, double by) {
  const auto side = [](double px, double py, double qx, double qy, double x, double y) {
    return (qx - px) * (y - py) - (qy - py) * (x - px) > 0;
  };
  const double ux = position[u].x, uy = position[u].y, vx = position[v].x, vy = position[v].y;
  return side(ux, uy, vx, vy, ax, ay) != side(ux, uy, vx, vy, bx, by) &&
         side(ax, ay, bx, by, ux, uy) != side(ax, ay, bx, by, vx, vy);
}

// The outside is what can be reached from far away over a fine raster of points without entering a triangle; a vertex
// of the terrain is on the hull of some piece if such a point is close to it.
TEST(Outlets, HullIsWhatTheOutsideTouches) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    auto grid = make_outlet_terrain(seed).grid;
    if (grid.columns > 6 || grid.rows > 6) continue;
    for (std::uint32_t i = 0; i < grid.at.size(); ++i)  // no jitter: holes are seen by a raster
      grid.position[grid.at[i]] = {static_cast<std::int32_t>(i % grid.columns * 10),
                                   static_cast<std::int32_t>(i / grid.columns * 10)};
    const VertexGraph graph = make_vertex_graph(grid.num_vertices(), grid.triangle);
    const auto closed = hull_outlets(graph, grid.position, VoidOutlets::closed);
    const auto draining = hull_outlets(graph, grid.position, VoidOutlets::draining);
    // Raster points at odd multiples of 1/4 + tiny offsets avoid edges; the raster starts one cell outside.
    const int step = 8, width = (static_cast<int>(grid.columns) + 1) * step,
              rows = (static_cast<int>(grid.rows) + 1) * step;
    const auto x_of = [&](int i) { return -10 + (i + 0.47) * 10.0 / step; };
    const auto y_of = [&](int j) { return -10 + (j + 0.53) * 10.0 / step; };
    std::vector<int> state(static_cast<std::size_t>(width * rows), 0);  // 0 free, 1 inside, 2 outside
    const auto at = [&](int i, int j) -> int& { return state[static_cast<std::size_t>(j * width + i)]; };
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < width; ++i)
        for (std::size_t t = 0; t < grid.triangle.size() && at(i, j) == 0; t += 3)
          if (contains(grid.position, &grid.triangle[t], x_of(i), y_of(j))) at(i, j) = 1;
    std::vector<std::pair<int, int>> open{{0, 0}};
    at(0, 0) = 2;
    while (!open.empty()) {
      const auto [i, j] = open.back();
      open.pop_back();
      for (const auto& [a, b] : {std::pair(i + 1, j), {i - 1, j}, {i, j + 1}, {i, j - 1}}) {
        if (a < 0 || b < 0 || a >= width || b >= rows || at(a, b) != 0) continue;
        bool is_free = true;
        for (std::size_t c = 0; c < grid.triangle.size(); ++c)
          is_free &= !crosses(grid.position, grid.triangle[c], grid.triangle[c - c % 3 + (c + 1) % 3], x_of(i), y_of(j),
                              x_of(a), y_of(b));
        if (!is_free) continue;
        at(a, b) = 2;
        open.emplace_back(a, b);
      }
    }
    for (std::uint32_t v = 0; v < grid.num_vertices(); ++v) {
      bool sees_outside = false, sees_free = false;
      for (int j = 0; j < rows; ++j)
        for (int i = 0; i < width; ++i) {
          const double dx = x_of(i) - grid.position[v].x, dy = y_of(j) - grid.position[v].y;
          if (dx * dx + dy * dy > 16) continue;  // nearer than any side opposite v
          sees_outside |= at(i, j) == 2;
          sees_free |= at(i, j) != 1;
        }
      EXPECT_EQ(closed[v] != 0, sees_outside) << v;
      EXPECT_EQ(draining[v] != 0, sees_free) << v;
    }
  }
}

TEST(Outlets, PiecesAndTheirLowest) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const auto terrain = make_outlet_terrain(seed);
    const auto& grid = terrain.grid;
    const VertexGraph graph = make_vertex_graph(grid.num_vertices(), grid.triangle);
    const auto around = oracle::neighbors(grid.num_vertices(), grid.triangle);
    const auto piece = pieces_of(graph, grid.position);
    const auto lowest = lowest_outlets(graph, grid.height, grid.position);
    const auto dry = pieces_without_outlet(graph, grid.position, terrain.is_outlet);
    std::set<std::pair<LatticePoint, std::uint32_t>> expected_dry;
    for (std::uint32_t v = 0; v < grid.num_vertices(); ++v) {
      const auto all = oracle::connected(around, v, [](std::uint32_t) { return true; });
      std::uint32_t best = v, first = v;
      bool drains = false;
      for (std::uint32_t w = 0; w < grid.num_vertices(); ++w) EXPECT_EQ(piece[v] == piece[w], all.contains(w));
      for (const std::uint32_t w : all) {
        if (std::tie(grid.height[w], grid.position[w]) < std::tie(grid.height[best], grid.position[best])) best = w;
        if (grid.position[w] < grid.position[first]) first = w;
        drains |= terrain.is_outlet[w] != 0;
      }
      EXPECT_EQ(lowest[v] != 0, best == v);
      if (!drains) expected_dry.insert({grid.position[first], first});
    }
    ASSERT_EQ(dry.size(), expected_dry.size());
    std::size_t i = 0;
    for (const auto& [p, v] : expected_dry) EXPECT_EQ(dry[i++], v);
    EXPECT_TRUE(pieces_without_outlet(graph, grid.position, lowest).empty());
    EXPECT_TRUE(
        pieces_without_outlet(graph, grid.position, hull_outlets(graph, grid.position, VoidOutlets::closed)).empty());
  }
}

}  // namespace
}  // namespace hydrotin
