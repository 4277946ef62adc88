#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hydrotin/lattice_terrain.h"
#include "hydrotin/vector.h"
#include "monolith.h"
#include "plan.h"
#include "tiling_fixture.h"

/// Terrains with rivers for tests of the whole pipeline.

namespace hydrotin::testing {

constexpr std::uint64_t kEverything = 1'000'000'000;
using Chain = std::vector<LatticePoint>;

/// Hills with lines drawn across them, whatever these do to the relief.
struct RiverScene {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  std::vector<std::string> files;
  std::vector<Chain> line, lake;  // as the files of points count
  std::vector<Chain> preserved;
  std::string rivers, lakes, preserved_file;
};

inline VectorPoint in_crs(LatticePoint p) {
  return {500000 + p.x * 0.01, 4000000 + p.y * 0.01, 0};
}

inline void write_lines(RiverScene& scene, const TemporaryFolder& folder, const std::string& stem) {
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
inline RiverScene make_scene(const TemporaryFolder& folder, std::uint64_t seed, std::size_t n, bool with_lakes) {
  RiverScene s;
  s.position = distinct(make_cloud(CloudKind::uniform, seed, n, 100));
  for (const LatticePoint p : s.position) s.height.push_back(relief_at(seed, p, 3000, 4000, 5));
  const std::string stem = "scene" + std::to_string(seed) + (with_lakes ? "l" : "") + "_";
  s.files = write_files(folder, s.position, s.height, 2, stem);
  const std::int32_t size = extent_for(n, 100);
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
inline RiverScene make_ridges(const TemporaryFolder& folder, std::uint64_t seed, std::size_t n) {
  RiverScene s;
  s.position = distinct(make_cloud(CloudKind::uniform, seed, n, 100));
  const double size = extent_for(n, 100), width = 0.12 * size;
  for (const LatticePoint p : s.position)
    s.height.push_back(
        static_cast<std::int32_t>(std::lround(p.y / 4.0 + 500 * std::cos(6.283185307179586 * p.x / width))));
  s.files = write_files(folder, s.position, s.height, 2, "ridges_");
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
inline RiverScene make_void(const TemporaryFolder& folder, std::uint64_t seed, std::size_t n) {
  RiverScene s;
  const double size = extent_for(n, 100), middle = size / 2;
  for (const LatticePoint p : distinct(make_cloud(CloudKind::uniform, seed, n, 100)))
    if (std::hypot(p.x - middle, p.y - middle) > 0.06 * size) s.position.push_back(p);
  for (const LatticePoint p : s.position)
    s.height.push_back(relief_at(seed, p, 3000, 400, 5) +
                       static_cast<std::int32_t>(std::hypot(p.x - middle, p.y - middle)));
  const std::string stem = "void" + std::to_string(seed) + "_";
  s.files = write_files(folder, s.position, s.height, 2, stem);
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

inline PipelineOptions options_of(const RiverScene& scene, const std::string& out, std::uint64_t target) {
  PipelineOptions options = options_for(scene.files, out);
  options.tiles.target_points = target;
  options.triangulation.order = 1;
  options.rivers.lines = scene.rivers;
  options.rivers.lakes = scene.lakes;
  options.rivers.preserve_edges = scene.preserved_file;
  options.rivers.name_field = "name";
  options.pits.method = PitMethod::lift;  // what the whole in memory does
  return options;
}

/// The terrain without its rivers.
inline LatticeTerrain terrain_of(const RiverScene& scene, const PipelineOptions& options, const Lattice& lattice) {
  const auto place = [&](LatticePoint p) {
    return LatticePoint{static_cast<std::int32_t>(p.x - lattice.base_x),
                        static_cast<std::int32_t>(p.y - lattice.base_y)};
  };
  LatticeTerrain given;
  std::vector<std::int32_t> measured;
  for (const auto& [p, z] : lowest_points(scene.position, scene.height)) {
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
inline std::set<std::pair<std::uint32_t, std::uint32_t>> edges_of(const LatticeTerrain& terrain) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> out;
  for (std::uint32_t h = 0; h < terrain.triangle.size(); ++h)
    out.insert(std::minmax(terrain.origin(h), terrain.target(h)));
  return out;
}

/// Every so many edges of the terrain, as lines of a file.
inline void preserve_some(RiverScene& scene, const TemporaryFolder& folder, const PipelineOptions& options,
                          std::size_t step) {
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

inline void expect_checked(const std::string& dir, std::uint64_t river_edges, std::uint64_t invalid = 0) {
  const DatasetSummary checked = check_dataset(dir, 1000);
  EXPECT_TRUE(checked.ok) << (checked.problems.empty() ? "" : checked.problems.front());
  EXPECT_EQ(checked.pits, 0U);
  EXPECT_EQ(checked.river_edges, river_edges);
  EXPECT_EQ(checked.invalid_river_edges, invalid);
}

}  // namespace hydrotin::testing
