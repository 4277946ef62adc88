#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "full_displacement_program.h"
#include "hydrotin/river_embedding.h"
#include "hydrotin/river_statistics.h"

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

}  // namespace

int main(int argc, char** argv) {
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
