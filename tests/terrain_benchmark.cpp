#include <benchmark/benchmark.h>

#include <cstdint>
#include <functional>
#include <numeric>
#include <queue>
#include <vector>

#include "fractal_heights.h"
#include "grid_terrain.h"
#include "hydrotin/change_bound.h"
#include "hydrotin/contour_tree.h"
#include "hydrotin/lifting.h"
#include "hydrotin/pit_hierarchy.h"
#include "hydrotin/pit_removal.h"
#include "hydrotin/pits.h"
#include "hydrotin/rasterize.h"
#include "hydrotin/spill_tree.h"
#include "hydrotin/synthetic.h"
#include "hydrotin/vertex_graph.h"

// Speed of the terrain room, one thread, items = vertices or triangles. Arguments: side of the square grid (n =
// side^2), noise in lattice units (0: drained hills with few pits, 200: heavily pitted; -30, -100: the mountains of
// synthetic.h with white noise of that many units; kFractal: mountains rough at all scales, 4 to 5 % of the vertices
// are pits, of all sizes).

namespace hydrotin::testing {
namespace {

constexpr std::int64_t kFractal = 5;

struct Scene {
  GridTerrain grid;
  VertexGraph graph;
  std::vector<std::uint8_t> hull;
};

// The carved mountains of synthetic.h at the nodes of the grid, with noise: a sum of twelve uniform numbers.
std::vector<std::int32_t> mountain_heights(const GridTerrain& grid, double noise) {
  SyntheticOptions options;
  options.num_points = grid.num_vertices();
  const SyntheticTerrain terrain(options);
  const LatticeBox box = terrain.box();
  const double step = (static_cast<double>(box.max.x) - box.min.x) / (100.0 * grid.columns);
  std::vector<std::int32_t> height(grid.num_vertices());
  for (std::uint32_t v = 0; v < height.size(); ++v) {
    Random random(v);
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += random.unit();
    const double x = (box.min.x + (grid.position[v].x + 50) * step) * kSyntheticScale,
                 y = (box.min.y + (grid.position[v].y + 50) * step) * kSyntheticScale;
    height[v] = static_cast<std::int32_t>(terrain.height(x, y) / kSyntheticScale + sum * noise);
  }
  return height;
}

std::vector<std::int32_t> heights_of(const GridTerrain& grid, std::int64_t side, std::int64_t noise) {
  if (noise == kFractal)
    return fractal_heights(7, grid.position,
                           {.wavelength = 50.0 * static_cast<double>(side), .finest = 100, .persistence = 0.65});
  if (noise < 0) return mountain_heights(grid, static_cast<double>(-noise));
  return relief_heights(1, grid.position, 30000, 30000, static_cast<std::int32_t>(noise));
}

const Scene& scene(std::int64_t side, std::int64_t noise) {
  static Scene s;
  static std::int64_t made_side = 0, made_noise = -1;
  if (side != made_side || noise != made_noise) {
    const auto length = static_cast<std::uint32_t>(side);
    s.grid = make_grid(1, length, length, 100, 30);
    s.grid.height = heights_of(s.grid, side, noise);
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

void BM_contour_tree(benchmark::State& state) {
  const Scene& s = scene(state.range(0), state.range(1));
  for (auto _ : state) benchmark::DoNotOptimize(contour_tree(s.graph, s.grid.height, s.grid.position));
  set_vertices(state, s);
}

void BM_pit_hierarchy(benchmark::State& state) {
  const Scene& s = scene(state.range(0), state.range(1));
  for (auto _ : state)
    benchmark::DoNotOptimize(pit_hierarchy(s.graph, s.grid.triangle, s.grid.height, s.grid.position, s.hull));
  set_vertices(state, s);
}

double cost_by(const Scene& s, RemovalOptions options) {
  const ChangeableTerrain terrain{&s.graph, s.grid.height, s.grid.position, s.hull, {}, {}, {}};
  return static_cast<double>(remove_pits(terrain, options).cost);
}

// Counters: number of pits, total displacement, its ratio to lifting, and a ratio that no surface can be below.
void remove_all(benchmark::State& state, RemovalMethod method, std::uint64_t max_visits) {
  const Scene& s = scene(state.range(0), state.range(1));
  RemovalOptions options;
  options.limits.max_visits = max_visits;
  options.method = RemovalMethod::lift;
  const double lifted = cost_by(s, options);
  options.method = method;
  double cost = 0;
  for (auto _ : state) cost = cost_by(s, options);
  set_vertices(state, s);
  state.counters["pits"] = static_cast<double>(count_pits(s.graph, s.grid.height, s.hull));
  state.counters["total"] = cost;
  state.counters["of_lifting"] = cost / lifted;
  const ChangeableTerrain terrain{&s.graph, s.grid.height, s.grid.position, s.hull, {}, {}, {}};
  const auto level = lift(s.graph, s.grid.height, s.hull);
  state.counters["bound"] = static_cast<double>(change_bound(terrain, level, options.measure)) / lifted;
}
void BM_breach(benchmark::State& state) {
  remove_all(state, RemovalMethod::breach, kScalableVisits);
}
void BM_least_change(benchmark::State& state) {
  remove_all(state, RemovalMethod::least_change, kScalableVisits);
}
void BM_breach_unlimited(benchmark::State& state) {
  remove_all(state, RemovalMethod::breach, BreachLimits().max_visits);
}
void BM_least_change_unlimited(benchmark::State& state) {
  remove_all(state, RemovalMethod::least_change, BreachLimits().max_visits);
}

void BM_count_pits(benchmark::State& state) {
  const Scene& s = scene(state.range(0), state.range(1));
  for (auto _ : state) benchmark::DoNotOptimize(count_pits(s.graph, s.grid.height, s.hull));
  set_vertices(state, s);
}

// A tile inside the data: its outside is the rim, no outlet.
void BM_reduce_to_rim(benchmark::State& state) {
  const Scene& s = scene(state.range(0), state.range(1));
  std::vector<std::uint64_t> id(s.grid.num_vertices());
  std::iota(id.begin(), id.end(), std::uint64_t{7} << 32);
  const std::vector<std::uint8_t> none(id.size(), 0);
  for (auto _ : state) benchmark::DoNotOptimize(reduce_to_rim(s.graph, s.grid.height, id, s.hull, none));
  set_vertices(state, s);
}

// A tile inside the data from heights to final levels: reduce, keep the catchments, drain alone, finish.
void BM_tiled_lift(benchmark::State& state) {
  const Scene& s = scene(state.range(0), state.range(1));
  std::vector<std::uint64_t> id(s.grid.num_vertices());
  std::iota(id.begin(), id.end(), std::uint64_t{7} << 32);
  std::vector<std::uint8_t> outlet(id.size(), 0);
  outlet[lowest_vertex(s.grid.height, s.grid.position)] = 1;
  for (auto _ : state) {
    Catchments catchments;
    const SpillTree tree = reduce_to_rim(s.graph, s.grid.height, id, s.hull, outlet, &catchments);
    benchmark::DoNotOptimize(lift_catchments(catchments, drain({&tree, 1}).of(tree.rim)));
  }
  set_vertices(state, s);
}

// All triangles of the grid into cells of `cell` lattice units (points are 100 apart); items = triangles.
void BM_rasterize(benchmark::State& state) {
  const Scene& s = scene(state.range(0), 200);
  const Lattice lattice{0.01, 0.01, 0.0, 0.0, 0.0, 0, 0, 0};
  LatticeBox box;
  for (const LatticePoint p : s.grid.position) box.extend(p);
  const RasterFrame frame = frame_around(lattice, box, static_cast<double>(state.range(1)) * 0.01);
  const CellRange all{0, frame.columns, 0, frame.rows};
  std::vector<float> value(static_cast<std::size_t>(frame.columns * frame.rows));
  std::uint64_t cells = 0;
  for (auto _ : state)
    cells += rasterize(s.grid.position, s.grid.height, s.grid.triangle, lattice, frame, all, kNoEdgeLimit, value);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * s.grid.num_triangles()));
  state.counters["cells_per_second"] = benchmark::Counter(static_cast<double>(cells), benchmark::Counter::kIsRate);
}

// Trees of square tiles with 4,000 rim vertices each, random edges; items = edges.
void BM_drain(benchmark::State& state) {
  const auto side = static_cast<std::uint32_t>(state.range(0));
  Random random(1);
  std::vector<SpillTree> trees;
  std::int64_t num_edges = 0;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      SpillTree& tree = trees.emplace_back();
      for (const std::uint32_t seam : {2 * (y * (side + 1) + x), 2 * (y * (side + 1) + x) + 1,
                                       2 * (y * (side + 1) + x + 1), 2 * ((y + 1) * (side + 1) + x) + 1})
        for (std::uint32_t i = 0; i < 1000; ++i) tree.rim.push_back((std::uint64_t{seam} << 32) | i);
      std::sort(tree.rim.begin(), tree.rim.end());
      const auto r = static_cast<std::uint32_t>(tree.rim.size());
      for (std::uint32_t i = 1; i < r; ++i)
        tree.edge.push_back({i, random.below(1000) == 0 ? kOutlet : random.below(i), random.between(0, 100000)});
      num_edges += r - 1;
    }
  for (auto _ : state) benchmark::DoNotOptimize(drain(trees));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * num_edges);
}

void sizes(benchmark::internal::Benchmark* b) {
  for (const int noise : {0, 200, -30, -100})
    for (const int side : {300, 1000, 3162}) b->Args({side, noise});
  for (const int side : {350, 1000, 3162}) b->Args({side, kFractal});
  b->Unit(benchmark::kMillisecond);
}

BENCHMARK(BM_vertex_graph)->Apply(sizes);
BENCHMARK(BM_plain_flood)->Apply(sizes);
BENCHMARK(BM_lift)->Apply(sizes);
BENCHMARK(BM_lift_lowest)->Apply(sizes);
BENCHMARK(BM_breach)->Apply(sizes);
BENCHMARK(BM_least_change)->Apply(sizes);
BENCHMARK(BM_breach_unlimited)->Apply(sizes);
BENCHMARK(BM_least_change_unlimited)->Apply(sizes);
BENCHMARK(BM_contour_tree)->Apply(sizes);
BENCHMARK(BM_pit_hierarchy)->Apply(sizes);
BENCHMARK(BM_count_pits)->Apply(sizes);
BENCHMARK(BM_reduce_to_rim)->Apply(sizes);
BENCHMARK(BM_rasterize)->ArgsProduct({{1000}, {1000, 200, 100, 50, 10}})->Unit(benchmark::kMillisecond);
BENCHMARK(BM_tiled_lift)->Apply(sizes);
BENCHMARK(BM_drain)->Arg(5)->Arg(50)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hydrotin::testing

BENCHMARK_MAIN();
