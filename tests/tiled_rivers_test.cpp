// Rivers through the whole pipeline: any tiling gives what the functions give on one terrain in memory.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "hydrotin/lifting.h"
#include "hydrotin/river_burning.h"
#include "hydrotin/river_embedding.h"
#include "hydrotin/river_lakes.h"
#include "hydrotin/river_matching.h"
#include "hydrotin/river_statistics.h"
#include "hydrotin/wingtip_clearing.h"
#include "monolith.h"
#include "plan.h"
#include "river_edges.h"
#include "river_scenes.h"
#include "tiling_fixture.h"

namespace hydrotin {
namespace {

using testing::Chain;
using testing::edges_of;
using testing::expect_checked;
using testing::kEverything;
using testing::make_ridges;
using testing::make_scene;
using testing::make_void;
using testing::options_of;
using testing::preserve_some;
using testing::RiverScene;
using testing::run;
using testing::TemporaryFolder;
using testing::terrain_of;
using testing::write_lines;

struct Expected {
  std::string fingerprint;
  std::uint64_t vertices = 0, triangles = 0, rivers = 0, chains = 0, outlets = 0, moved = 0, invalid = 0;
  std::uint64_t wrong_flow = 0, not_valley = 0, flat = 0, leaks = 0, beyond = 0;  // in the end
};

/// The same in memory, in one go.
Expected expected_of(const RiverScene& scene, const PipelineOptions& options) {
  const Lattice lattice = make_plan(options).lattice;
  const auto place = [&](LatticePoint p) {
    return LatticePoint{static_cast<std::int32_t>(p.x - lattice.base_x),
                        static_cast<std::int32_t>(p.y - lattice.base_y)};
  };
  const LatticeTerrain given = terrain_of(scene, options, lattice);
  RiverLines lines;
  for (std::size_t i = 0; i < scene.line.size(); ++i) {
    Chain chain;
    for (const LatticePoint p : scene.line[i]) chain.push_back(place(p));
    lines.add(chain, static_cast<std::uint32_t>(i));
  }
  MatchedLines match = match_lines(given, lines, scene.line.size(), options.rivers.matching, {}, {});
  LatticeTerrain& terrain = match.terrain;
  const auto round = [&](std::size_t first) {
    for (std::size_t v = first; v < terrain.height.size(); ++v) terrain.height[v] = std::round(terrain.height[v]);
  };
  round(given.position.size());
  const auto plane = [&] {
    std::vector<std::array<double, 2>> out;
    for (const LatticePoint p : terrain.position) out.push_back({p.x * lattice.scale_xy, p.y * lattice.scale_xy});
    return out;
  };
  EmbeddingOptions embedding;
  embedding.constraints = options.rivers.constraints;
  embedding.quantum = lattice.scale_z;
  for (const Chain& ring : scene.lake) {
    std::vector<std::array<double, 3>> corner;
    for (const LatticePoint p : ring)
      corner.push_back({static_cast<double>(place(p).x), static_cast<double>(place(p).y), 0});
    const std::vector<std::size_t> rings{0, 1}, points{0, corner.size()};
    std::vector<std::array<double, 2>> position;
    for (const LatticePoint p : terrain.position)
      position.push_back({static_cast<double>(p.x), static_cast<double>(p.y)});
    embedding.constraints.lakes.push_back({vertices_in({rings, points, corner}, position).vertex[0], false, 0});
  }
  auto position = plane();
  embedding.constraints.lakes =
      close_lakes({position, terrain.height, terrain.triangle}, match.rivers, embedding.constraints.lakes).lake;
  const auto lake_of = [&] { return lake_numbers(terrain.num_vertices(), embedding.constraints.lakes); };
  std::vector<std::uint8_t> outlet(terrain.num_vertices(), 0);
  for (std::uint32_t h = 0; h < terrain.triangle.size(); ++h)
    if (terrain.twin[h] == kNoHalfedge) outlet[terrain.origin(h)] = outlet[terrain.target(h)] = 1;
  const auto hull = outlet;
  add_closed_lakes(match.rivers, lake_of(), outlet);
  const OutletChains chains =
      find_outlet_chains({position, terrain.height, terrain.triangle}, match.rivers, outlet, lake_of());
  for (const RiverMouth& mouth : chains.mouth)
    if (mouth.kind == MouthKind::closed) outlet[mouth.vertex] = 1;
  Expected out;
  for (std::size_t v = 0; v < outlet.size(); ++v) out.outlets += outlet[v] != hull[v] ? 1 : 0;
  const std::uint32_t before = terrain.num_vertices();
  (void)clear_wingtips(terrain, match.rivers, chains.edge, lake_of());
  round(before);
  outlet.resize(terrain.num_vertices(), 0);
  for (std::uint32_t h = 0; h < terrain.triangle.size(); ++h)
    if (terrain.twin[h] == kNoHalfedge) outlet[terrain.origin(h)] = outlet[terrain.target(h)] = 1;
  position = plane();
  std::vector<double> z;
  for (const double h : terrain.height) z.push_back(h * lattice.scale_z);
  embedding.constraints.chain = chains.edge;
  const auto edges = edges_of(terrain);
  for (const Chain& line : scene.preserved) {
    const auto find = [&](LatticePoint p) {
      return static_cast<std::uint32_t>(std::find(terrain.position.begin(), terrain.position.end(), place(p)) -
                                        terrain.position.begin());
    };
    const std::uint32_t a = find(line[0]), b = find(line[1]);
    if (edges.contains(std::minmax(a, b)))
      embedding.constraints.preserve.push_back(
          {a, b, options.rivers.preserve_drainage, options.rivers.preserve_curvature});
  }
  Embedding embedded;
  if (options.rivers.method == RiverMethod::lp) {
    embedded = embed_rivers({position, z, terrain.triangle}, match.rivers, embedding);
  } else {
    std::vector<std::array<double, 2>> at;
    for (const LatticePoint p : terrain.position) at.push_back({static_cast<double>(p.x), static_cast<double>(p.y)});
    embedding.quantum = 1;
    BurnedEmbedding burned = embed_by_burning({at, terrain.height, terrain.triangle}, match.rivers, embedding);
    if (burned.fault != BurningFault::none) throw std::runtime_error("rivers that dp cannot handle");
    embedded = std::move(burned.embedding);
    for (double& h : embedded.height) h *= lattice.scale_z;
  }
  std::vector<std::int32_t> height;
  for (std::size_t v = 0; v < z.size(); ++v) {
    height.push_back(static_cast<std::int32_t>(std::llround(embedded.height[v] / lattice.scale_z)));
    out.moved += height[v] != static_cast<std::int32_t>(terrain.height[v]) ? 1 : 0;
  }
  const VertexGraph graph = make_vertex_graph(terrain.num_vertices(), terrain.triangle);
  const auto level = lift(graph, height, outlet);
  out.invalid = invalid_river_edges(terrain.position, level, terrain.triangle, match.rivers, true, true).size();
  EXPECT_TRUE(out.invalid == 0 || !embedded.broken.empty());
  std::vector<double> last, last_units;
  for (const std::int32_t h : level) {
    last.push_back(h * lattice.scale_z);
    last_units.push_back(h);
  }
  std::vector<std::array<double, 2>> units;
  for (const LatticePoint p : terrain.position) units.push_back({static_cast<double>(p.x), static_cast<double>(p.y)});
  const RiverStatistics in_units = river_statistics({units, last_units, terrain.triangle}, match.rivers, last_units, 0);
  out.wrong_flow = in_units.wrong_flow;
  out.not_valley = in_units.not_valley;
  out.flat = in_units.flat_edges;
  out.leaks = river_statistics({position, z, terrain.triangle}, match.rivers, last, 0).leak_vertices;
  std::vector<std::uint8_t> is_exempt(terrain.num_vertices(), 0);
  for (const auto& [from, to] : match.rivers) is_exempt[from] = is_exempt[to] = 1;
  for (const auto& [from, to] : chains.edge) is_exempt[from] = is_exempt[to] = 1;
  for (const Lake& lake : embedding.constraints.lakes)
    for (const std::uint32_t v : lake.vertex) is_exempt[v] = 1;
  for (const auto& [a, b] : edges_of(terrain)) {
    const auto change = [&](const std::vector<std::int32_t>& now) {
      return std::abs((now[a] - terrain.height[a]) - (now[b] - terrain.height[b]));
    };
    const double most = options.rivers.constraints.edge_slope_change * std::abs(terrain.height[a] - terrain.height[b]);
    if (is_exempt[a] == 0 && is_exempt[b] == 0 && options.rivers.constraints.limit_edge_slope && most > 1)
      out.beyond += change(level) > most + 1e-9 && change(height) <= most + 1e-9 ? 1 : 0;
  }
  Fingerprint sum;
  const auto corner = [&](std::uint32_t v) {
    return Fingerprint::Corner{terrain.position[v].x, terrain.position[v].y, level[v]};
  };
  for (std::size_t t = 0; t < terrain.triangle.size(); t += 3)
    sum.add({corner(terrain.triangle[t]), corner(terrain.triangle[t + 1]), corner(terrain.triangle[t + 2])});
  out.fingerprint = sum.hex();
  out.vertices = terrain.num_vertices();
  out.triangles = terrain.triangle.size() / 3;
  out.rivers = match.rivers.size();
  out.chains = chains.edge.size();
  return out;
}

void expect_same(const RiverScene& scene, const PipelineOptions& base, const TemporaryFolder& folder,
                 const std::string& name, const std::vector<std::uint64_t>& targets) {
  const Expected expected = expected_of(scene, base);
  EXPECT_GT(expected.rivers, 10U);
  EXPECT_GT(expected.moved, 0U);
  if (base.rivers.constraints.limit_edge_slope) {
    EXPECT_GT(expected.beyond, 0U);
  }
  int serial = 0;
  for (const std::uint64_t target : targets) {
    SCOPED_TRACE(name + " " + std::to_string(target));
    PipelineOptions options = base;
    options.output.dir = folder / (name + std::to_string(serial));
    options.tiles.target_points = target;
    options.run.workers = 1 + serial % 2;
    if (serial++ % 2 == 1) options.run.memory_bytes = std::uint64_t{64} << 20;
    const DatasetSummary got = run(options);
    EXPECT_EQ(got.fingerprint, expected.fingerprint);
    EXPECT_EQ(got.vertices, expected.vertices);
    EXPECT_EQ(got.triangles, expected.triangles);
    EXPECT_EQ(got.river_edges, expected.rivers);
    EXPECT_EQ(got.invalid_river_edges, expected.invalid);
    EXPECT_TRUE(got.ok);
    const auto rivers = nlohmann::json::parse(testing::bytes_of(options.output.dir + "/report.json")).at("rivers");
    EXPECT_EQ(rivers.at("all").at("wrong_flow_after"), expected.wrong_flow);
    EXPECT_EQ(rivers.at("all").at("not_valley_after"), expected.not_valley);
    EXPECT_EQ(rivers.at("all").at("flat_after"), expected.flat);
    EXPECT_EQ(rivers.at("all").at("leak_vertices_after"), expected.leaks);
    EXPECT_EQ(rivers.at("slopes_beyond_limit_by_pits"), expected.beyond);
    expect_checked(options.output.dir, expected.rivers, expected.invalid);
  }
}

TEST(TiledRivers, EveryTilingEqualsTheWhole) {
  const TemporaryFolder folder;
  for (const bool with_lakes : {false, true}) {
    const RiverScene scene = make_scene(folder, 5, 8'000, with_lakes);
    for (const bool insert : {false, true}) {
      PipelineOptions options = options_of(scene, folder / "plan", kEverything);
      options.rivers.matching.insert = insert;
      expect_same(
          scene, options, folder, std::string(with_lakes ? "l" : "-") + (insert ? "i" : "s"),
          insert != with_lakes ? std::vector<std::uint64_t>{kEverything, 1'000} : std::vector<std::uint64_t>{2'500});
    }
  }
}

TEST(TiledRivers, NetworksThatComeNearEachOtherAreSolvedAsOne) {
  const TemporaryFolder folder;
  const RiverScene scene = make_ridges(folder, 4, 6'000);
  expect_same(scene, options_of(scene, folder / "plan", kEverything), folder, "ridges", {kEverything, 1'200});
  const auto rivers = nlohmann::json::parse(testing::bytes_of(folder / "ridges1/report.json")).at("rivers");
  EXPECT_GT(rivers.at("groups"), 1);
  EXPECT_GT(rivers.at("groups_solved_together"), 1);
}

TEST(TiledRivers, VariantsEqualTheWhole) {
  const TemporaryFolder folder;
  const RiverScene scene = make_scene(folder, 7, 3'000, false);
  const auto with = [&](const std::string& name, auto change) {
    PipelineOptions options = options_of(scene, folder / "plan", kEverything);
    change(options.rivers);
    expect_same(scene, options, folder, name, {1'500});
  };
  with("vf", [](RiverOptions& r) {
    r.constraints.decline_measure = DeclineMeasure::none;
    r.constraints.limit_edge_slope = false;
  });
  with("slope", [](RiverOptions& r) {
    r.constraints.decline_measure = DeclineMeasure::slope;
    r.constraints.decline = 0.01;
    r.constraints.side_slope = 0.02;
  });
  with("exact", [](RiverOptions& r) { r.constraints.contiguity = Contiguity::exact; });
  with("reversed", [](RiverOptions& r) { r.matching.direction = LineDirection::reversed; });
}

TEST(TiledRivers, MethodsEqualTheWhole) {
  const TemporaryFolder folder;
  RiverScene scene = make_scene(folder, 13, 2'000, false);
  scene.line.resize(4);
  write_lines(scene, folder, "merging_");
  const auto with = [&](const std::string& name, auto change) {
    PipelineOptions options = options_of(scene, folder / "plan", kEverything);
    options.rivers.matching.direction = LineDirection::digitised;  // rivers that only merge
    change(options.rivers);
    expect_same(scene, options, folder, name, {1'000});
    return nlohmann::json::parse(testing::bytes_of(folder / (name + "0/report.json")));
  };
  const auto free = with("free", [](RiverOptions&) {});
  const auto lp = with("lp", [](RiverOptions& r) { r.constraints.river_only = true; }).at("rivers");
  const auto dp = with("dp", [](RiverOptions& r) { r.method = RiverMethod::dp; }).at("rivers");
  EXPECT_EQ(lp.at("contradictions"), 0);
  EXPECT_NEAR(dp.at("bound").get<double>(), lp.at("bound").get<double>(), 1e-4);
  EXPECT_EQ(dp.at("method"), "dp");
  // At once out of time: each group by itself keeps flow and valleys, whatever the tiling.
  std::string fingerprint;
  const RiverScene lakes = make_scene(folder, 13, 2'000, true);
  for (const std::uint64_t target : {kEverything, std::uint64_t{1'000}}) {
    PipelineOptions options = options_of(lakes, folder / ("lakes" + std::to_string(target)), target);
    options.rivers.time_limit = 1e-9;
    const DatasetSummary got = run(options);
    EXPECT_TRUE(got.ok);
    EXPECT_EQ(got.invalid_river_edges, 0U);
    const auto rivers = nlohmann::json::parse(testing::bytes_of(options.output.dir + "/report.json")).at("rivers");
    EXPECT_EQ(rivers.at("contradictions_by_constraint").count("lake"), 0U);
    EXPECT_EQ(rivers.at("optimal"), false);
  }
  for (const std::uint64_t target : {kEverything, std::uint64_t{1'000}}) {
    PipelineOptions options = options_of(scene, folder / ("limited" + std::to_string(target)), target);
    options.rivers.matching.direction = LineDirection::digitised;
    options.rivers.time_limit = 1e-9;
    const DatasetSummary got = run(options);
    if (fingerprint.empty()) fingerprint = got.fingerprint;
    EXPECT_EQ(got.fingerprint, fingerprint);
    EXPECT_TRUE(got.ok);
    EXPECT_EQ(got.invalid_river_edges, 0U);
    expect_checked(options.output.dir, got.river_edges);
    const auto limited = nlohmann::json::parse(testing::bytes_of(options.output.dir + "/report.json")).at("rivers");
    EXPECT_EQ(limited.at("optimal"), false);
    EXPECT_EQ(limited.at("time_limit"), 1e-9);
    EXPECT_GT(limited.at("objective"), lp.at("bound"));
    EXPECT_LE(limited.at("bound"), lp.at("bound"));
  }
  preserve_some(scene, folder, options_of(scene, folder / "plan", kEverything), 25);
  for (const bool insert : {false, true}) {
    const auto kept = with(insert ? "insert" : "kept", [&](RiverOptions& r) {
      r.matching.insert = insert;
      r.preserve_curvature = insert;
    });
    EXPECT_GT(kept.at("rivers").at("lines").at("preserved_edges"), 100);
    EXPECT_EQ(kept.at("rivers").at("lines").at("preserved_edges_cut") > 0, insert);
    EXPECT_NE(kept.at("fingerprint"), free.at("fingerprint"));
  }
}

TEST(TiledRivers, LeastChangeKeepsRivers) {
  const TemporaryFolder folder;
  const RiverScene scene = make_scene(folder, 9, 6'000, true);
  const Expected expected = expected_of(scene, options_of(scene, folder / "plan", kEverything));
  for (const PitMethod method : {PitMethod::least_change, PitMethod::breach, PitMethod::none}) {
    std::string fingerprint;
    for (const std::uint64_t target : {kEverything, std::uint64_t{1'500}}) {
      PipelineOptions options =
          options_of(scene, folder / (std::to_string(static_cast<int>(method)) + "-" + std::to_string(target)), target);
      options.pits.method = method;
      const DatasetSummary got = run(options);
      if (fingerprint.empty()) fingerprint = got.fingerprint;
      EXPECT_EQ(got.fingerprint, fingerprint);
      EXPECT_EQ(got.river_edges, expected.rivers);
      EXPECT_EQ(got.invalid_river_edges, 0U);
      const DatasetSummary checked = check_dataset(options.output.dir, 1000);
      EXPECT_TRUE(checked.ok) << (checked.problems.empty() ? "" : checked.problems.front());
      if (method == PitMethod::none) {
        EXPECT_GT(checked.pits, 0U);
      } else {
        EXPECT_EQ(checked.pits, 0U);
      }
    }
  }
}

// A river that ends at a void relies on it, even where a point added for the river cuts the long edge across.
TEST(TiledRivers, RiversMayEndAtVoids) {
  const TemporaryFolder folder;
  std::uint64_t edges = 0;
  for (std::uint64_t seed = 20; seed < 24; ++seed) {
    SCOPED_TRACE(seed);
    const RiverScene scene = make_void(folder, seed, 3'000);
    std::string fingerprint;
    for (const std::uint64_t target : {kEverything, std::uint64_t{1'000}}) {
      PipelineOptions options =
          options_of(scene, folder / (std::to_string(seed) + "-" + std::to_string(target)), target);
      options.output.dem.enabled = false;
      options.pits.method = seed % 2 == 0 ? PitMethod::least_change : PitMethod::lift;
      options.pits.voids_drain = true;
      options.pits.void_edge_m = 4;
      const DatasetSummary got = run(options);
      if (fingerprint.empty()) fingerprint = got.fingerprint;
      EXPECT_EQ(got.fingerprint, fingerprint);
      EXPECT_EQ(got.invalid_river_edges, 0U);
      const DatasetSummary checked = check_dataset(options.output.dir, 1000);
      EXPECT_TRUE(checked.ok) << (checked.problems.empty() ? "" : checked.problems.front());
      EXPECT_EQ(checked.pits, 0U);
      edges += got.river_edges;
    }
  }
  EXPECT_GT(edges, 60U);
}

TEST(TiledRivers, JobArraysGiveTheSame) {
  const TemporaryFolder folder;
  const RiverScene scene = make_scene(folder, 11, 5'000, true);
  PipelineOptions whole = options_of(scene, folder / "whole", kEverything), options = whole;
  whole.pits.method = options.pits.method = PitMethod::least_change;
  options.output.dir = folder / "array";
  options.tiles.target_points = 1'000;
  const std::string expected = run(whole).fingerprint;
  testing::Silent silent;
  for (std::size_t p = 0; p < kNumPhases; ++p)
    for (std::uint64_t task = 0; task < 3; ++task) run_phase(options, static_cast<Phase>(p), 2 - task, 3, silent);
  EXPECT_EQ(check_dataset(options.output.dir, 1000).fingerprint, expected);
  expect_checked(options.output.dir, check_dataset(folder / "whole", 1).river_edges);
  // Outputs of every kind that an interruption took.
  for (const std::string lost : {"work/lay/000001.h5", "work/match/000000.h5", "work/embed/000000.h5",
                                 "work/unite/000000.h5", "terrain/rivers.h5", "terrain/index.h5"})
    ASSERT_TRUE(std::filesystem::remove(folder / ("array/" + lost))) << lost;
  EXPECT_EQ(run(options).fingerprint, expected);
  EXPECT_TRUE(check_dataset(options.output.dir, 1000).ok);
}

}  // namespace
}  // namespace hydrotin
