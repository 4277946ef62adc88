// Pit removal through the whole pipeline: any tiling gives what one terrain in memory gives, on its own result nothing
// changes, and what users open says what was done.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "expected_error.h"
#include "hydrotin/error.h"
#include "hydrotin/lake_bound.h"
#include "hydrotin/lifting.h"
#include "hydrotin/pit_choice.h"
#include "hydrotin/pit_removal.h"
#include "hydrotin/vector.h"
#include "monolith.h"
#include "pipeline_outputs.h"
#include "plan.h"
#include "schedule.h"
#include "tiling_fixture.h"

namespace hydrotin {
namespace {

using testing::run;
using testing::TemporaryFolder;

constexpr std::uint64_t kEverything = 1'000'000'000;

struct Terrain {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  std::vector<std::string> files;
};

/// Hills with plateaus and deep lakes.
Terrain make_terrain(const TemporaryFolder& folder, std::uint64_t seed, std::size_t n, std::int32_t coarse) {
  Terrain t;
  t.position = testing::distinct(testing::make_cloud(testing::CloudKind::uniform, seed, n, 100));
  for (const LatticePoint p : t.position)
    t.height.push_back((testing::relief_at(seed, p, 3000, 2000, 5) / coarse) * coarse / 10);
  t.files = testing::write_files(folder, t.position, t.height, 2, "terrain" + std::to_string(seed) + "_");
  return t;
}

/// The same in memory.
struct Whole {
  VertexGraph graph;
  std::vector<std::uint32_t> triangle;
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  std::vector<std::uint8_t> on_hull;

  [[nodiscard]] std::string fingerprint(std::span<const std::int32_t> z) const {
    Fingerprint sum;
    for (std::size_t i = 0; i < triangle.size(); i += 3) {
      const auto corner = [&](std::size_t j) {
        const std::uint32_t v = triangle[i + j];
        return Fingerprint::Corner{position[v].x, position[v].y, z[v]};
      };
      sum.add({corner(0), corner(1), corner(2)});
    }
    return sum.hex();
  }
};

Whole make_whole(const Terrain& terrain, const PipelineOptions& options) {
  const Lattice lattice = make_plan(options).lattice;
  Whole w;
  for (const auto& [p, z] : testing::lowest_points(terrain.position, terrain.height)) {
    w.position.push_back(
        {static_cast<std::int32_t>(p.x - lattice.base_x), static_cast<std::int32_t>(p.y - lattice.base_y)});
    w.height.push_back(static_cast<std::int32_t>(z - lattice.base_z));
  }
  const auto tin = triangulate(w.position, w.height,
                               PointSetOptions{.order = options.triangulation.order,
                                               .polygon = {.objectives = options.triangulation.objectives}},
                               {});
  for (const auto& t : tin.triangles) w.triangle.insert(w.triangle.end(), t.begin(), t.end());
  w.graph = make_vertex_graph(static_cast<std::uint32_t>(w.position.size()), w.triangle);
  w.on_hull.assign(w.position.size(), 0);
  for (const DirectedEdge& e : w.graph.boundary) w.on_hull[e.origin] = w.on_hull[e.target] = 1;
  return w;
}

RemovalOptions removal_of(const PitOptions& pits) {
  constexpr RemovalMethod kMethods[] = {RemovalMethod::lift, RemovalMethod::lift, RemovalMethod::breach,
                                        RemovalMethod::greedy_breach, RemovalMethod::least_change};
  RemovalOptions out;
  out.method = kMethods[static_cast<std::size_t>(pits.method)];
  out.measure = pits.measure;
  out.limits.max_visits = kScalableVisits;
  out.limits.max_lake = pits.largest_lake;
  out.limits.max_group = pits.largest_group;
  return out;
}

std::vector<std::int32_t> removed(const Whole& w, const PitOptions& pits, std::span<const std::uint8_t> is_outlet) {
  ChangeableTerrain terrain{&w.graph, w.height, w.position, is_outlet, {}, {}, {}};
  const auto star = star_weights(w.position, w.triangle);
  if (pits.measure == ChangeMeasure::volume) terrain.weight = star;
  return remove_pits(terrain, removal_of(pits)).height;
}

/// In lattice units or vertices.
double bound_of_lakes(const Whole& w, const PitOptions& pits) {
  const ChangeableTerrain terrain{&w.graph, w.height, w.position, w.on_hull, {}, {}, {}};
  const auto level = lift(w.graph, w.height, w.on_hull);
  return std::ceil(static_cast<double>(sum_of_lake_bounds(terrain, level, pits.measure)) / double{kBoundShares});
}

PipelineOptions options_of(const Terrain& terrain, const std::string& out, std::uint64_t target) {
  PipelineOptions options = testing::options_for(terrain.files, out);
  options.pits.method = PitMethod::least_change;
  options.tiles.target_points = target;
  options.triangulation.order = 1;
  return options;
}

void expect_checked(const std::string& dir) {
  const DatasetSummary checked = check_dataset(dir, 1000);
  EXPECT_TRUE(checked.ok) << (checked.problems.empty() ? "" : checked.problems.front());
  EXPECT_EQ(checked.pits, 0U);
}

TEST(TiledPits, EveryMethodAndMeasureEqualsTheWhole) {
  const TemporaryFolder folder;
  const Terrain terrain = make_terrain(folder, 3, 20'000, 10);
  const Whole whole = make_whole(terrain, options_of(terrain, folder / "plan", kEverything));
  int serial = 0;
  for (const PitMethod method : {PitMethod::lift, PitMethod::breach, PitMethod::greedy_breach, PitMethod::least_change})
    for (const ChangeMeasure measure :
         {ChangeMeasure::total, ChangeMeasure::max, ChangeMeasure::count, ChangeMeasure::volume}) {
      PitOptions pits;
      pits.method = method;
      pits.measure = measure;
      const std::string expected = whole.fingerprint(removed(whole, pits, whole.on_hull));
      const double of_lakes = bound_of_lakes(whole, pits);
      for (const std::uint64_t target : {std::uint64_t{6'000}, std::uint64_t{1'500}}) {
        SCOPED_TRACE(std::to_string(static_cast<int>(method)) + " " + std::to_string(static_cast<int>(measure)) + " " +
                     std::to_string(target));
        PipelineOptions options = options_of(terrain, folder / std::to_string(serial++), target);
        options.pits.method = method;
        options.pits.measure = measure;
        options.run.workers = 1 + serial % 2;
        if (serial % 3 == 0) options.run.memory_bytes = std::uint64_t{64} << 20;
        const DatasetSummary got = run(options);
        EXPECT_EQ(got.fingerprint, expected);
        EXPECT_TRUE(got.ok);
        const auto report =
            nlohmann::json::parse(testing::bytes_of(options.output.dir + "/report.json"))["pit_removal"];
        const double cost = report["cost"], bound = report["bound"];
        EXPECT_LE(bound, cost);
        if (method == PitMethod::lift) {
          EXPECT_EQ(bound, cost);
        } else if (measure == ChangeMeasure::total || measure == ChangeMeasure::count) {
          EXPECT_NEAR(bound, of_lakes * (measure == ChangeMeasure::total ? 0.01 : 1), 1e-6);
          EXPECT_GT(bound, 0.01 * cost);
        }
        if (serial % 4 == 0) expect_checked(options.output.dir);
        std::filesystem::remove_all(options.output.dir);
      }
    }
}

TEST(TiledPits, LowestOutletMakesLakesAcrossManyTiles) {
  const TemporaryFolder folder;
  for (const std::uint64_t seed : {5U, 6U}) {
    const Terrain terrain = make_terrain(folder, seed, 12'000, seed == 5 ? 1 : 200);
    const Whole whole = make_whole(terrain, options_of(terrain, folder / "plan", kEverything));
    std::vector<std::uint8_t> outlet(whole.position.size(), 0);
    outlet[lowest_vertex(whole.height, whole.position)] = 1;
    for (const PitMethod method : {PitMethod::lift, PitMethod::breach, PitMethod::least_change}) {
      SCOPED_TRACE(std::to_string(seed) + " " + std::to_string(static_cast<int>(method)));
      PipelineOptions options = options_of(terrain, folder / "lowest", 1'000);
      options.pits.method = method;
      options.pits.outlets = OutletPolicy::lowest;
      EXPECT_EQ(run(options).fingerprint, whole.fingerprint(removed(whole, options.pits, outlet)));
      expect_checked(options.output.dir);
      std::filesystem::remove_all(options.output.dir);
    }
  }
}

// Of each size some lakes lie within a tile and some across.
TEST(TiledPits, LargeLakesAreRaised) {
  const TemporaryFolder folder;
  const Terrain terrain = make_terrain(folder, 4, 12'000, 10);
  const Whole whole = make_whole(terrain, options_of(terrain, folder / "plan", kEverything));
  const auto level = lift(whole.graph, whole.height, whole.on_hull);
  for (const std::uint64_t most : {std::uint64_t{1}, std::uint64_t{100}})
    for (const PitMethod method : {PitMethod::breach, PitMethod::least_change}) {
      PipelineOptions options = options_of(terrain, folder / "raised", kEverything);
      options.pits.method = method;
      options.pits.largest_lake = most;
      const std::vector<std::int32_t> expected = removed(whole, options.pits, whole.on_hull);
      PitOptions without = options.pits;
      without.largest_lake = kEverything;
      EXPECT_NE(expected, removed(whole, without, whole.on_hull));
      if (most > 1) {
        EXPECT_NE(expected, level);
      }
      std::int64_t moved = 0;
      double total = 0;
      for (std::size_t v = 0; v < expected.size(); ++v) {
        EXPECT_LE(expected[v], level[v]);
        moved += expected[v] != whole.height[v];
        total += std::abs(expected[v] - whole.height[v]) * 0.01;
      }
      for (const std::uint64_t target : {kEverything, std::uint64_t{1'000}}) {
        SCOPED_TRACE(std::to_string(most) + " " + std::to_string(static_cast<int>(method)) + " " +
                     std::to_string(target));
        options.tiles.target_points = target;
        EXPECT_EQ(run(options).fingerprint, whole.fingerprint(expected));
        expect_checked(options.output.dir);
        const auto report =
            nlohmann::json::parse(testing::bytes_of(options.output.dir + "/report.json"))["pit_removal"];
        EXPECT_EQ(report["vertices_moved"], moved);
        EXPECT_NEAR(report["total_displacement_m"].get<double>(), total, 1e-6 * total);
        EXPECT_GT(report["regions_not_drawn"], 0);
        std::filesystem::remove_all(options.output.dir);
      }
    }
}

// Groups inside a tile and across tiles, cut along squares that know nothing of tiles.
TEST(TiledPits, LargeGroupsAreCut) {
  const TemporaryFolder folder;
  for (const std::uint64_t most : {std::uint64_t{5}, std::uint64_t{150}}) {
    const Terrain terrain = make_terrain(folder, most, 12'000, most == 5 ? 10 : 1);
    const Whole whole = make_whole(terrain, options_of(terrain, folder / "plan", kEverything));
    for (const PitMethod method : {PitMethod::breach, PitMethod::least_change}) {
      PipelineOptions options = options_of(terrain, folder / "cut", kEverything);
      options.pits.method = method;
      options.pits.largest_group = most;
      if (most == 5) options.pits.largest_lake = 300;
      const std::vector<std::int32_t> expected = removed(whole, options.pits, whole.on_hull);
      PitOptions without = options.pits;
      without.largest_group = kEverything;
      EXPECT_NE(expected, removed(whole, without, whole.on_hull));
      for (const std::uint64_t target : {kEverything, std::uint64_t{1'000}}) {
        SCOPED_TRACE(std::to_string(most) + " " + std::to_string(static_cast<int>(method)) + " " +
                     std::to_string(target));
        options.tiles.target_points = target;
        EXPECT_EQ(run(options).fingerprint, whole.fingerprint(expected));
        expect_checked(options.output.dir);
        const auto report =
            nlohmann::json::parse(testing::bytes_of(options.output.dir + "/report.json"))["pit_removal"];
        EXPECT_GT(report["groups_cut"], 0);
        std::filesystem::remove_all(options.output.dir);
      }
    }
  }
}

TEST(TiledPits, LimitsAreKept) {
  const TemporaryFolder folder;
  const Terrain terrain = make_terrain(folder, 8, 8'000, 1);
  std::map<std::string, std::string> fingerprint;
  for (const std::uint64_t target : {kEverything, std::uint64_t{1'500}}) {
    for (const double depth : {0.0, 0.5}) {
      PipelineOptions options = options_of(terrain, folder / "limits", target);
      options.pits.max_breach_depth_m = depth;
      options.pits.max_breach_length_m = 20;
      const DatasetSummary got = run(options);
      const auto report = nlohmann::json::parse(testing::bytes_of(options.output.dir + "/report.json"));
      const auto [at, is_new] = fingerprint.emplace(std::to_string(depth), got.fingerprint);
      EXPECT_EQ(at->second, got.fingerprint);
      if (depth == 0) {
        EXPECT_EQ(report["pit_removal"]["vertices_lowered"], 0);
      }
      for (const auto& row : testing::read_layer(options.output.dir + "/layers.gpkg", "breaches").feature)
        EXPECT_LE(row.at("max_depth"), depth + 1e-9);
      std::filesystem::remove_all(options.output.dir);
    }
  }
  EXPECT_NE(fingerprint.begin()->second, fingerprint.rbegin()->second);
}

/// The vertices of a finished run as a terrain of its own.
Terrain result_of(const TemporaryFolder& folder, const std::string& dir, const std::string& name) {
  Terrain t;
  for (const testing::Place& v : testing::read_surface(dir).vertex) {
    t.position.push_back(
        {static_cast<std::int32_t>((v[0] - 500'000'000) / 10), static_cast<std::int32_t>((v[1] - 4'000'000'000) / 10)});
    t.height.push_back(static_cast<std::int32_t>(v[2] / 10));
  }
  t.files = testing::write_files(folder, t.position, t.height, 1, name);
  return t;
}

// At order 0 the triangles do not depend on the heights: the second run sees the terrain that the first one made.
TEST(TiledPits, OnItsOwnResultNothingChanges) {
  const TemporaryFolder folder;
  const Terrain terrain = make_terrain(folder, 11, 8'000, 20);
  for (const PitMethod method : {PitMethod::breach, PitMethod::least_change}) {
    PipelineOptions options = options_of(terrain, folder / "once", 2'000);
    options.triangulation.order = 0;
    options.output.mesh_ply = true;
    options.pits.method = method;
    const DatasetSummary once = run(options);
    const Terrain result = result_of(folder, options.output.dir, "result" + std::to_string(static_cast<int>(method)));
    PipelineOptions again = options_of(result, folder / "twice", 1'300);
    again.triangulation.order = 0;
    again.pits.method = method;
    const DatasetSummary twice = run(again);
    EXPECT_EQ(twice.vertices, once.vertices);
    const auto report = nlohmann::json::parse(testing::bytes_of(again.output.dir + "/report.json"));
    EXPECT_EQ(report["pit_removal"]["pits_before"], 0);
    EXPECT_EQ(report["pit_removal"]["vertices_moved"], 0);
    std::filesystem::remove_all(options.output.dir);
    std::filesystem::remove_all(again.output.dir);
  }
}

TEST(TiledPits, LayersAddUpToTheChange) {
  const TemporaryFolder folder;
  const Terrain terrain = make_terrain(folder, 13, 10'000, 10);
  std::optional<std::string> csv;
  for (const std::uint64_t target : {kEverything, std::uint64_t{1'500}}) {
    PipelineOptions options = options_of(terrain, folder / "layers", target);
    options.output.dem.enabled = true;
    options.output.dem.cell_m = 2;
    const DatasetSummary got = run(options);
    ASSERT_TRUE(got.ok);
    const std::string& dir = options.output.dir;
    const auto report = nlohmann::json::parse(testing::bytes_of(dir + "/report.json"))["pit_removal"];
    const auto lifted = testing::read_layer(dir + "/layers.gpkg", "lifted");
    const auto breaches = testing::read_layer(dir + "/layers.gpkg", "breaches");
    double displacement = 0, volume = 0;
    for (const auto* layer : {&lifted, &breaches})
      for (const auto& row : layer->feature) {
        displacement += row.at("displacement");
        volume += row.at("volume");
        EXPECT_GE(row.at("displacement"), 0);
      }
    EXPECT_GT(lifted.feature.size(), 5U);
    EXPECT_GT(breaches.feature.size(), 5U);
    EXPECT_NEAR(displacement, report["total_displacement_m"].get<double>(), 1e-6);
    EXPECT_NEAR(volume, report["volume_m3"].get<double>(), 1e-6 * volume);
    EXPECT_EQ(lifted.feature.size(), report["lifted_regions"].get<std::size_t>());
    EXPECT_EQ(breaches.feature.size(), report["breaches"].get<std::size_t>());
    EXPECT_EQ(report["pits_left"], 0);
    EXPECT_LE(report["bound"].get<double>(), report["cost"].get<double>());
    const std::string table = testing::bytes_of(dir + "/pits.csv");
    EXPECT_GT(table.size(), 1000U);
    if (csv) {
      EXPECT_TRUE(table == *csv);
    }
    csv = table;
    EXPECT_EQ(testing::read_layer(dir + "/layers.gpkg", "pits").feature.size(),
              report["pits_before"].get<std::size_t>());
    // The raster of the change is the difference of two DEMs, and has no value where nothing changed.
    PipelineOptions measured = options;
    measured.output.dir = folder / "measured";
    measured.pits.method = PitMethod::none;
    static_cast<void>(run(measured));
    const Raster after = read_raster(dir + "/dem.tif"), before = read_raster(measured.output.dir + "/dem.tif"),
                 change = read_raster(dir + "/change.tif");
    ASSERT_EQ(change.value.size(), after.value.size());
    std::size_t changed = 0;
    for (std::size_t i = 0; i < change.value.size(); ++i) {
      if (change.is_nodata(i)) {
        EXPECT_EQ(after.value[i], before.value[i]);
        continue;
      }
      ++changed;
      EXPECT_NEAR(change.value[i], after.value[i] - before.value[i], 1e-3);
    }
    EXPECT_GT(changed, 100U);
    EXPECT_FALSE(std::filesystem::exists(measured.output.dir + "/change.tif"));
    std::filesystem::remove_all(measured.output.dir);
    std::filesystem::remove_all(dir);
  }
}

TEST(TiledPits, KeptPitsStayAndAreChecked) {
  const TemporaryFolder folder;
  const Terrain terrain = make_terrain(folder, 17, 10'000, 10);
  const Whole whole = make_whole(terrain, options_of(terrain, folder / "plan", kEverything));
  const auto pits = pit_hierarchy(whole.graph, whole.triangle, whole.height, whole.position, whole.on_hull);
  ASSERT_GT(pits.size(), 50U);
  for (const std::uint64_t target : {kEverything, std::uint64_t{1'500}})
    for (const bool by_price : {false, true}) {
      SCOPED_TRACE(std::to_string(target) + (by_price ? " cheapest" : " ids"));
      PipelineOptions options = options_of(terrain, folder / "kept", target);
      std::vector<std::uint8_t> is_kept(pits.size(), 0);
      if (by_price) {
        options.pits.cheapest = 20;
        is_kept = keep_all_but_cheapest(pits, 20);
      } else {
        options.pits.keep.ids = {1, 7, 30};
        for (const std::uint64_t id : options.pits.keep.ids) is_kept[id] = 1;
      }
      const auto outlets = outlets_and_kept_pits(whole.graph, whole.height, whole.on_hull, pits, is_kept);
      EXPECT_EQ(run(options).fingerprint, whole.fingerprint(removed(whole, options.pits, outlets)));
      expect_checked(options.output.dir);
      const auto layer = testing::read_layer(options.output.dir + "/layers.gpkg", "pits");
      ASSERT_EQ(layer.feature.size(), pits.size());
      for (std::size_t i = 0; i < pits.size(); ++i) {
        EXPECT_EQ(layer.feature[i].at("kept"), is_kept[i]);
        EXPECT_EQ(layer.feature[i].at("vertices"), static_cast<double>(pits[i].num_vertices));
      }
      std::filesystem::remove_all(options.output.dir);
    }
  PipelineOptions beyond = options_of(terrain, folder / "beyond", kEverything);
  beyond.pits.keep.ids = {1'000'000};
  EXPECT_NE(
      testing::error_of([&] { static_cast<void>(run(beyond)); }, ErrorKind::config).find("there is no pit 1000000"),
      std::string::npos);
}

/// World coordinates of a point of the terrain's files.
VectorPoint world(LatticePoint p) {
  return {500'000 + p.x * 0.01, 4'000'000 + p.y * 0.01, 0};
}

TEST(TiledPits, OutletsOfALayer) {
  const TemporaryFolder folder;
  const Terrain terrain = make_terrain(folder, 19, 8'000, 10);
  const PipelineOptions plain = options_of(terrain, folder / "plan", kEverything);
  const Whole whole = make_whole(terrain, plain);
  const Lattice lattice = make_plan(plain).lattice;
  LatticeBox box;
  for (const LatticePoint p : terrain.position) box.extend(p);
  const auto at = [&](double fx, double fy) {
    return LatticePoint{static_cast<std::int32_t>(box.min.x + fx * (box.max.x - box.min.x)),
                        static_cast<std::int32_t>(box.min.y + fy * (box.max.y - box.min.y))};
  };
  const std::vector<LatticePoint> sea{at(0.2, 0.2), at(0.45, 0.25), at(0.3, 0.5)}, river{at(0.6, 0.1), at(0.8, 0.7)};
  const LatticePoint well = at(0.25, 0.8);
  {
    GeoPackageWriter out(folder / "sea.gpkg", read_las_header(terrain.files.front()).crs_wkt);
    const int polygons = out.add_layer("sea", VectorGeometry::polygon, false, {});
    const int lines = out.add_layer("river", VectorGeometry::line, false, {});
    const int points = out.add_layer("well", VectorGeometry::point, false, {});
    std::vector<VectorPoint> ring, line;
    for (const LatticePoint p : sea) ring.push_back(world(p));
    for (const LatticePoint p : river) line.push_back(world(p));
    out.add_polygon(polygons, ring, {});
    out.add_line(lines, line, {});
    out.add_point(points, world(well), {});
    out.finish();
  }
  // From the definition, in the coordinates of the whole.
  const auto moved = [&](LatticePoint p) {
    return LatticePoint{static_cast<std::int32_t>(p.x - lattice.base_x),
                        static_cast<std::int32_t>(p.y - lattice.base_y)};
  };
  const auto side = [](LatticePoint a, LatticePoint b, LatticePoint c) {
    const double d = (static_cast<double>(b.x) - a.x) * (static_cast<double>(c.y) - a.y) -
                     (static_cast<double>(b.y) - a.y) * (static_cast<double>(c.x) - a.x);
    return d > 0 ? 1 : d < 0 ? -1 : 0;
  };
  std::vector<std::uint8_t> outlet(whole.position.size(), 0);
  for (std::size_t v = 0; v < outlet.size(); ++v) {
    const LatticePoint p = whole.position[v];
    outlet[v] = side(moved(sea[0]), moved(sea[1]), p) >= 0 && side(moved(sea[1]), moved(sea[2]), p) >= 0 &&
                side(moved(sea[2]), moved(sea[0]), p) >= 0;
  }
  const LatticePoint r0 = moved(river[0]), r1 = moved(river[1]), w = moved(well);
  for (std::size_t t = 0; t < whole.triangle.size(); t += 3) {
    const std::uint32_t* v = &whole.triangle[t];
    const auto corner = [&](std::size_t i) { return whole.position[v[i % 3]]; };
    const auto holds = [&](LatticePoint p) {
      return side(corner(0), corner(1), p) >= 0 && side(corner(1), corner(2), p) >= 0 &&
             side(corner(2), corner(0), p) >= 0;
    };
    bool meets = holds(w) || holds(r0) || holds(r1);
    for (std::size_t i = 0; i < 3; ++i)
      meets = meets || (side(corner(i), corner(i + 1), r0) * side(corner(i), corner(i + 1), r1) <= 0 &&
                        side(r0, r1, corner(i)) * side(r0, r1, corner(i + 1)) <= 0);
    if (!meets) continue;
    std::uint32_t lowest = v[0];
    for (const std::uint32_t u : {v[1], v[2]})
      if (std::tie(whole.height[u], whole.position[u]) < std::tie(whole.height[lowest], whole.position[lowest]))
        lowest = u;
    outlet[lowest] = 1;
  }
  for (const std::uint64_t target : {kEverything, std::uint64_t{1'000}}) {
    PipelineOptions options = options_of(terrain, folder / "layer", target);
    options.pits.outlets = OutletPolicy::layer;
    options.pits.outlet_layer = folder / "sea.gpkg";
    EXPECT_EQ(run(options).fingerprint, whole.fingerprint(removed(whole, options.pits, outlet)));
    expect_checked(options.output.dir);
    std::filesystem::remove_all(options.output.dir);
  }
  // Features far from the terrain are no outlets: an error, not a terrain without a way out.
  {
    GeoPackageWriter out(folder / "far.gpkg", read_las_header(terrain.files.front()).crs_wkt);
    const int points = out.add_layer("far", VectorGeometry::point, false, {});
    out.add_point(points, {500'000 - 5'000, 4'000'000, 0}, {});
    out.finish();
  }
  PipelineOptions far = options_of(terrain, folder / "far", kEverything);
  far.pits.outlets = OutletPolicy::layer;
  far.pits.outlet_layer = folder / "far.gpkg";
  EXPECT_NE(testing::error_of([&] { static_cast<void>(run(far)); }, ErrorKind::input).find("water could leave nowhere"),
            std::string::npos);
}

TEST(TiledPits, VoidsMayDrain) {
  const TemporaryFolder folder;
  Terrain terrain = make_terrain(folder, 23, 9'000, 10);
  LatticeBox box;
  for (const LatticePoint p : terrain.position) box.extend(p);
  const double x = (static_cast<double>(box.min.x) + box.max.x) / 2,
               y = (static_cast<double>(box.min.y) + box.max.y) / 2;
  Terrain holed;
  for (std::size_t i = 0; i < terrain.position.size(); ++i)
    if (std::hypot(terrain.position[i].x - x, terrain.position[i].y - y) >
        0.15 * (static_cast<double>(box.max.x) - box.min.x)) {
      holed.position.push_back(terrain.position[i]);
      holed.height.push_back(terrain.height[i]);
    }
  holed.files = testing::write_files(folder, holed.position, holed.height, 2, "holed_");
  const PipelineOptions plain = options_of(holed, folder / "plan", kEverything);
  const Whole whole = make_whole(holed, plain);
  const double limit_m = 0.01 * 0.08 * (static_cast<double>(box.max.x) - box.min.x);
  std::vector<std::uint8_t> outlet = whole.on_hull;
  std::size_t num_void = 0;
  for (std::size_t t = 0; t < whole.triangle.size(); t += 3) {
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const LatticePoint a = whole.position[whole.triangle[t + i]], b = whole.position[whole.triangle[t + (i + 1) % 3]];
      longest = std::max(longest, std::hypot(static_cast<double>(a.x) - b.x, static_cast<double>(a.y) - b.y) * 0.01);
    }
    if (longest <= limit_m) continue;
    ++num_void;
    for (std::size_t i = 0; i < 3; ++i) outlet[whole.triangle[t + i]] = 1;
  }
  ASSERT_GT(num_void, 10U);
  for (const std::uint64_t target : {kEverything, std::uint64_t{1'500}}) {
    PipelineOptions options = options_of(holed, folder / "voids", target);
    options.pits.voids_drain = true;
    options.pits.void_edge_m = limit_m;
    EXPECT_EQ(run(options).fingerprint, whole.fingerprint(removed(whole, options.pits, outlet)));
    expect_checked(options.output.dir);
    std::filesystem::remove_all(options.output.dir);
  }
}

}  // namespace
}  // namespace hydrotin
