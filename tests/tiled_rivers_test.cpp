// Rivers through the whole pipeline: any tiling gives what the functions give on one terrain in memory, the files prove
// that every river edge is valid, and what users open says what was done.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "expected_error.h"
#include "hdf5_attributes.h"
#include "hydrotin/error.h"
#include "hydrotin/las.h"
#include "hydrotin/lifting.h"
#include "hydrotin/river_burning.h"
#include "hydrotin/river_embedding.h"
#include "hydrotin/river_lakes.h"
#include "hydrotin/river_matching.h"
#include "hydrotin/river_statistics.h"
#include "hydrotin/vector.h"
#include "hydrotin/wingtip_clearing.h"
#include "monolith.h"
#include "plan.h"
#include "river_edges.h"
#include "shared_data.h"
#include "store.h"
#include "tiling_fixture.h"

namespace hydrotin {
namespace {

using testing::run;
using testing::TemporaryFolder;

constexpr std::uint64_t kEverything = 1'000'000'000;
using Chain = std::vector<LatticePoint>;

/// Hills with lines drawn across them, whatever these do to the relief.
struct Scene {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  std::vector<std::string> files;
  std::vector<Chain> line, lake;  // as the files of points count
  std::vector<Chain> preserved;
  std::string rivers, lakes, preserved_file;
};

VectorPoint in_crs(LatticePoint p) {
  return {500000 + p.x * 0.01, 4000000 + p.y * 0.01, 0};
}

void write_lines(Scene& scene, const TemporaryFolder& folder, const std::string& stem) {
  scene.rivers = folder / (stem + "rivers.gpkg");
  GeoPackageWriter out(scene.rivers, "EPSG:32633");
  const std::vector<VectorField> fields{{"name", FieldType::text}};
  const int layer = out.add_layer("rivers", VectorGeometry::line, false, fields);
  for (std::size_t i = 0; i < scene.line.size(); ++i) {
    std::vector<VectorPoint> points;
    for (const LatticePoint p : scene.line[i]) points.push_back(in_crs(p));
    out.add_line(layer, points, std::vector<FieldValue>{std::string(i < 2 ? "stem" : "")});
  }
  out.finish();
  if (scene.lake.empty()) return;
  scene.lakes = folder / (stem + "lakes.gpkg");
  GeoPackageWriter lakes(scene.lakes, "EPSG:32633");
  const int polygons = lakes.add_layer("lakes", VectorGeometry::polygon, false, {});
  for (const Chain& ring : scene.lake) {
    std::vector<VectorPoint> points;
    for (const LatticePoint p : ring) points.push_back(in_crs(p));
    lakes.add_polygon(polygons, points, {});
  }
  lakes.finish();
}

/// A stem with a tributary, rivers that end inside, rivers so near to each other that they have to be solved together,
/// a line that runs out of the terrain, and lakes.
Scene make_scene(const TemporaryFolder& folder, std::uint64_t seed, std::size_t n, bool with_lakes) {
  Scene s;
  s.position = testing::distinct(testing::make_cloud(testing::CloudKind::uniform, seed, n, 100));
  for (const LatticePoint p : s.position) s.height.push_back(testing::relief_at(seed, p, 3000, 4000, 5));
  const std::string stem = "scene" + std::to_string(seed) + (with_lakes ? "l" : "") + "_";
  s.files = testing::write_files(folder, s.position, s.height, 2, stem);
  const std::int32_t size = testing::extent_for(n, 100);
  const auto at = [&](double x, double y) {
    return LatticePoint{static_cast<std::int32_t>(x * size), static_cast<std::int32_t>(y * size)};
  };
  const LatticePoint node = at(0.52, 0.55);
  s.line = {{at(0.08, 0.3), at(0.2, 0.42), at(0.33, 0.37), at(0.45, 0.5), node},
            {node, at(0.61, 0.57), at(0.72, 0.47), at(0.9, 0.5), at(1.1, 0.52)},
            {at(0.5, 0.93), at(0.55, 0.8), at(0.48, 0.7), node},
            {at(0.15, 0.8), at(0.22, 0.72), at(0.3, 0.74)}};
  // Around a corner, from edge to edge.
  for (int i = 0; i < 3; ++i)
    s.line.push_back({at(0.6 + 0.09 * i, -0.05), at(0.78 + 0.06 * i, 0.22 - 0.06 * i), at(1.05, 0.36 - 0.09 * i)});
  if (with_lakes) {
    s.lake.push_back({at(0.42, 0.46), at(0.49, 0.47), at(0.48, 0.54), at(0.42, 0.53)});
    s.lake.push_back({at(0.3, 0.72), at(0.34, 0.72), at(0.33, 0.77), at(0.29, 0.77)});
  }
  write_lines(s, folder, stem);
  return s;
}

/// Rivers on parallel ridges that fall to the south, each into a lake of its own: each has to be cut in, and the slopes
/// between them pass that on.
Scene make_ridges(const TemporaryFolder& folder, std::uint64_t seed, std::size_t n) {
  Scene s;
  s.position = testing::distinct(testing::make_cloud(testing::CloudKind::uniform, seed, n, 100));
  const double size = testing::extent_for(n, 100), width = 0.12 * size;
  for (const LatticePoint p : s.position)
    s.height.push_back(
        static_cast<std::int32_t>(std::lround(p.y / 4.0 + 500 * std::cos(6.283185307179586 * p.x / width))));
  s.files = testing::write_files(folder, s.position, s.height, 2, "ridges_");
  for (int i = 1; i < 8; ++i) {
    const auto x = static_cast<std::int32_t>(i * width);
    const auto north = static_cast<std::int32_t>(0.85 * size), south = static_cast<std::int32_t>(0.15 * size);
    s.line.push_back({{x, north}, {x, south}});
    s.lake.push_back({{x - 150, south - 150}, {x + 150, south - 150}, {x + 150, south + 150}, {x - 150, south + 150}});
  }
  write_lines(s, folder, "ridges_");
  return s;
}

/// Rivers from all sides into a void in the middle.
Scene make_void(const TemporaryFolder& folder, std::uint64_t seed, std::size_t n) {
  Scene s;
  const double size = testing::extent_for(n, 100), middle = size / 2;
  for (const LatticePoint p : testing::distinct(testing::make_cloud(testing::CloudKind::uniform, seed, n, 100)))
    if (std::hypot(p.x - middle, p.y - middle) > 0.06 * size) s.position.push_back(p);
  for (const LatticePoint p : s.position)
    s.height.push_back(testing::relief_at(seed, p, 3000, 400, 5) +
                       static_cast<std::int32_t>(std::hypot(p.x - middle, p.y - middle)));
  const std::string stem = "void" + std::to_string(seed) + "_";
  s.files = testing::write_files(folder, s.position, s.height, 2, stem);
  for (int i = 0; i < 12; ++i) {
    const double angle = 0.5235987755982988 * i, x = std::cos(angle), y = std::sin(angle);
    const auto at = [&](double r) {
      return LatticePoint{static_cast<std::int32_t>(middle + r * size * x),
                          static_cast<std::int32_t>(middle + r * size * y)};
    };
    s.line.push_back({at(0.4), at(0.25), at(i % 2 == 0 ? 0.06 : 0.03)});
  }
  write_lines(s, folder, stem);
  return s;
}

PipelineOptions options_of(const Scene& scene, const std::string& out, std::uint64_t target) {
  PipelineOptions options = testing::options_for(scene.files, out);
  options.tiles.target_points = target;
  options.triangulation.order = 1;
  options.rivers.lines = scene.rivers;
  options.rivers.lakes = scene.lakes;
  options.rivers.preserve_edges = scene.preserved_file;
  options.rivers.name_field = "name";
  options.pits.method = PitMethod::lift;  // what the whole in memory does
  return options;
}

struct Expected {
  std::string fingerprint;
  std::uint64_t vertices = 0, triangles = 0, rivers = 0, chains = 0, outlets = 0, moved = 0, invalid = 0;
  std::uint64_t wrong_flow = 0, not_valley = 0, flat = 0, leaks = 0, beyond = 0;  // in the end
};

/// The terrain without its rivers.
LatticeTerrain terrain_of(const Scene& scene, const PipelineOptions& options, const Lattice& lattice) {
  const auto place = [&](LatticePoint p) {
    return LatticePoint{static_cast<std::int32_t>(p.x - lattice.base_x),
                        static_cast<std::int32_t>(p.y - lattice.base_y)};
  };
  LatticeTerrain given;
  std::vector<std::int32_t> measured;
  for (const auto& [p, z] : testing::lowest_points(scene.position, scene.height)) {
    given.position.push_back(place(p));
    measured.push_back(static_cast<std::int32_t>(z - lattice.base_z));
    given.height.push_back(measured.back());
  }
  const auto tin = triangulate(given.position, measured,
                               PointSetOptions{.order = options.triangulation.order,
                                               .polygon = {.objectives = options.triangulation.objectives}},
                               {});
  for (const auto& t : tin.triangles) given.triangle.insert(given.triangle.end(), t.begin(), t.end());
  link_twins(given);
  return given;
}

/// The edges of some triangles among vertices, the smaller vertex first.
std::set<std::pair<std::uint32_t, std::uint32_t>> edges_of(const LatticeTerrain& terrain) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> out;
  for (std::uint32_t h = 0; h < terrain.triangle.size(); ++h)
    out.insert(std::minmax(terrain.origin(h), terrain.target(h)));
  return out;
}

/// Every so many edges of the terrain, as lines of a file.
void preserve_some(Scene& scene, const TemporaryFolder& folder, const PipelineOptions& options, std::size_t step) {
  const Lattice lattice = make_plan(options).lattice;
  const LatticeTerrain terrain = terrain_of(scene, options, lattice);
  scene.preserved_file = folder / "preserved.gpkg";
  GeoPackageWriter out(scene.preserved_file, "EPSG:32633");
  const int layer = out.add_layer("edges", VectorGeometry::line, false, {});
  std::size_t i = 0;
  for (const auto& [a, b] : edges_of(terrain)) {
    if (++i % step != 0) continue;
    Chain line;
    std::vector<VectorPoint> points;
    for (const std::uint32_t v : {a, b}) {
      const LatticePoint p = terrain.position[v];
      line.push_back(
          {static_cast<std::int32_t>(p.x + lattice.base_x), static_cast<std::int32_t>(p.y + lattice.base_y)});
      points.push_back(in_crs(line.back()));
    }
    out.add_line(layer, points, {});
    scene.preserved.push_back(line);
  }
  out.finish();
}

/// The same in memory, in one go.
Expected expected_of(const Scene& scene, const PipelineOptions& options) {
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

void expect_checked(const std::string& dir, std::uint64_t river_edges, std::uint64_t invalid = 0) {
  const DatasetSummary checked = check_dataset(dir, 1000);
  EXPECT_TRUE(checked.ok) << (checked.problems.empty() ? "" : checked.problems.front());
  EXPECT_EQ(checked.pits, 0U);
  EXPECT_EQ(checked.river_edges, river_edges);
  EXPECT_EQ(checked.invalid_river_edges, invalid);
}

void expect_same(const Scene& scene, const PipelineOptions& base, const TemporaryFolder& folder,
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
    const Scene scene = make_scene(folder, 5, 8'000, with_lakes);
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
  const Scene scene = make_ridges(folder, 4, 6'000);
  expect_same(scene, options_of(scene, folder / "plan", kEverything), folder, "ridges", {kEverything, 1'200});
  const auto rivers = nlohmann::json::parse(testing::bytes_of(folder / "ridges1/report.json")).at("rivers");
  EXPECT_GT(rivers.at("groups"), 1);
  EXPECT_GT(rivers.at("groups_solved_together"), 1);
}

TEST(TiledRivers, VariantsEqualTheWhole) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(folder, 7, 3'000, false);
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
  Scene scene = make_scene(folder, 13, 2'000, false);
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
  const Scene scene = make_scene(folder, 9, 6'000, true);
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
    const Scene scene = make_void(folder, seed, 3'000);
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
  const Scene scene = make_scene(folder, 11, 5'000, true);
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

TEST(TiledRivers, ReportAndLayersSayWhatWasDone) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(folder, 5, 6'000, true);
  PipelineOptions options = options_of(scene, folder / "out", 1'500);
  options.rivers.points_out = PointsFile::las;
  const DatasetSummary summary = run(options);
  const auto report = nlohmann::json::parse(testing::bytes_of(folder / "out/report.json"));
  const auto& rivers = report.at("rivers");
  EXPECT_EQ(rivers.at("river_edges"), summary.river_edges);
  EXPECT_EQ(rivers.at("invalid_river_edges"), 0);
  EXPECT_EQ(rivers.at("lines").at("lines"), scene.line.size());
  EXPECT_EQ(rivers.at("lakes"), 2);
  EXPECT_GT(rivers.at("all").at("wrong_flow_before"), 0);
  EXPECT_EQ(rivers.at("all").at("wrong_flow_after"), 0);
  EXPECT_EQ(rivers.at("all").at("not_valley_after"), 0);
  std::uint64_t edges = 0;
  std::string profile;
  for (std::size_t i = 0; i < rivers.at("rivers").size(); ++i) {
    const auto& river = rivers.at("rivers").at(i);
    edges += river.at("edges").get<std::uint64_t>();
    if (river.at("name") == "stem")
      profile = testing::bytes_of(folder / ("out/profiles/0" + std::to_string(i + 1) + "-stem.svg"));
  }
  EXPECT_EQ(edges, summary.river_edges);
  // A lake that no river reaches is of no river.
  EXPECT_GE(rivers.at("objective").get<double>(), rivers.at("all").at("total_change").get<double>() - 1e-6);
  // The bound is that of rows with margins; heights are then rounded to centimetres.
  EXPECT_LE(rivers.at("bound").get<double>(),
            rivers.at("objective").get<double>() + 0.005 * rivers.at("vertices_moved").get<double>());
  EXPECT_NE(profile.find("<polyline"), std::string::npos);
  EXPECT_NE(profile.find(">stem</text>"), std::string::npos);
  // River vertices as points: their heights in the files.
  std::map<LatticePoint, std::int32_t> height;
  const Lattice lattice = make_plan(options).lattice;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "out/terrain")) {
    if (!entry.path().filename().string().starts_with("tile_")) continue;
    const store::Reader in(entry.path().string());
    const auto x = in.read<std::int32_t>("x"), y = in.read<std::int32_t>("y"), z = in.read<std::int32_t>("height");
    const auto xyz = in.read<std::int32_t>("foreign_xyz"), h = in.read<std::int32_t>("foreign_height");
    for (const std::uint32_t v : in.read<std::uint32_t>("river_edge"))
      if (v < x.size())
        height[{x[v], y[v]}] = z[v];
      else
        height[{xyz[3 * (v - x.size())], xyz[3 * (v - x.size()) + 1]}] = h[v - x.size()];
  }
  const LasFile points(folder / "out/river_vertices.las");
  EXPECT_EQ(points.header().point_count, height.size());
  EXPECT_EQ(points.header().scale[2], lattice.scale_z);
  std::size_t same = 0;
  for (std::size_t chunk = 0; chunk < points.num_chunks(); ++chunk) {
    PointBatch batch;
    points.decode(chunk, batch);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const auto at = [&](std::int32_t value, std::size_t axis, double offset, std::int64_t base) {
        const double c = value * points.header().scale[axis] + points.header().offset[axis];
        return static_cast<std::int32_t>(
            std::llround((c - offset) / points.header().scale[axis] - static_cast<double>(base)));
      };
      const auto found = height.find(
          {at(batch.x[i], 0, lattice.offset_x, lattice.base_x), at(batch.y[i], 1, lattice.offset_y, lattice.base_y)});
      same += found != height.end() && found->second == at(batch.z[i], 2, lattice.offset_z, lattice.base_z) ? 1 : 0;
    }
  }
  EXPECT_EQ(same, height.size());
  options.rivers.points_out = PointsFile::gpkg;
  EXPECT_TRUE(run(options).ok);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/river_vertices.las"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/river_vertices.gpkg"));
  // Without rivers nothing of them is left.
  PipelineOptions without = options;
  without.rivers = {};
  EXPECT_EQ(run(without).river_edges, 0U);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/terrain/rivers.h5"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/profiles"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/river_vertices.gpkg"));
  EXPECT_TRUE(check_dataset(folder / "out", 1000).ok);
}

bool mentions(const DatasetSummary& checked, const std::string& text) {
  return std::any_of(checked.problems.begin(), checked.problems.end(),
                     [&](const std::string& problem) { return problem.find(text) != std::string::npos; });
}

TEST(TiledRivers, CheckFindsWhatIsWrong) {
  const TemporaryFolder folder;
  const Scene scene = make_scene(folder, 5, 4'000, true);
  const PipelineOptions options = options_of(scene, folder / "out", 1'000);
  const DatasetSummary summary = run(options);
  ASSERT_TRUE(check_dataset(folder / "out", 10).ok);
  const auto damaged = [&](const std::string& name, auto damage) {
    const std::string copy = folder / name;
    std::filesystem::copy(folder / "out", copy, std::filesystem::copy_options::recursive);
    damage(copy + "/terrain/");
    return copy;
  };
  // The lower end of a river edge that one file holds rises above the upper one.
  const std::string higher = damaged("higher", [&](const std::string& terrain) {
    for (int t = 0; t < 4; ++t) {
      const std::string path = terrain + "tile_00000" + std::to_string(t) + ".h5";
      std::optional<std::pair<std::uint32_t, std::int32_t>> change;
      {
        const store::Reader in(path);
        const auto edge = in.read<std::uint32_t>("river_edge");
        const auto height = in.read<std::int32_t>("height");
        for (std::size_t i = 0; i + 1 < edge.size() && !change; i += 2)
          if (edge[i] < height.size() && edge[i + 1] < height.size()) change = {edge[i + 1], height[edge[i]] + 1};
      }
      if (!change) continue;
      testing::set_entry(path, "height", change->first, change->second);
      return;
    }
  });
  DatasetSummary checked = check_dataset(higher, 10);
  EXPECT_FALSE(checked.ok);
  EXPECT_GT(checked.invalid_river_edges, 0U);
  EXPECT_TRUE(mentions(checked, "is invalid, though nothing speaks against it"));
  EXPECT_TRUE(mentions(checked, "river edges, 0 of them invalid, but there are"));

  checked = check_dataset(damaged("fewer",
                                  [&](const std::string& terrain) {
                                    testing::set_attribute(terrain + "index.h5", "river_edges",
                                                           static_cast<std::int64_t>(summary.river_edges - 1));
                                  }),
                          10);
  EXPECT_TRUE(mentions(checked, "it states " + std::to_string(summary.river_edges - 1) + " river edges"));

  ASSERT_GT(store::Reader(folder / "out/terrain/rivers.h5").size("new_xyz"), 0U) << "the scene needs a Steiner point";
  checked = check_dataset(
      damaged("moved",
              [&](const std::string& terrain) { testing::set_entry(terrain + "rivers.h5", "new_xyz", 2, -7); }),
      10);
  EXPECT_TRUE(mentions(checked, "the new vertex at"));

  const std::string lost =
      damaged("lost", [&](const std::string& terrain) { std::filesystem::remove(terrain + "rivers.h5"); });
  EXPECT_NE(testing::error_of([&] { (void)check_dataset(lost, 10); }, ErrorKind::storage).find("rivers.h5"),
            std::string::npos);
}

TEST(TiledRivers, LinesDrawnUpstreamOnARealDem) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  PipelineOptions options = testing::options_for({}, folder / "out");
  options.input.dem = {testing::shared_path("dem_rivers_logan/output[0-3].tif")};
  options.rivers.lines = testing::shared_path("dem_rivers_logan/logannet.shp");
  options.tiles.target_points = 20'000;
  const DatasetSummary got = run(options);
  EXPECT_TRUE(got.ok);
  EXPECT_EQ(got.pits, 0U);
  EXPECT_EQ(got.river_edges, 2'838U);
  EXPECT_EQ(got.invalid_river_edges, 0U);
  const auto rivers = nlohmann::json::parse(testing::bytes_of(folder / "out/report.json")).at("rivers");
  EXPECT_EQ(rivers.at("lines").at("lines_turned"), 152);
  EXPECT_EQ(rivers.at("all").at("wrong_flow_before"), 522);
  EXPECT_EQ(rivers.at("all").at("not_valley_after"), 0);
  EXPECT_EQ(rivers.at("optimal"), true);
}

TEST(TiledRivers, MemoryIsAskedForBeforeTheLongWork) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  PipelineOptions options = testing::options_for({}, folder / "out");
  options.input.dem = {testing::shared_path("dem_rivers_nc/elev_ned_30m.tif")};
  options.rivers.lines = testing::shared_path("dem_rivers_nc/streams.shp");
  options.tiles.target_points = 30'000;
  options.run.memory_bytes = std::uint64_t{64} << 20;
  // 24,005 river edges on 371,000 triangles in the end.
  const PlanSummary plan = plan_run(options);
  EXPECT_NEAR(static_cast<double>(plan.river_edges), 24'005, 2'500);
  EXPECT_NEAR(static_cast<double>(plan.river_bytes), 371'000 * 400.0, 371'000 * 80.0);
  EXPECT_GE(plan.memory_bytes, plan.river_bytes);
  const std::string text = testing::error_of([&] { (void)run(options); }, ErrorKind::resource);
  EXPECT_NE(text.find("streams.shp: about 24"), std::string::npos) << text;
  EXPECT_NE(text.find("bytes an edge), but run.memory is 64 MiB"), std::string::npos) << text;
  EXPECT_FALSE(std::filesystem::exists(folder / "out/work/triangulate"));
  testing::Silent silent;
  EXPECT_NE(
      testing::error_of([&] { run_phase(options, Phase::outline, 0, 1, silent); }, ErrorKind::resource).find("24"),
      std::string::npos);
  options.rivers = {};
  EXPECT_EQ(plan_run(options).river_bytes, 0U);
}

TEST(TiledRivers, BadInputsAreNamed) {
  const TemporaryFolder folder;
  Scene scene = make_scene(folder, 3, 2'000, false);
  PipelineOptions options = options_of(scene, folder / "out", 1'000);
  options.rivers.lines = folder / "absent.gpkg";
  EXPECT_NE(testing::error_of([&] { (void)run(options); }, ErrorKind::input).find("absent.gpkg"), std::string::npos);
  scene.line = {{{-900'000, -900'000}, {-890'000, -900'000}}};
  write_lines(scene, folder, "far_");
  options = options_of(scene, folder / "out", 1'000);
  EXPECT_NE(
      testing::error_of([&] { (void)run(options); }, ErrorKind::input).find("no line runs along or across an edge"),
      std::string::npos);
  Scene edges = make_scene(folder, 3, 2'000, false);
  preserve_some(edges, folder, options_of(edges, folder / "plan", kEverything), 3'000);
  options = options_of(edges, folder / "out", 1'000);
  options.rivers.matching.direction = LineDirection::digitised;
  options.triangulation.order = 2;  // another terrain, maybe without that edge; and a line that is no edge of either
  {
    GeoPackageWriter out(folder / "preserved.gpkg", "EPSG:32633");
    const int layer = out.add_layer("edges", VectorGeometry::line, false, {});
    out.add_line(layer, std::vector<VectorPoint>{in_crs(edges.position.front()), in_crs(edges.position.back())}, {});
    out.finish();
  }
  EXPECT_NE(testing::error_of([&] { (void)run(options); }, ErrorKind::input).find("runs no edge of the terrain"),
            std::string::npos);
  options.rivers.preserve_edges = options.rivers.lines;  // leaves the terrain
  EXPECT_NE(testing::error_of([&] { (void)run(options); }, ErrorKind::input).find("is outside the terrain"),
            std::string::npos);
  options = options_of(edges, folder / "out", 1'000);
  options.rivers.preserve_edges.clear();
  options.rivers.method = RiverMethod::dp;  // its network parts
  EXPECT_NE(testing::error_of([&] { (void)run(options); }, ErrorKind::input).find("which rivers.method: dp cannot"),
            std::string::npos);
  Scene lakes = make_scene(folder, 3, 2'000, true);
  lakes.lake.push_back(lakes.lake[0]);
  write_lines(lakes, folder, "twice_");
  options = options_of(lakes, folder / "out", 1'000);
  EXPECT_NE(testing::error_of([&] { (void)run(options); }, ErrorKind::input).find("lakes must not overlap"),
            std::string::npos);
}

}  // namespace
}  // namespace hydrotin
