#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "hydrotin/mesh.h"
#include "oracle/full_river_program.h"
#include "program_call.h"
#include "river_terrains.h"

namespace hydrotin {
namespace {

using nlohmann::json;
using testing::Outcome;
using testing::read_text;
using testing::TemporaryFolder;
using testing::TestTerrain;
using testing::write_text;

Outcome embed(const TemporaryFolder& folder, const std::string& arguments) {
  return testing::call(folder, "embed " + arguments);
}

void write_files(const TemporaryFolder& folder, const TestTerrain& terrain) {
  std::vector<MeshVertex> vertices;
  std::vector<MeshTriangle> triangles;
  for (std::size_t v = 0; v < terrain.height.size(); ++v)
    vertices.push_back({terrain.position[v][0], terrain.position[v][1], terrain.height[v]});
  for (std::size_t t = 0; t < terrain.triangle.size(); t += 3)
    triangles.push_back({terrain.triangle[t], terrain.triangle[t + 1], terrain.triangle[t + 2]});
  write_ply(folder / "tin.ply", vertices, triangles, "");
  std::string edges = "from,to\n";
  for (const auto& [from, to] : terrain.rivers) edges += std::to_string(from) + "," + std::to_string(to) + "\n";
  write_text(folder / "rivers.csv", edges);
}

TEST(EmbedCommand, Json_IsTheOptimumOfTheThesis) {
  const TemporaryFolder folder;
  TestTerrain terrain = testing::random_terrain(3, 80, false);
  testing::add_rivers(terrain, 3, 4, 8, true);
  write_files(folder, terrain);
  RiverConstraints vf;
  vf.decline_measure = DeclineMeasure::none;
  vf.limit_edge_slope = false;
  RiverConstraints vfrs_degree;
  vfrs_degree.decline_measure = DeclineMeasure::slope;
  vfrs_degree.decline = std::tan(std::acos(-1.0) / 180);
  RiverConstraints only = vf;
  only.river_only = true;
  const std::vector<std::pair<std::string, RiverConstraints>> cases = {{"", RiverConstraints{}},
                                                                       {"--variant VF", vf},
                                                                       {"--decline 1deg", vfrs_degree},
                                                                       {"--variant VF --river-only", only},
                                                                       {"--variant VF --method dp", only}};
  for (const auto& [options, constraints] : cases) {
    SCOPED_TRACE(options);
    const Outcome outcome = embed(folder, "tin.ply --river-edges rivers.csv --json --out out.ply " + options);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json result = json::parse(outcome.out);
    const auto full = oracle::FullProgram(terrain, constraints).solve();
    ASSERT_TRUE(full.has_value());
    EXPECT_NEAR(result["objective"].get<double>(), *full, 1e-6 * std::max(1.0, *full));
    EXPECT_EQ(result["river_edges"], terrain.rivers.size());
    EXPECT_EQ(result["wrong_flow_after"], 0);
    EXPECT_EQ(result["not_valley_after"], 0);
    EXPECT_GT(result["wrong_flow_before"].get<int>() + result["not_valley_before"].get<int>(), 0);
    const Mesh mesh = read_mesh(folder / "out.ply");
    double total = 0;
    for (std::size_t v = 0; v < mesh.vertex.size(); ++v) {
      EXPECT_EQ(mesh.vertex[v][2], result["heights"][v].get<double>());
      total += std::abs(mesh.vertex[v][2] - terrain.height[v]);
    }
    EXPECT_NEAR(total, result["objective"].get<double>(), 1e-6);
    EXPECT_NEAR(result["average_change"].get<double>() * result["vertices_moved"].get<double>(), total, 1e-4);
  }
  const Outcome table = embed(folder, "tin.ply --river-edges rivers.csv --quantum 0.01 --contiguous exact");
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_NE(table.out.find("vertices moved"), std::string::npos);
}

TEST(EmbedCommand, Lake_FromPolygonsIsLevel) {
  const TemporaryFolder folder;
  TestTerrain terrain;
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 5; ++x) {
      terrain.position.push_back({x * 10.0, y * 10.0});
      terrain.height.push_back(20 - 2 * x + 3 * std::abs(y - 2) + 0.1 * ((7 * x + 3 * y) % 5));
    }
  for (std::uint32_t y = 0; y < 4; ++y)
    for (std::uint32_t x = 0; x < 4; ++x) {
      const std::uint32_t a = 5 * y + x;
      for (const std::uint32_t v : {a, a + 1, a + 6, a, a + 6, a + 5}) terrain.triangle.push_back(v);
    }
  terrain.rivers = {{10, 11}, {11, 12}};
  write_files(folder, terrain);
  // The border passes through vertices; a hole leaves one out; a feature without geometry is skipped.
  write_text(folder / "lakes.geojson", R"({"type":"FeatureCollection","features":[
    {"type":"Feature","properties":{},"geometry":null},
    {"type":"Feature","properties":{},"geometry":{"type":"MultiPolygon","coordinates":[
      [[[30,-1],[41,-1],[41,40],[30,40],[30,-1]],[[35,5],[45,5],[45,15],[35,15],[35,5]]]]}}]})");
  const Outcome outcome = embed(folder, "tin.ply --river-edges rivers.csv --variant VF --lakes lakes.geojson --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["broken"].size(), 0u);
  for (const std::size_t v : {3, 8, 13, 18, 23, 4, 14, 19, 24})
    EXPECT_EQ(result["heights"][v], result["heights"][3]) << v;
  EXPECT_EQ(result["heights"][9].get<double>(), terrain.height[9]);
  EXPECT_EQ(embed(folder, "tin.ply --river-edges rivers.csv --lakes none.gpkg").code, 3);
  EXPECT_EQ(embed(folder, "tin.ply --rivers lakes.geojson").code, 3);
}

TEST(EmbedCommand, BadInput_GetsAClearError) {
  const TemporaryFolder folder;
  TestTerrain terrain = testing::random_terrain(3, 20, false);
  const std::uint32_t* t = terrain.triangle.data();
  terrain.rivers = {{t[0], t[1]}, {t[1], t[2]}, {t[2], t[0]}};
  write_files(folder, terrain);
  const auto expect = [&](const std::string& arguments, int code, const std::string& words) {
    const Outcome outcome = embed(folder, arguments);
    EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << arguments << "\n" << outcome.err;
    EXPECT_TRUE(outcome.out.empty());
  };
  const std::string tin = "tin.ply --river-edges rivers.csv ";
  expect(tin, 3, "directed cycle");
  expect("tin.ply", 2, "--river-edges");
  expect(tin + "--variant VFX", 2, "--variant");
  expect(tin + "--decline steep", 2, "--decline");
  expect(tin + "--decline -1%", 2, "--decline");
  expect(tin + "--decline 90deg", 2, "--decline");
  expect(tin + "--slope-limit 5deg", 2, "--slope-limit");
  expect(tin + "--contiguous many", 2, "--contiguous");
  expect(tin + "--quantum -1", 2, "--quantum");
  expect(tin + "--method simplex", 2, "--method");
  expect(tin + "--method dp --time-limit 1", 2, "--time-limit");
  expect("none.ply --river-edges rivers.csv", 3, "none.ply");
  expect("tin.ply --river-edges none.csv", 3, "none.csv");
  write_text(folder / "rivers.csv", "from,to\n0,99\n");
  expect(tin, 3, "rivers.csv:2");
  const auto links = testing::neighbors_of(terrain);
  std::uint32_t far = 1;
  while (std::count(links[0].begin(), links[0].end(), far) != 0) ++far;
  write_text(folder / "rivers.csv", "from,to\n0," + std::to_string(far) + "\n");
  expect(tin, 3, "is not an edge");
  const std::string good = std::to_string(t[0]) + "," + std::to_string(t[1]) + "\n";
  write_text(folder / "rivers.csv", "from,to\n" + good + good);
  expect(tin, 3, "twice");
}

}  // namespace
}  // namespace hydrotin
