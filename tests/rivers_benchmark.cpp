#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "executors.h"
#include "full_displacement_program.h"
#include "hydrotin/hilbert.h"
#include "hydrotin/line_snapping.h"
#include "hydrotin/network_cleaning.h"
#include "hydrotin/river_embedding.h"
#include "hydrotin/river_mouths.h"
#include "hydrotin/river_statistics.h"
#include "hydrotin/synthetic.h"
#include "hydrotin/triangulation.h"
#include "hydrotin/wingtip_clearing.h"

/// rivers_benchmark network [SIDE]: drainage lines of carved mountains, snapped and embedded: seconds and memory.
/// Lazy rows against the whole program by Clp's dual simplex, both in displacements: rivers_benchmark [SIDE].
/// A grid of SIDE x SIDE vertices (350 gives 244k triangles) over mountains, with one long river along the valley.

namespace {

using namespace hydrotin;
using testing::full_program;
using testing::seconds_since;

struct Terrain {
  std::vector<std::array<double, 2>> position;
  std::vector<double> height;
  std::vector<std::uint32_t> triangle;
  std::vector<RiverEdge> rivers;
};

// A river along the grid, one step to the east at a time and now and then one across; mountains rise from it, rougher
// the farther away, with noise as measured terrain has.
Terrain make_terrain(std::uint32_t side) {
  Terrain terrain;
  std::mt19937 random(42);
  std::uniform_real_distribution<double> jitter(-20, 20), noise(-1.5, 1.5);
  const auto middle = [&](double x) { return 0.5 * side + 0.1 * side * std::sin(x / side * 9); };
  const auto at = [&](std::uint32_t x, std::uint32_t y) { return y * side + x; };
  std::vector<std::uint32_t> bed(side);  // the river's row in each column
  bed[0] = static_cast<std::uint32_t>(middle(0));
  for (std::uint32_t x = 0; x + 1 < side; ++x) {
    std::uint32_t y = bed[x];
    const double want = middle(x + 1);
    bed[x + 1] = want > y + 1 ? y + 1 : y;  // a diagonal is an edge upwards only
    if (want + 1 < y && x % 3 == 0) {
      terrain.rivers.push_back({at(x, y), at(x, y - 1)});
      bed[x + 1] = --y;
    }
    terrain.rivers.push_back({at(x, y), at(x + 1, bed[x + 1])});
  }
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      terrain.position.push_back({430000 + 75.0 * x + jitter(random), 5810000 + 75.0 * y + jitter(random)});
      const double away = std::abs(static_cast<double>(y) - bed[x]);
      terrain.height.push_back(600 - 1200.0 * x / side + 3000 * away / side +
                               30 * std::min(1.0, away / 8) * std::sin(x * 0.3) * std::sin(y * 0.23) + noise(random));
    }
  for (std::uint32_t y = 0; y + 1 < side; ++y)
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t a = at(x, y), b = at(x + 1, y), c = at(x + 1, y + 1), d = at(x, y + 1);
      for (const std::uint32_t v : {a, b, c, a, c, d}) terrain.triangle.push_back(v);
    }
  return terrain;
}

// Ways down the smooth terrain from random vertices, until about so many vertices are on rivers.
void add_brooks(const LatticeTerrain& terrain, const std::vector<double>& smooth, std::uint64_t wanted,
                RiverPaths& paths) {
  constexpr auto kNone = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> lowest(terrain.num_vertices(), kNone);
  for (std::uint32_t h = 0; h < terrain.triangle.size(); ++h)
    for (const auto& [v, w] :
         {std::pair(terrain.origin(h), terrain.target(h)), std::pair(terrain.target(h), terrain.origin(h))})
      if (smooth[w] < smooth[v] && (lowest[v] == kNone || smooth[w] < smooth[lowest[v]])) lowest[v] = w;
  std::vector<std::uint8_t> is_river(terrain.num_vertices(), 0);
  std::uint64_t count = 0;
  const auto take = [&](std::uint32_t v) {
    count += is_river[v] == 0 ? 1 : 0;
    return std::exchange(is_river[v], std::uint8_t{1}) == 0;
  };
  for (const std::uint32_t v : paths.vertex) take(v);
  std::mt19937 random(2);
  while (count < wanted) {
    std::uint32_t v = static_cast<std::uint32_t>(random() % terrain.num_vertices());
    if (is_river[v] != 0 || lowest[v] == kNone) continue;
    paths.vertex.push_back(v);
    take(v);
    while (lowest[v] != kNone) {
      v = lowest[v];
      paths.vertex.push_back(v);
      if (!take(v)) break;
    }
    paths.begin.push_back(paths.vertex.size());
    paths.line.push_back(static_cast<std::uint32_t>(paths.line.size()));
  }
}

// A network all over: carved mountains sampled at random in each cell of SIDE x SIDE, the drainage lines snapped to
// them.
void run_network(std::uint32_t side, bool in_parallel) {
  SyntheticOptions options;
  options.num_points = std::uint64_t{100} * side * side;
  const SyntheticTerrain synthetic(options);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(0, 8), noise(-0.3, 0.3);
  const double west = synthetic.box().min.x * kSyntheticScale, south = synthetic.box().min.y * kSyntheticScale;
  std::vector<LatticePoint> points;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x)
      points.push_back({static_cast<std::int32_t>(100 * (10 * x + jitter(random))),
                        static_cast<std::int32_t>(100 * (10 * y + jitter(random)))});
  std::sort(points.begin(), points.end(),
            [](LatticePoint a, LatticePoint b) { return hilbert_key(a) < hilbert_key(b); });
  const Triangulation of = delaunay(points);
  LatticeTerrain terrain;
  terrain.position = of.position;
  std::vector<double> smooth;
  for (const LatticePoint p : of.position) {
    smooth.push_back(synthetic.height(west + p.x / 100.0, south + p.y / 100.0));
    terrain.height.push_back(std::round(100 * (smooth.back() + noise(random))) / 100);
  }
  for (const VertexId v : of.origin) terrain.triangle.push_back(v.value);
  RiverLines lines;
  for (const auto& river : synthetic.rivers()) {
    std::vector<LatticePoint> chain;
    for (const auto& p : river.line)
      chain.push_back({static_cast<std::int32_t>(std::lround(100 * (p[0] - west))),
                       static_cast<std::int32_t>(std::lround(100 * (p[1] - south)))});
    lines.add(chain, static_cast<std::uint32_t>(lines.size()));
  }
  auto begun = std::chrono::steady_clock::now();
  const auto lap = [&](const char* what) {
    std::printf("%-34s %8.2f s\n", what, seconds_since(begun));
    begun = std::chrono::steady_clock::now();
  };
  link_twins(terrain);
  CleanNetwork network;
  {
    const TerrainLocator locator(terrain);
    lap("links and index");
    SnappedLines snapped = snap_lines(locator, split_at_nodes(without_repeats(lines)));
    lap("walk and snap");
    add_brooks(terrain, smooth, std::uint64_t{side} * side * 9 / 100, snapped.paths);
    lap("brooks");
    network = clean_network(terrain.position, terrain.height, snapped.paths);
  }
  take_third_edges(terrain, network);
  lap("clean");
  Terrain t;
  const auto place = [&] {
    t.position.clear();
    for (const LatticePoint p : terrain.position) t.position.push_back({p.x / 100.0, p.y / 100.0});
  };
  place();
  const auto chain = find_outlet_chains({t.position, terrain.height, terrain.triangle}, network.edge,
                                        rim_vertices({t.position, terrain.height, terrain.triangle}), {})
                         .edge;
  clear_wingtips(terrain, network.edge, chain, {});
  place();
  lap("mouths and wingtips");
  const RiverTerrain view{t.position, terrain.height, terrain.triangle};
  const auto faults = river_statistics(view, network.edge, terrain.height, 0);
  std::printf("triangles %zu, lines %zu, river edges %zu, wrong flow %llu, not valley %llu\n",
              terrain.triangle.size() / 3, lines.size(), network.edge.size(),
              static_cast<unsigned long long>(faults.wrong_flow), static_cast<unsigned long long>(faults.not_valley));
  begun = std::chrono::steady_clock::now();
  for (const double quantum : {0.0, 0.001}) {
    EmbeddingOptions embedding;
    embedding.constraints.chain = chain;
    embedding.quantum = quantum;
    if (in_parallel) embedding.executor = testing::on_four_threads;
    const Embedding e = embed_rivers(view, network.edge, embedding);
    lap(quantum > 0 ? "VFRS 10 %, millimetres" : "VFRS 10 %");
    const auto after = river_statistics(view, network.edge, e.height, quantum > 0 ? 0 : 1e-7);
    std::printf(
        "objective %.3f, rows %llu, columns %llu, rounds %u, components %u, invalid edges %llu, broken rows %zu\n",
        e.objective, static_cast<unsigned long long>(e.rows), static_cast<unsigned long long>(e.columns), e.rounds,
        e.components, static_cast<unsigned long long>(after.wrong_flow + after.not_valley), e.broken.size());
    begun = std::chrono::steady_clock::now();
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("peak memory of the process %.2f GB\n", static_cast<double>(usage.ru_maxrss) / 1e6);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "network") {
    run_network(argc > 2 ? static_cast<std::uint32_t>(std::atoi(argv[2])) : 1000,
                argc > 3 && std::string(argv[3]) == "parallel");
    return 0;
  }
  const Terrain t = make_terrain(argc > 1 ? static_cast<std::uint32_t>(std::atoi(argv[1])) : 350);
  const auto faults = river_statistics({t.position, t.height, t.triangle}, t.rivers, t.height, 0);
  std::printf("triangles %zu, river edges %zu, wrong flow %llu, not valley %llu\n", t.triangle.size() / 3,
              t.rivers.size(), static_cast<unsigned long long>(faults.wrong_flow),
              static_cast<unsigned long long>(faults.not_valley));
  std::printf("%-10s %12s %12s %9s %9s %7s %7s %7s\n", "variant", "lazy", "full", "lazy s", "full s", "ratio", "rows",
              "rounds");
  for (const char* name : {"VF", "VFR 10%", "VFRS 10%", "VFR 1deg", "VFRS 1deg"}) {
    const std::string variant = name;
    EmbeddingOptions options;
    options.constraints.limit_edge_slope = variant.find('S') != std::string::npos;
    if (variant == "VF") options.constraints.decline_measure = DeclineMeasure::none;
    if (variant == "VF") options.constraints.decline = 0;
    if (variant.find("deg") != std::string::npos) {
      options.constraints.decline_measure = DeclineMeasure::slope;
      options.constraints.decline = std::tan(std::acos(-1.0) / 180);
    }
    const RiverTerrain view{t.position, t.height, t.triangle};
    std::vector<double> times;
    Embedding e;
    for (int run = 0; run < 3; ++run) {
      const auto begun = std::chrono::steady_clock::now();
      e = embed_rivers(view, t.rivers, options);
      times.push_back(seconds_since(begun));
    }
    std::sort(times.begin(), times.end());
    double full_seconds = 0;
    const double full = full_program(view, t.rivers, options.constraints, full_seconds);
    std::printf("%-10s %12.4f %12.4f %9.4f %9.3f %7.1f %7llu %7u\n", name, e.objective, full, times[1], full_seconds,
                full_seconds / times[1], static_cast<unsigned long long>(e.rows), e.rounds);
  }
  return 0;
}
