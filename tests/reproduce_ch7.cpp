#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "full_displacement_program.h"
#include "hydrotin/error.h"
#include "hydrotin/line_snapping.h"
#include "hydrotin/network_cleaning.h"
#include "hydrotin/river_embedding.h"
#include "hydrotin/river_mouths.h"
#include "hydrotin/river_statistics.h"
#include "hydrotin/synthetic.h"
#include "hydrotin/wingtip_clearing.h"
#include "thesis_tables_ch7.h"
#include "thinned_grid.h"

// Section 7.2 of the thesis: a river of an independent source embedded into mountains, by five variants.

namespace hydrotin {
namespace {

constexpr double kCell = 25, kRelief = 1600;
constexpr double kPi = 3.14159265358979323846;

struct Mountains {
  LatticeTerrain terrain;  ///< centimetres
  std::vector<LatticePoint> river;
  double river_length = 0;
};

struct MountainOptions {
  double side_m = 0, river_m = 0;
  double max_error = 5;     ///< of the thinned terrain
  double stretch = 4;       ///< horizontally: the relief of the generator is that of steep ravines
  int smoothing = 3;        ///< passes of a mean of 3 x 3 cells: a DEM made from contours has no ravines
  double line_noise_m = 8;  ///< of the points of the river
  std::uint64_t seed = 1;
};

void smooth(testing::HeightGrid& grid) {
  const auto side = static_cast<std::int32_t>(grid.side);
  testing::HeightGrid out = grid;
  for (std::int32_t y = 0; y < side; ++y)
    for (std::int32_t x = 0; x < side; ++x) {
      float sum = 0;
      for (std::int32_t dy = -1; dy <= 1; ++dy)
        for (std::int32_t dx = -1; dx <= 1; ++dx)
          sum += grid.at(std::clamp(x + dx, 0, side - 1), std::clamp(y + dy, 0, side - 1));
      out.height[static_cast<std::size_t>(y) * grid.side + static_cast<std::size_t>(x)] = sum / 9;
    }
  grid = std::move(out);
}

/// Upstream from a mouth, always into the larger branch: of all mouths the longest way that keeps off the other rims.
std::vector<std::array<double, 2>> main_stem(const std::vector<SyntheticRiver>& rivers, const LatticeBox& box) {
  const double margin = 0.03 * (box.max.x - box.min.x) * kSyntheticScale;
  const auto is_inside = [&](const std::array<double, 3>& p) {
    return p[0] > box.min.x * kSyntheticScale + margin && p[0] < box.max.x * kSyntheticScale - margin &&
           p[1] < box.max.y * kSyntheticScale - margin;
  };
  std::map<std::array<double, 3>, std::vector<const SyntheticRiver*>> ending;
  std::set<std::array<double, 3>> starts;
  for (const auto& river : rivers) {
    ending[river.line.back()].push_back(&river);
    starts.insert(river.line.front());
  }
  std::vector<std::array<double, 2>> best;
  double longest = 0;
  for (const auto& river : rivers) {
    if (starts.contains(river.line.back())) continue;
    std::vector<std::array<double, 2>> stem;
    double length = 0;
    bool is_good = true;
    for (const SyntheticRiver* up = &river; up != nullptr && is_good;) {
      for (auto p = up->line.rbegin(); p != up->line.rend() && is_good; ++p) {
        is_good = is_inside(*p);
        if (!is_good) break;
        if (!stem.empty()) length += std::hypot((*p)[0] - stem.back()[0], (*p)[1] - stem.back()[1]);
        stem.push_back({(*p)[0], (*p)[1]});
      }
      const auto above = ending.find(up->line.front());
      if (above == ending.end()) break;
      up = *std::max_element(above->second.begin(), above->second.end(),
                             [](const auto* a, const auto* b) { return a->catchment_m2 < b->catchment_m2; });
    }
    if (length > longest) {
      longest = length;
      best = std::move(stem);
    }
  }
  return best;
}

/// Carved mountains from 0 to 1600 m as a DEM of whole metres (as the 1:50,000 DEM of the thesis), thinned; and its
/// main river, as somebody else would have mapped it.
Mountains make_mountains(const MountainOptions& wanted) {
  const double side_m = wanted.side_m, stretch = wanted.stretch;
  SyntheticOptions options;
  options.num_points = static_cast<std::uint64_t>(side_m * side_m / (stretch * stretch));
  options.seed = wanted.seed;
  const SyntheticTerrain synthetic(options);
  const LatticeBox box = synthetic.box();
  const double west = box.min.x * kSyntheticScale, south = box.min.y * kSyntheticScale;
  testing::HeightGrid grid;
  grid.side = static_cast<std::uint32_t>(side_m / kCell) + 1;
  for (std::uint32_t y = 0; y < grid.side; ++y)
    for (std::uint32_t x = 0; x < grid.side; ++x)
      grid.height.push_back(
          static_cast<float>(synthetic.height(west + x * kCell / stretch, south + y * kCell / stretch)));
  const auto [low, high] = std::minmax_element(grid.height.begin(), grid.height.end());
  const float base = *low, scale = static_cast<float>(kRelief) / (*high - *low);
  for (float& h : grid.height) h = (h - base) * scale;
  for (int pass = 0; pass < wanted.smoothing; ++pass) smooth(grid);
  for (float& h : grid.height) h = std::round(h);

  Mountains mountains;
  const Triangulation thinned = testing::thin_grid(grid, wanted.max_error);
  for (const LatticePoint p : thinned.position) {
    mountains.terrain.position.push_back(
        {static_cast<std::int32_t>(100 * kCell) * p.x, static_cast<std::int32_t>(100 * kCell) * p.y});
    mountains.terrain.height.push_back(grid.at(p.x, p.y));
  }
  for (const VertexId v : thinned.origin) mountains.terrain.triangle.push_back(v.value);
  link_twins(mountains.terrain);

  const std::vector<std::array<double, 2>> stem = main_stem(synthetic.rivers(), box);
  std::mt19937_64 random(wanted.seed);
  std::normal_distribution<double> noise(0, wanted.line_noise_m);
  std::vector<LatticePoint> up_river;
  std::array<double, 2> last{};
  for (const auto& p : stem) {
    const double step = up_river.empty() ? 0 : stretch * std::hypot(p[0] - last[0], p[1] - last[1]);
    if (!up_river.empty() && step < 30) continue;
    if (mountains.river_length + step > wanted.river_m) break;
    mountains.river_length += step;
    last = p;
    up_river.push_back({static_cast<std::int32_t>(std::lround(100 * ((p[0] - west) * stretch + noise(random)))),
                        static_cast<std::int32_t>(std::lround(100 * ((p[1] - south) * stretch + noise(random))))});
  }
  mountains.river.assign(up_river.rbegin(), up_river.rend());
  return mountains;
}

struct Prepared {
  LatticeTerrain terrain;
  std::vector<std::array<double, 2>> position;
  std::vector<RiverEdge> rivers, chain;
  std::uint64_t third_edges = 0, steiner_points = 0;
  double length = 0;

  [[nodiscard]] RiverTerrain view() const { return {position, terrain.height, terrain.triangle}; }
};

void keep_longest(Prepared& p) {
  const RiverNetworks networks = connect_networks(p.view(), p.rivers);
  const auto longest = std::max_element(networks.length.begin(), networks.length.end()) - networks.length.begin();
  std::vector<RiverEdge> kept;
  for (std::size_t e = 0; e < p.rivers.size(); ++e)
    if (networks.network[e] == static_cast<std::uint32_t>(longest)) kept.push_back(p.rivers[e]);
  p.rivers = std::move(kept);
}

Prepared prepare(const Mountains& mountains) {
  Prepared out;
  out.terrain = mountains.terrain;
  RiverLines lines;
  lines.add(mountains.river, 0);
  CleanNetwork network;
  {
    const TerrainLocator locator(out.terrain);
    const SnappedLines snapped = snap_lines(locator, split_at_nodes(without_repeats(lines)));
    network = clean_network(out.terrain.position, out.terrain.height, snapped.paths);
  }
  out.third_edges = take_third_edges(out.terrain, network);
  out.rivers = network.edge;
  const auto place = [&] {
    out.position.clear();
    for (const LatticePoint p : out.terrain.position) out.position.push_back({p.x / 100.0, p.y / 100.0});
  };
  place();
  keep_longest(out);  // where the line runs along the rim it is cut into pieces
  out.chain = find_outlet_chains(out.view(), out.rivers, rim_vertices(out.view()), {}).edge;
  out.steiner_points = clear_wingtips(out.terrain, out.rivers, out.chain, {}).num_points;
  place();
  for (const auto& [a, b] : out.rivers)
    out.length += std::hypot(out.position[a][0] - out.position[b][0], out.position[a][1] - out.position[b][1]);
  return out;
}

RiverConstraints variant(std::size_t i) {
  RiverConstraints c;
  const std::string name = thesis::kVariants[i];
  c.limit_edge_slope = name.starts_with("VFRS");
  if (name == "VF") c.decline_measure = DeclineMeasure::none;
  if (name == "VF") c.decline = 0;
  if (name.ends_with("deg")) {
    c.decline_measure = DeclineMeasure::slope;
    c.decline = std::tan(kPi / 180);
  }
  return c;
}

void print_variants(const thesis::RiverOfThesis& of_thesis, const Prepared& p, bool with_full) {
  const double tolerance = 1e-7;
  const RiverStatistics before = river_statistics(p.view(), p.rivers, p.terrain.height, tolerance);
  std::printf("\nTable 7.2 %26s %11s %8s %9s %18s %18s\n", "", "triangles", "edges", "length", "wrong flow",
              "not valley");
  const auto row = [](const char* name, std::size_t triangles, std::size_t edges, double km, std::uint64_t wrong,
                      std::uint64_t valley) {
    const double n = static_cast<double>(edges) / 100;
    std::printf("%-36s %11zu %8zu %6.2f km %8llu (%5.2f %%) %8llu (%5.2f %%)\n", name, triangles, edges, km,
                static_cast<unsigned long long>(wrong), static_cast<double>(wrong) / n,
                static_cast<unsigned long long>(valley), static_cast<double>(valley) / n);
  };
  row("ours", p.terrain.triangle.size() / 3, p.rivers.size(), p.length / 1000, before.wrong_flow, before.not_valley);
  row((std::string(of_thesis.name) + " River, thesis").c_str(), static_cast<std::size_t>(of_thesis.triangles),
      static_cast<std::size_t>(of_thesis.edges), of_thesis.length_km, static_cast<std::uint64_t>(of_thesis.wrong_flow),
      static_cast<std::uint64_t>(of_thesis.not_valley));
  std::printf("third edges %llu, Steiner points %llu, edges of outlet chains %zu\n",
              static_cast<unsigned long long>(p.third_edges), static_cast<unsigned long long>(p.steiner_points),
              p.chain.size());
  std::printf("\nTables 7.3 and 7.4, ours | thesis\n%-11s %24s %17s %19s %15s %13s %13s", "", "total change", "moved",
              "average", "local minima", "flat edges", "leaks");
  std::printf("  %8s %8s %7s %7s\n", "lazy s", "full s", "ratio", "rows");
  std::printf("%-11s %24s %17s %19s %6llu | %6d %4llu | %6d %4llu | %6d\n", "initial", "", "", "",
              static_cast<unsigned long long>(before.local_minima), of_thesis.minima,
              static_cast<unsigned long long>(before.flat_edges), of_thesis.flat,
              static_cast<unsigned long long>(before.leak_vertices), of_thesis.leaks);
  for (std::size_t i = 0; i < thesis::kVariants.size(); ++i) {
    EmbeddingOptions options;
    options.constraints = variant(i);
    options.constraints.chain = p.chain;
    Embedding e;
    std::array<double, 5> times{};
    for (double& time : times) {
      const auto begun = std::chrono::steady_clock::now();
      e = embed_rivers(p.view(), p.rivers, options);
      time = testing::seconds_since(begun);
    }
    std::sort(times.begin(), times.end());
    const double lazy = times[2];
    const RiverStatistics s = river_statistics(p.view(), p.rivers, e.height, tolerance);
    const HeightChange change = height_change(p.terrain.height, e.height, tolerance);
    const thesis::RiverVariant& t = of_thesis.variant[i];
    std::printf("%-11s %11.1f | %8.0f m %6llu | %8d %6.2f | %6.2f m %6llu | %6d %4llu | %6d %4llu | %6d",
                thesis::kVariants[i], change.total, t.total, static_cast<unsigned long long>(change.moved), t.moved,
                change.average, t.average, static_cast<unsigned long long>(s.local_minima), t.minima,
                static_cast<unsigned long long>(s.flat_edges), t.flat, static_cast<unsigned long long>(s.leak_vertices),
                t.leaks);
    std::printf("  %8.3f", lazy);
    if (with_full && p.chain.empty()) {
      double full = 0;
      const double best = testing::full_program(p.view(), p.rivers, options.constraints, full);
      std::printf(" %8.3f %7.1f %7llu%s", full, full / lazy, static_cast<unsigned long long>(e.rows),
                  std::abs(best - e.objective) <= 1e-6 * std::max(1.0, best) ? "" : "  OBJECTIVE DIFFERS");
      if (std::abs(best - e.objective) > 1e-6 * std::max(1.0, best))
        throw Error(ErrorKind::check, "rows added when violated do not give the optimum of the whole program");
    }
    const bool is_valid = s.wrong_flow == 0 && s.not_valley == 0 && e.broken.empty() && e.optimal;
    std::printf("%s\n", is_valid ? "" : "  INVALID");
    if (!is_valid) throw Error(ErrorKind::check, "a river edge is not valid");
  }
}

int run(int argc, char** argv) {
  CLI::App app("Tables 7.2 to 7.4 of the thesis for synthetic mountains, beside its figures");
  std::string name = "Kowesas";
  MountainOptions wanted;
  bool no_full = false;
  app.add_option("--river", name, "which river of the thesis to be like")->capture_default_str();
  app.add_option("--side", wanted.side_m, "of the terrain [m]; 0: so that it has about as many triangles");
  app.add_option("--max-error", wanted.max_error, "of the thinned terrain [m]")->capture_default_str();
  app.add_option("--stretch", wanted.stretch, "horizontally")->capture_default_str();
  app.add_option("--smoothing", wanted.smoothing, "passes over the DEM")->capture_default_str();
  app.add_option("--line-noise", wanted.line_noise_m, "of the river line [m]")->capture_default_str();
  app.add_option("--seed", wanted.seed)->capture_default_str();
  app.add_flag("--no-full", no_full, "do not solve the whole linear program");
  CLI11_PARSE(app, argc, argv);
  for (const thesis::RiverOfThesis& river : thesis::kRivers) {
    if (name != river.name) continue;
    if (wanted.side_m <= 0) wanted.side_m = 65 * std::sqrt(static_cast<double>(river.triangles));
    wanted.river_m = 1045 * river.length_km;  // snapping and thinning shorten it
    const Mountains mountains = make_mountains(wanted);
    std::printf("mountains of %.1f x %.1f km, heights 0 to %.0f m in whole metres, vertical error %.1f m, seed %llu\n",
                wanted.side_m / 1000, wanted.side_m / 1000, kRelief, wanted.max_error,
                static_cast<unsigned long long>(wanted.seed));
    print_variants(river, prepare(mountains), !no_full);
    return 0;
  }
  std::fprintf(stderr, "reproduce_ch7: --river: '%s' is none of the thesis\n", name.c_str());
  return 2;
}

}  // namespace
}  // namespace hydrotin

int main(int argc, char** argv) {
  try {
    return hydrotin::run(argc, argv);
  } catch (const hydrotin::Error& error) {
    std::fprintf(stderr, "reproduce_ch7: %s\n", error.what());
    return static_cast<int>(error.kind());
  }
}
