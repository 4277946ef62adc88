#include "config.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "hydrotin/error.h"
#include "progress_display.h"
#include "small_points.h"
#include "temporary_folder.h"

namespace hydrotin::app {
namespace {

using testing::read_text;
using testing::TemporaryFolder;
using testing::write_text;

const std::string kMinimal = "input: {points: [\"tiles/*.laz\"]}\n";

PipelineOptions options_of(const TemporaryFolder& folder, const std::string& text,
                           const std::vector<std::string>& sets = {}) {
  write_text(folder / "c.yaml", text);
  std::vector<ConfigOverride> overrides;
  for (const auto& set : sets) overrides.push_back(parse_override(set));
  return read_config(folder / "c.yaml", overrides);
}

/// The message of the config error without the folder's name.
std::string config_error(const std::string& text, const std::vector<std::string>& sets = {}) {
  const TemporaryFolder folder;
  try {
    (void)options_of(folder, text, sets);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::config);
    std::string message = error.what();
    const std::string prefix = folder.path().string() + "/";
    if (message.starts_with(prefix)) message.erase(0, prefix.size());
    return message;
  }
  return "no error";
}

TEST(Config, Defaults_SuitClassifiedGround) {
  const TemporaryFolder folder;
  const PipelineOptions options = options_of(folder, kMinimal);
  EXPECT_EQ(options.input.points, (std::vector<std::string>{(folder / "tiles/*.laz").string()}));
  EXPECT_EQ(options.input.classes, (std::vector<std::uint8_t>{2}));
  EXPECT_FALSE(options.input.withheld);
  EXPECT_EQ(options.output.dir, (folder / "out").string());
  EXPECT_TRUE(options.output.dem.enabled);
  EXPECT_EQ(options.output.dem.cell_m, 1.0);
  EXPECT_EQ(options.tiles.target_points, 4'000'000U);
  EXPECT_EQ(options.triangulation.order, 2);
  EXPECT_EQ(options.triangulation.objectives, Objectives{Objective::local_minima});
  EXPECT_EQ(options.pits.method, PitMethod::least_change);
  EXPECT_EQ(options.pits.measure, ChangeMeasure::total);
  EXPECT_FALSE(options.pits.keep.any());
  EXPECT_FALSE(options.pits.voids_drain);
  EXPECT_EQ(options.pits.outlets, OutletPolicy::hull);
  EXPECT_EQ(options.run.workers, 0);
  EXPECT_EQ(options.run.memory_bytes, std::uint64_t{4} << 30);
}

TEST(Config, EveryKey_IsRead) {
  const TemporaryFolder folder;
  const PipelineOptions options = options_of(folder, R"(
input:
  points: [a.las, "/data/b*.laz", /vsis3/bucket/c.laz]
  classes: [9, 2, 2]
  crs: EPSG:2154
  withheld: true
  synthetic: false
output:
  dir: ../results
  dem: {cell_m: 0.5, max_edge_m: 25, format: tiles, hillshade: false}
  mesh: []
  keep: always
tiles: {target_points: 1000}
triangulation: {order: 0, objective: min-weight}
pits: {method: none, outlets: lowest}
run: {workers: 3, memory: 500MB, scratch: /tmp/w}
)");
  EXPECT_EQ(options.input.points,
            (std::vector<std::string>{(folder / "a.las").string(), "/data/b*.laz", "/vsis3/bucket/c.laz"}));
  EXPECT_EQ(options.input.classes, (std::vector<std::uint8_t>{2, 9}));
  EXPECT_EQ(options.input.crs, "EPSG:2154");
  EXPECT_TRUE(options.input.withheld);
  EXPECT_FALSE(options.input.synthetic);
  EXPECT_EQ(options.output.dir, (folder.path().parent_path() / "results").string());
  EXPECT_EQ(options.output.dem.cell_m, 0.5);
  EXPECT_EQ(options.output.dem.max_edge_m, 25);
  EXPECT_FALSE(options.output.dem.cog);
  EXPECT_FALSE(options.output.dem.hillshade);
  EXPECT_FALSE(options.output.mesh_ply);
  EXPECT_EQ(options.output.keep, KeepWork::always);
  EXPECT_EQ(options.tiles.target_points, 1000U);
  EXPECT_EQ(options.triangulation.order, 0);
  EXPECT_EQ(options.triangulation.objectives, Objectives{Objective::min_weight});
  EXPECT_EQ(options.pits.method, PitMethod::none);
  EXPECT_EQ(options.pits.outlets, OutletPolicy::lowest);
  EXPECT_EQ(options.run.workers, 3);
  EXPECT_EQ(options.run.memory_bytes, 500'000'000U);
  EXPECT_EQ(options.run.scratch, "/tmp/w");
}

TEST(Config, KeysOfPits_AreRead) {
  const TemporaryFolder folder;
  testing::write_text(folder / "sea.gpkg", "only its name matters here");
  const PitOptions pits = options_of(folder, kMinimal + R"(
pits:
  method: greedy-breach
  measure: volume
  max_breach_length_m: 40.5
  max_breach_depth_m: 3
  largest_lake: 20000
  largest_group: 3000
  keep: {deeper_than_m: 2.5, larger_than_m2: 800, volume_above_m3: 12, inside: ponds.gpkg, ids: [4, 7], combine: and}
  outlets: sea.gpkg
  voids_drain: true
  void_edge_m: 30
)")
                              .pits;
  EXPECT_EQ(pits.method, PitMethod::greedy_breach);
  EXPECT_EQ(pits.measure, ChangeMeasure::volume);
  EXPECT_EQ(pits.max_breach_length_m, 40.5);
  EXPECT_EQ(pits.max_breach_depth_m, 3);
  EXPECT_EQ(pits.largest_lake, 20'000U);
  EXPECT_EQ(pits.largest_group, 3'000U);
  EXPECT_EQ(pits.keep.deeper_than_m, 2.5);
  EXPECT_EQ(pits.keep.larger_than_m2, 800);
  EXPECT_EQ(pits.keep.volume_above_m3, 12);
  EXPECT_EQ(pits.keep.inside, (folder / "ponds.gpkg").string());
  EXPECT_EQ(pits.keep.ids, (std::vector<std::uint64_t>{4, 7}));
  EXPECT_TRUE(pits.keep.all_conditions);
  EXPECT_EQ(pits.outlets, OutletPolicy::layer);
  EXPECT_EQ(pits.outlet_layer, (folder / "sea.gpkg").string());
  EXPECT_TRUE(pits.voids_drain);
  EXPECT_EQ(pits.void_edge_m, 30);
  EXPECT_EQ(options_of(folder, kMinimal + "pits: {cheapest: 12}\n").pits.cheapest, 12U);
}

TEST(Config, ImpossiblePits_AreRefused) {
  EXPECT_EQ(config_error(kMinimal + "pits: {outlets: nowhere.gpkg}\n"),
            "c.yaml:2:17: pits.outlets: 'nowhere.gpkg' is not possible (allowed: hull, lowest, or a file of points, "
            "lines or polygons)");
  EXPECT_EQ(config_error(kMinimal + "pits: {keep: {deeper_than_m: -1}}\n"),
            "c.yaml:2:30: pits.keep.deeper_than_m: '-1' is not possible (allowed: a number from 0 on)");
  EXPECT_EQ(config_error(kMinimal + "pits: {cheapest: 3, keep: {ids: [1]}}\n"),
            "c.yaml:2:18: pits.cheapest: it says which pits to keep, as pits.keep does (give one of the two)");
}

TEST(Config, RastersMayStandForPoints) {
  const TemporaryFolder folder;
  write_text(folder / "c.yaml",
             "input: {dem: [a.tif, /vsizip/b.zip/b.tif], dem_band: 2, dem_quantum_m: 0.01, dem_nodata: -32768}\n");
  const PipelineOptions options = read_config(folder / "c.yaml", {});
  EXPECT_TRUE(options.input.points.empty());
  EXPECT_EQ(options.input.dem, (std::vector<std::string>{(folder / "a.tif").string(), "/vsizip/b.zip/b.tif"}));
  EXPECT_EQ(options.input.dem_band, 2);
  EXPECT_EQ(options.input.dem_quantum_m, 0.01);
  EXPECT_EQ(options.input.dem_nodata, -32768);
  EXPECT_EQ(
      config_error("input: {dem: []}\n"),
      "c.yaml:1:14: input.dem: a list is not possible (allowed: a list of rasters or patterns that is not empty)");
  EXPECT_EQ(config_error("input: {dem: a.tif, dem_band: 0}\n"),
            "c.yaml:1:31: input.dem_band: '0' is not possible (allowed: an integer from 1 to 100000)");
}

TEST(Config, ThinningMakesTheRemovedPointsTheReference) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& more) {
    write_text(folder / "c.yaml", kMinimal + more);
    return read_config(folder / "c.yaml", {});
  };
  const PipelineOptions thinned = read("thin: {vertical_error_m: 0.25, cell_m: 6, prune: false}\n");
  EXPECT_EQ(thinned.thin.vertical_error_m, 0.25);
  EXPECT_EQ(thinned.thin.cell_m, 6);
  EXPECT_FALSE(thinned.thin.prune);
  EXPECT_TRUE(thinned.triangulation.removed_reference);
  const PipelineOptions both = read(
      "thin: {vertical_error_m: 1}\ntriangulation: {reference: [removed, held_out.las], objective: "
      "min-squared-error}\n");
  EXPECT_TRUE(both.triangulation.removed_reference);
  EXPECT_EQ(both.triangulation.reference, (std::vector<std::string>{(folder / "held_out.las").string()}));
  EXPECT_FALSE(
      read("thin: {vertical_error_m: 1}\ntriangulation: {reference: other.las}\n").triangulation.removed_reference);
  EXPECT_FALSE(read("").triangulation.removed_reference);
  EXPECT_EQ(config_error(kMinimal + "thin: {cell_m: 6}\n"),
            "c.yaml:2:16: thin.cell_m: nothing is thinned (give thin.vertical_error_m)");
  EXPECT_EQ(config_error(kMinimal + "triangulation: {reference: removed}\n"),
            "c.yaml:2:28: triangulation.reference: nothing is removed (give thin.vertical_error_m)");
}

TEST(Config, Errors_NameLineAndColumn) {
  EXPECT_EQ(config_error("input:\n  points: a.laz\n  clases: [2]\n"),
            "c.yaml:3:3: unknown key 'clases' in input (allowed: points, dem, dem_band, dem_quantum_m, dem_nodata, "
            "classes, rivers, lakes, crs, withheld, synthetic)");
  EXPECT_EQ(config_error(kMinimal + "triangulation:\n  order: two\n"),
            "c.yaml:3:10: triangulation.order: 'two' is not possible (allowed: an integer from 0 to 6)");
  EXPECT_EQ(config_error(kMinimal + "triangulation: {order: 7}\n"),
            "c.yaml:2:24: triangulation.order: '7' is not possible (allowed: an integer from 0 to 6)");
  EXPECT_EQ(config_error(kMinimal + "triangulation: {order: 1.5}\n"),
            "c.yaml:2:24: triangulation.order: '1.5' is not possible (allowed: an integer from 0 to 6)");
  EXPECT_EQ(config_error(kMinimal + "triangulation: {order: \"2\"}\n"),
            "c.yaml:2:24: triangulation.order: '2' is not possible (allowed: an integer from 0 to 6)");
  EXPECT_EQ(config_error(kMinimal + "triangulation: {order: [2]}\n"),
            "c.yaml:2:24: triangulation.order: a list is not possible (allowed: an integer from 0 to 6)");
  const std::string allowed =
      "delaunay, min-weight, local-minima, min-max-edge, max-min-angle, min-max-angle, min-max-circumradius, "
      "min-max-enclosing-circle, min-max-area, max-min-area, max-sum-inradius, min-sum-inradius, min-squared-error, "
      "min-absolute-error, min-max-error, min-max-order; or a list of them by priority";
  EXPECT_EQ(config_error(kMinimal + "triangulation: {objective: best}\n"),
            "c.yaml:2:28: triangulation.objective: 'best' is not possible (allowed: " + allowed + ")");
  EXPECT_EQ(config_error(kMinimal + "triangulation: {objective: [min-weight, 3]}\n"),
            "c.yaml:2:41: triangulation.objective: '3' is not possible (allowed: " + allowed + ")");
  EXPECT_EQ(config_error(kMinimal + "triangulation: {objective: []}\n"),
            "c.yaml:2:28: triangulation.objective: '' is not possible: no objective is given");
  EXPECT_EQ(
      config_error(kMinimal + "triangulation: {objective: [min-weight, local-minima, min-weight]}\n"),
      "c.yaml:2:28: triangulation.objective: 'min-weight,local-minima,min-weight' is not possible: 'min-weight' is "
      "given twice");
  EXPECT_EQ(config_error(kMinimal + "triangulation: {objective: [min-weight, delaunay]}\n"),
            "c.yaml:2:28: triangulation.objective: 'min-weight,delaunay' is not possible: 'delaunay' must stand alone");
  for (const std::string coupled : {"min-max-degree", "min-max-area-ratio", "min-max-normal-angle", "max-convex-edges"})
    EXPECT_EQ(config_error(kMinimal + "triangulation: {objective: " + coupled + "}\n"),
              "c.yaml:2:28: triangulation.objective: '" + coupled +
                  "' couples neighbouring polygons, which tiles solve apart; use hydrotin triangulate");
  for (const std::string error : {"min-squared-error", "min-absolute-error", "min-max-error"})
    EXPECT_EQ(config_error(kMinimal + "triangulation: {objective: [local-minima, " + error + "]}\n"),
              "c.yaml:2:28: triangulation.objective: '" + error +
                  "' needs reference points; give their files as triangulation.reference");
  EXPECT_EQ(config_error(kMinimal + "triangulation: {max_error_m: 0.2}\n"),
            "c.yaml:2:30: triangulation.max_error_m: errors are those of reference points (give "
            "triangulation.reference)");
  EXPECT_EQ(config_error(kMinimal + "triangulation: {reference: r.las, max_error_m: -1}\n"),
            "c.yaml:2:48: triangulation.max_error_m: '-1' is not possible (allowed: a height in metres from 0 to "
            "1000000)");
  EXPECT_EQ(config_error(kMinimal + "triangulation: 3\n"),
            "c.yaml:2:16: triangulation: '3' is not possible (allowed: a section with order, objective, reference, "
            "max_error_m, budget)");
  EXPECT_EQ(config_error(kMinimal + "output: {dem: {cell_m: -1}}\n"),
            "c.yaml:2:24: output.dem.cell_m: '-1' is not possible (allowed: a length in metres from 0.001 to 1000000)");
  EXPECT_EQ(config_error(kMinimal + "output: {dem: {cell_m: nan}}\n").rfind("c.yaml:2:24: ", 0), 0U);
  EXPECT_EQ(config_error(kMinimal + "output: {dem: {hillshade: yes}}\n"),
            "c.yaml:2:27: output.dem.hillshade: 'yes' is not possible (allowed: true, false)");
  EXPECT_EQ(
      config_error(kMinimal + "run: {memory: 4Gib}\n").rfind("c.yaml:2:15: run.memory: '4Gib' is not possible", 0), 0U);
  EXPECT_EQ(config_error(kMinimal + "run: {memory: 1MiB}\n").rfind("c.yaml:2:15: ", 0), 0U);
  EXPECT_EQ(config_error(kMinimal + "run: {workers: 0}\n"),
            "c.yaml:2:16: run.workers: '0' is not possible (allowed: auto, or an integer from 1 to 1024)");
  EXPECT_EQ(
      config_error(kMinimal + "surprise: 1\n"),
      "c.yaml:2:1: unknown key 'surprise' in the config (allowed: input, output, tiles, thin, triangulation, rivers, "
      "pits, run)");
  EXPECT_EQ(config_error("input:\n  points: [a.laz, [b]]\n").rfind("c.yaml:2:19: input.points: every item", 0), 0U);
  EXPECT_EQ(config_error("input: {points: []}\n").rfind("c.yaml:1:17: input.points: a list is not possible", 0), 0U);
  EXPECT_EQ(config_error("input: {points: a.laz, classes: [2, 256]}\n").rfind("c.yaml:1:37: input.classes: '256'", 0),
            0U);
  EXPECT_EQ(config_error("input: {points: a.laz, crs: Mars}\n").rfind("c.yaml:1:29: input.crs: 'Mars' names no", 0),
            0U);
  EXPECT_EQ(config_error("input: {points: a.laz, points: b.laz}\n"), "c.yaml:1:24: the key 'points' stands here twice");
  EXPECT_EQ(config_error("input: {classes: [2]}\n").rfind("c.yaml:1:8: input.points is missing", 0), 0U);
  EXPECT_EQ(config_error("").rfind("c.yaml: input.points is missing", 0), 0U);
  EXPECT_EQ(config_error("- a\n- b\n"), "c.yaml:1:1: a config is sections of 'key: value' lines");
  EXPECT_EQ(config_error("input: {points: a.laz\n").rfind("c.yaml:2:1: is not YAML: ", 0), 0U);
  EXPECT_EQ(config_error(kMinimal + "---\nrun: {}\n").find("a second YAML document") == std::string::npos, false);
}

TEST(Config, Rivers_AreReadAndChecked) {
  const TemporaryFolder folder;
  const std::string lines = "input: {points: a.laz, rivers: r.gpkg}\n";
  const RiverOptions plain = options_of(folder, lines).rivers;
  EXPECT_EQ(plain.lines, (folder / "r.gpkg").string());
  EXPECT_TRUE(plain.lakes.empty());
  EXPECT_FALSE(plain.matching.insert);
  EXPECT_EQ(plain.matching.direction, LineDirection::automatic);
  EXPECT_EQ(plain.constraints.decline_measure, DeclineMeasure::fraction);
  EXPECT_EQ(plain.constraints.decline, 0.1);
  EXPECT_TRUE(plain.constraints.limit_edge_slope);
  EXPECT_EQ(plain.constraints.edge_slope_change, 0.5);
  EXPECT_EQ(plain.constraints.max_change, 0);
  const RiverOptions full =
      options_of(folder,
                 "input: {points: a.laz, rivers: r.gpkg, lakes: /data/l.shp}\n"
                 "rivers: {variant: VFR, decline: 0.02, max_edge_slope_change: 30%, max_change_m: 5, "
                 "side_slope: 0.01, contiguous: 3, triangle_directions: 4, max_triangle_slope_change: 0.2, "
                 "flow: true, valley: false, river_only: true, match: insert, use_z: true, direction: "
                 "attribute, direction_field: way, reversed_values: [up, -1], name_field: name, "
                 "lake_level_field: z, crs: EPSG:3358, points_out: gpkg, "
                 "time_limit: 2.5, preserve_edges: e.shp, preserve: both}\n")
          .rivers;
  EXPECT_EQ(full.lakes, "/data/l.shp");
  EXPECT_EQ(full.constraints.decline_measure, DeclineMeasure::slope);
  EXPECT_EQ(full.constraints.decline, 0.02);
  EXPECT_FALSE(full.constraints.limit_edge_slope);
  EXPECT_DOUBLE_EQ(full.constraints.edge_slope_change, 0.3);
  EXPECT_EQ(full.constraints.max_change, 5);
  EXPECT_EQ(full.constraints.side_slope, 0.01);
  EXPECT_EQ(full.constraints.contiguity, Contiguity::imaginary_points);
  EXPECT_EQ(full.constraints.imaginary_points, 3U);
  EXPECT_EQ(full.constraints.directions.size(), 4U);
  EXPECT_EQ(full.constraints.triangle_slope_change, 0.2);
  EXPECT_TRUE(full.constraints.flow);
  EXPECT_FALSE(full.constraints.valley);
  EXPECT_TRUE(full.constraints.river_only);
  EXPECT_TRUE(full.matching.insert);
  EXPECT_TRUE(full.use_z);
  EXPECT_EQ(full.matching.direction, LineDirection::attribute);
  EXPECT_EQ(full.direction_field, "way");
  EXPECT_EQ(full.reversed_values, (std::vector<std::string>{"up", "-1"}));
  EXPECT_EQ(full.name_field, "name");
  EXPECT_EQ(full.lake_level_field, "z");
  EXPECT_EQ(full.crs, "EPSG:3358");
  EXPECT_EQ(full.points_out, PointsFile::gpkg);
  EXPECT_EQ(plain.points_out, PointsFile::none);
  EXPECT_EQ(full.time_limit, 2.5);
  EXPECT_EQ(full.preserve_edges, (folder / "e.shp").string());
  EXPECT_TRUE(full.preserve_drainage && full.preserve_curvature);
  EXPECT_TRUE(plain.preserve_edges.empty() && plain.time_limit == 0 && plain.method == RiverMethod::lp);
  EXPECT_EQ(options_of(folder, lines + "rivers: {method: dp, decline: 1%}\n").rivers.method, RiverMethod::dp);
  EXPECT_EQ(
      config_error(lines + "rivers: {method: dp, contiguous: exact}\n"),
      "c.yaml:2:18: rivers.method: dp moves river vertices for flow, valley, decline and side slope only, and ends "
      "by itself, so not with rivers.contiguous (leave that out, or give lp)");
  EXPECT_EQ(config_error(lines + "rivers: {method: dp, flow: false}\n").find("rivers.flow") == std::string::npos,
            false);
  EXPECT_EQ(config_error(lines + "rivers: {preserve: both}\n"),
            "c.yaml:2:20: rivers.preserve: there are no edges (give rivers.preserve_edges)");
  EXPECT_EQ(config_error(lines + "rivers: {time_limit: 0}\n"),
            "c.yaml:2:22: rivers.time_limit: '0' is not possible (allowed: seconds, above 0)");
  EXPECT_EQ(options_of(folder, lines + "rivers: {variant: VF}\n").rivers.constraints.decline_measure,
            DeclineMeasure::none);

  EXPECT_EQ(config_error(kMinimal + "rivers: {variant: VFRS}\n"),
            "c.yaml:2:9: rivers: there are none (give their lines as input.rivers)");
  EXPECT_EQ(config_error("input: {points: a.laz, lakes: l.gpkg}\n"),
            "c.yaml:1:31: input.lakes: lakes are those that rivers run through (give input.rivers)");
  EXPECT_EQ(config_error(lines + "rivers: {variant: FV}\n"),
            "c.yaml:2:19: rivers.variant: 'FV' is not possible (allowed: VF, VFR, VFRS)");
  EXPECT_EQ(config_error(lines + "rivers: {decline: -1%}\n"),
            "c.yaml:2:19: rivers.decline: '-1%' is not possible (write 10%, 1deg or rise over run, not negative)");
  EXPECT_EQ(config_error(lines + "rivers: {max_edge_slope_change: 1deg}\n"),
            "c.yaml:2:33: rivers.max_edge_slope_change: '1deg' is not possible (write 50% of the old slope, or 0.5)");
  EXPECT_EQ(config_error(lines + "rivers: {max_change_m: 0}\n"),
            "c.yaml:2:24: rivers.max_change_m: '0' is not possible (allowed: a height in metres above 0)");
  EXPECT_EQ(config_error(lines + "rivers: {use_z: true}\n"),
            "c.yaml:2:17: rivers.use_z: snapped rivers keep the heights of the terrain (give rivers.match: insert)");
  EXPECT_EQ(config_error(lines + "rivers: {direction: attribute}\n"),
            "c.yaml:2:9: rivers.direction: attribute and rivers.direction_field belong together (give both or none)");
  EXPECT_EQ(config_error(lines + "rivers: {lake_level_field: z}\n"),
            "c.yaml:2:28: rivers.lake_level_field: there are no lakes (give input.lakes)");
  EXPECT_EQ(config_error(lines + "rivers: {contiguous: some}\n").rfind("c.yaml:2:22: rivers.contiguous: 'some'", 0),
            0U);
  EXPECT_EQ(config_error(lines + "rivers: {depth: 3}\n").rfind("c.yaml:2:10: unknown key 'depth' in rivers", 0), 0U);
}

TEST(Config, MethodsThatAreNone_AreRefused) {
  EXPECT_EQ(config_error(kMinimal + "pits: {method: fill}\n"),
            "c.yaml:2:16: pits.method: 'fill' is not possible (allowed: none, lift, breach, greedy-breach, "
            "least-change)");
  EXPECT_EQ(config_error("input: {points: a.laz, rivers: }\n"), "no error");
}

TEST(Config, Set_OverridesAndIsNamedInErrors) {
  const TemporaryFolder folder;
  const auto options = options_of(folder, kMinimal + "triangulation: {order: 3}\noutput: {dem: false}\n",
                                  {"triangulation.order=4", "input.classes=[2, 9]", "output.dem.cell_m=2",
                                   "run.memory=2GiB", "output.dir=elsewhere", "triangulation.order=5"});
  EXPECT_EQ(options.triangulation.order, 5) << "the last one wins";
  EXPECT_EQ(options.input.classes, (std::vector<std::uint8_t>{2, 9}));
  EXPECT_TRUE(options.output.dem.enabled);
  EXPECT_EQ(options.output.dem.cell_m, 2);
  EXPECT_EQ(options.run.memory_bytes, std::uint64_t{2} << 30);
  EXPECT_EQ(options.output.dir, (folder / "elsewhere").string());

  EXPECT_EQ(
      options_of(folder, kMinimal, {"triangulation.objective=[local-minima, min-weight]"}).triangulation.objectives,
      (Objectives{Objective::local_minima, Objective::min_weight}));
  const TriangulationOptions limited =
      options_of(folder, kMinimal +
                             "triangulation: {objective: [local-minima, min-squared-error], reference: "
                             "[a.las, /data/b*.laz], max_error_m: 0.2}\n")
          .triangulation;
  EXPECT_EQ(limited.objectives, (Objectives{Objective::local_minima, Objective::min_squared_error}));
  EXPECT_EQ(limited.reference, (std::vector<std::string>{(folder / "a.las").string(), "/data/b*.laz"}));
  EXPECT_EQ(limited.max_error_m, 0.2);
  EXPECT_EQ(limited.budget, PolygonBudget{});
  EXPECT_EQ(options_of(folder, kMinimal, {"triangulation.budget.ways=3", "triangulation.budget.columns=100"})
                .triangulation.budget,
            (PolygonBudget{.max_ways = 3, .max_program = 100}));
  EXPECT_EQ(
      config_error(kMinimal + "triangulation: {budget: {triangles: 0}}\n"),
      "c.yaml:2:37: triangulation.budget.triangles: '0' is not possible (allowed: an integer from 1 to 2147483648)");
  EXPECT_EQ(options_of(folder, kMinimal + "triangulation:\n  objective:\n    - max-min-angle\n    - local-minima\n")
                .triangulation.objectives,
            (Objectives{Objective::max_min_angle, Objective::local_minima}));

  EXPECT_EQ(config_error(kMinimal, {"triangulation.order=9"}),
            "--set triangulation.order: triangulation.order: '9' is not possible (allowed: an integer from 0 to 6)");
  EXPECT_EQ(config_error(kMinimal, {"triangulation.ordr=1"}),
            "--set triangulation.ordr: unknown key 'ordr' in triangulation (allowed: order, objective, reference, "
            "max_error_m, budget)");
  EXPECT_EQ(
      config_error(kMinimal, {"triangulation={order: 9}"}).rfind("--set triangulation: triangulation.order: '9'", 0),
      0U);
  EXPECT_EQ(config_error(kMinimal, {"nonsense"}).rfind("--set nonsense: must be key=value", 0), 0U);
  EXPECT_EQ(config_error(kMinimal, {"=1"}).rfind("--set =1: must be key=value", 0), 0U);
  EXPECT_EQ(config_error(kMinimal, {"a..b=1"}).rfind("--set a..b: the key must be names", 0), 0U);
  EXPECT_EQ(config_error(kMinimal, {"input.classes=[2"}).rfind("--set input.classes: is not YAML", 0), 0U);
  EXPECT_EQ(config_error(kMinimal, {"input.points="}).rfind("c.yaml:1:8: input.points is missing", 0), 0U);
}

TEST(Config, UnreadableFiles_AreConfigErrors) {
  const TemporaryFolder folder;
  for (const auto& path : {folder / "none.yaml", folder.path()}) {
    try {
      (void)read_config(path);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::config);
    }
  }
}

TEST(Config, AliasesThatExplode_AreRefused) {
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string below = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + below;
    for (int j = 0; j < 9; ++j) bomb += ", " + below;
    bomb += "]\n";
  }
  EXPECT_NE(config_error(bomb).find("too much nested or repeated content"), std::string::npos);
  EXPECT_NE(config_error("input: " + std::string(100'000, '[')), "no error");
}

TEST(Config, ByteCounts) {
  EXPECT_EQ(parse_byte_count("4GiB"), std::uint64_t{4} << 30);
  EXPECT_EQ(parse_byte_count("500MB"), 500'000'000U);
  EXPECT_EQ(parse_byte_count("1.5 GB"), 1'500'000'000U);
  EXPECT_EQ(parse_byte_count("1048576"), 1'048'576U);
  EXPECT_EQ(parse_byte_count("1e9"), 1'000'000'000U);
  for (const char* text : {"", "GiB", "-1GB", "4 Gib", "4GiB5", "nan", "1e30TB", "0x10"})
    EXPECT_FALSE(parse_byte_count(text)) << text;
}

TEST(ProgressDisplay, PlainLinesAndEvents) {
  const TemporaryFolder folder;
  std::FILE* out = std::fopen((folder / "out").c_str(), "w");
  {
    ProgressDisplay display(out, false, folder / "work/events.jsonl", 0);
    display.phase_begins(Phase::ingest, 2, 2'000'000);
    display.unit_done(Phase::ingest, 0, 1'000'000, true);
    display.unit_done(Phase::ingest, 1, 1'000'000, false);
    display.phase_ends(Phase::ingest, 2.0);
    display.note("a \"note\"");
  }
  std::fclose(out);
  EXPECT_EQ(read_text(folder / "out"),
            "ingest       1/2 units\ningest       2/2 units\n"
            "ingest       2 units, 1 of them from before in 2.0 s, 0.50 M points/s\nnote: a \"note\"\n");
  const std::string events = read_text(folder / "work/events.jsonl");
  EXPECT_EQ(std::count(events.begin(), events.end(), '\n'), 5);
  EXPECT_NE(events.find(R"("event":"unit_done","phase":"ingest","unit":1,"work":1000000,"skipped":false})"),
            std::string::npos);
  EXPECT_NE(events.find(R"("event":"note","text":"a \"note\""})"), std::string::npos);
}

TEST(ProgressDisplay, Bar_ShowsRateAndTimeLeft) {
  const TemporaryFolder folder;
  std::FILE* out = std::fopen((folder / "out").c_str(), "w");
  {
    ProgressDisplay display(out, true, "");
    display.phase_begins(Phase::finish, 4, 40'000'000);
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    display.unit_done(Phase::finish, 3, 10'000'000, false);
  }
  std::fclose(out);
  const std::string text = read_text(folder / "out");
  EXPECT_NE(text.find("finish       [#####...............] 1/4 units"), std::string::npos) << text;
  EXPECT_NE(text.find("M points/s  ETA 0:0"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with("\r\033[K")) << "the bar is gone at the end";
  EXPECT_EQ(as_duration(59.2), "1:00");
  EXPECT_EQ(as_duration(3725), "1:02:05");
  EXPECT_EQ(as_duration(std::nan("")), "?");
}

TEST(ProgressDisplay, EventsThatCannotBeWritten_AreAStorageError) {
  const TemporaryFolder folder;
  write_text(folder / "file", "");
  ProgressDisplay display(nullptr, false, folder / "file" / "events.jsonl");
  EXPECT_THROW(display.note("x"), Error);
}

TEST(SmallPoints, Csv_GoesOnItsOwnLattice) {
  const TemporaryFolder folder;
  write_text(
      folder / "p.csv",
      "x,y,z\n700000.10,6600000.25,1.125\n700000.1,6600000.25,1.0\n699999,6600001,-3\n700000.10,6600000.25,1.0\n");
  const SmallPoints points = load_small_points(folder / "p.csv");
  EXPECT_EQ(points.num_rows, 4U);
  ASSERT_EQ(points.position.size(), 2U);
  EXPECT_EQ(points.duplicates, (std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 1}, {3, 1}}))
      << "the lowest, then the first, is kept";
  for (std::size_t i = 0; i < 2; ++i) {
    const bool first = points.row[i] == 1;
    EXPECT_DOUBLE_EQ(points.lattice.x(points.position[i].x), first ? 700000.10 : 699999);
    EXPECT_DOUBLE_EQ(points.lattice.y(points.position[i].y), first ? 6600000.25 : 6600001);
    EXPECT_DOUBLE_EQ(points.lattice.z(points.height[i]), first ? 1 : -3);
  }
  EXPECT_TRUE(points.notes.empty());
}

TEST(SmallPoints, TooManyDecimals_AreRoundedWithANote) {
  const TemporaryFolder folder;
  write_text(folder / "p.csv", "x,y,z\n0.1234567890123456,0.5,1e-20\n0.9,0.25,1\n1e3,-7,0\n");
  const SmallPoints points = load_small_points(folder / "p.csv");
  ASSERT_EQ(points.position.size(), 3U);
  EXPECT_EQ(points.notes.size(), 2U);
  for (std::size_t i = 0; i < 3; ++i)
    if (points.row[i] == 0) {
      EXPECT_NEAR(points.lattice.x(points.position[i].x), 0.1234567890123456, 0.51e-6);
    }
}

TEST(SmallPoints, HugeCoordinates_FitByCoarserSteps) {
  const TemporaryFolder folder;
  write_text(folder / "p.csv", "x,y,z\n0,0,0\n1e300,0,1e300\n0,1e12,5\n");
  EXPECT_EQ(load_small_points(folder / "p.csv").notes.size(), 2U);
}

}  // namespace
}  // namespace hydrotin::app
