#include <benchmark/benchmark.h>

#include <cstdint>
#include <functional>
#include <queue>
#include <vector>

#include "grid_terrain.h"
#include "hydrotin/lifting.h"
#include "hydrotin/vertex_graph.h"

// Speed of the terrain room, one thread, items = vertices or triangles. Arguments: side of the square grid (n =
// side^2), noise in lattice units (0: drained hills with few pits, 200: heavily pitted).

namespace hydrotin::testing {
namespace {

struct Scene {
  GridTerrain grid;
  VertexGraph graph;
  std::vector<std::uint8_t> hull;
};

const Scene& scene(std::int64_t side, std::int64_t noise) {
  static Scene s;
  static std::int64_t made_side = 0, made_noise = -1;
  if (side != made_side || noise != made_noise) {
    const auto length = static_cast<std::uint32_t>(side);
    s.grid = make_grid(1, length, length, 100, 30);
    s.grid.height = relief_heights(1, s.grid.position, 30000, 30000, static_cast<std::int32_t>(noise));
    s.graph = make_vertex_graph(s.grid.num_vertices(), s.grid.triangle);
    s.hull = hull_flags(s.grid);
    made_side = side;
    made_noise = noise;
  }
  return s;
}

void set_vertices(benchmark::State& state, const Scene& s) {
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * s.grid.num_vertices());
}

// The peer: a plain flood with a heap for what lies above the water and a stack for what lies below.
std::vector<std::int32_t> plain_flood(const Scene& s) {
  const std::uint32_t n = s.grid.num_vertices();
  std::vector<std::int32_t> level(n, kNoLevel);
  using Entry = std::pair<std::int32_t, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> heap;
  std::vector<std::uint32_t> pit;
  for (std::uint32_t v = 0; v < n; ++v)
    if (s.hull[v]) heap.emplace(level[v] = s.grid.height[v], v);
  while (!heap.empty() || !pit.empty()) {
    std::uint32_t v;
    if (!pit.empty()) {
      v = pit.back();
      pit.pop_back();
    } else {
      v = heap.top().second;
      heap.pop();
    }
    for (const std::uint32_t w : s.graph.neighbors(v)) {
      if (level[w] != kNoLevel) continue;
      if (s.grid.height[w] <= level[v]) {
        level[w] = level[v];
        pit.push_back(w);
      } else {
        level[w] = s.grid.height[w];
        heap.emplace(level[w], w);
      }
    }
  }
  return level;
}

void BM_plain_flood(benchmark::State& state) {
  const Scene& s = scene(state.range(0), state.range(1));
  for (auto _ : state) benchmark::DoNotOptimize(plain_flood(s));
  set_vertices(state, s);
}

void BM_lift(benchmark::State& state) {
  const Scene& s = scene(state.range(0), state.range(1));
  for (auto _ : state) benchmark::DoNotOptimize(lift(s.graph, s.grid.height, s.hull));
  set_vertices(state, s);
}

void BM_lift_lowest(benchmark::State& state) {
  const Scene& s = scene(state.range(0), state.range(1));
  std::vector<std::uint8_t> outlet(s.grid.num_vertices(), 0);
  outlet[lowest_vertex(s.grid.height, s.grid.position)] = 1;
  for (auto _ : state) benchmark::DoNotOptimize(lift(s.graph, s.grid.height, outlet));
  set_vertices(state, s);
}

void BM_vertex_graph(benchmark::State& state) {
  const Scene& s = scene(state.range(0), state.range(1));
  for (auto _ : state) benchmark::DoNotOptimize(make_vertex_graph(s.grid.num_vertices(), s.grid.triangle));
  set_vertices(state, s);
}

void sizes(benchmark::internal::Benchmark* b) {
  for (const int noise : {0, 200})
    for (const int side : {300, 1000}) b->Args({side, noise});
  b->Unit(benchmark::kMillisecond);
}

BENCHMARK(BM_vertex_graph)->Apply(sizes);
BENCHMARK(BM_plain_flood)->Apply(sizes);
BENCHMARK(BM_lift)->Apply(sizes);
BENCHMARK(BM_lift_lowest)->Apply(sizes);

}  // namespace
}  // namespace hydrotin::testing

BENCHMARK_MAIN();
