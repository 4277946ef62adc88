#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>

#include "dem_terrain.h"
#include "hydrotin/las.h"
#include "hydrotin/river_statistics.h"
#include "hydrotin/vector_reader.h"
#include "program_call.h"
#include "shared_data.h"

namespace hydrotin {
namespace {

using nlohmann::json;
using testing::Outcome;
using testing::TemporaryFolder;
using testing::write_text;

Outcome embed(const TemporaryFolder& folder, const std::string& arguments) {
  return testing::call(folder, "embed " + arguments);
}

/// A valley falling to the east in UTM coordinates, rough, without CRS.
Mesh valley(std::uint32_t seed, std::uint32_t side) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-4, 4);
  std::vector<LatticePoint> points;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x)
      points.push_back(
          {static_cast<std::int32_t>(1000 * x + random() % 600), static_cast<std::int32_t>(1000 * y + random() % 600)});
  std::sort(points.begin(), points.end(),
            [](LatticePoint a, LatticePoint b) { return hilbert_key(a) < hilbert_key(b); });
  const Triangulation of = delaunay(points);
  Mesh mesh;
  for (const LatticePoint p : of.position) {
    const double x = p.x / 100.0, y = p.y / 100.0, middle = 5.0 * side;
    const double h = 300 - 0.2 * x + 0.3 * std::abs(y - middle) + noise(random);
    mesh.vertex.push_back({430000 + x, 5412000 + y, std::round(h * 100) / 100});
  }
  for (std::size_t t = 0; t < of.origin.size(); t += 3)
    mesh.triangle.push_back({of.origin[t].value, of.origin[t + 1].value, of.origin[t + 2].value});
  return mesh;
}

/// Two tributaries (one a multi-line, one drawn upstream) and a main river out over the rim; one line without geometry.
std::string rivers_json(bool is_turned) {
  const std::string a = "[430030,5412150.5]", b = "[430150,5412153.25]", c = "[430200.125,5412210]",
                    d = "[430350,5412149]";
  const std::string main =
      is_turned ? "[" + d + ",[430260,5412160]," + b + "]" : "[" + b + ",[430260,5412160]," + d + "]";
  const std::string north =
      is_turned ? "[" + b + ",[430120,5412200],[430050,5412260]]" : "[[430050,5412260],[430120,5412200]," + b + "]";
  const std::string west = is_turned ? "[[" + b + ",[430100,5412151]],[[430100,5412151]," + a + "]]"
                                     : "[[" + a + ",[430100,5412151]],[[430100,5412151]," + b + "]]";
  return R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::32632"}},
    "features":[
    {"type":"Feature","properties":{"name":"Main","drawn":1},"geometry":{"type":"LineString","coordinates":)" +
         main + R"(}},
    {"type":"Feature","properties":{"name":"West","drawn":1},"geometry":{"type":"MultiLineString","coordinates":)" +
         west + R"(}},
    {"type":"Feature","properties":{"name":"North","drawn":1},"geometry":{"type":"LineString","coordinates":)" +
         north + R"(}},
    {"type":"Feature","properties":{"name":null,"drawn":1},"geometry":null}]})";
}

json run(const TemporaryFolder& folder, const std::string& arguments) {
  const Outcome outcome = embed(folder, "tin.ply --rivers rivers.geojson --json " + arguments);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return outcome.code == 0 ? json::parse(outcome.out) : json();
}

/// Everything the program says about rivers, once more from the mesh it wrote, by the definitions.
void expect_valid(const TemporaryFolder& folder, const json& result) {
  EXPECT_EQ(result["wrong_flow_after"], 0);
  EXPECT_EQ(result["not_valley_after"], 0);
  EXPECT_EQ(result["broken"].size(), 0u);
  const Mesh mesh = read_mesh(folder / "out.ply");
  ASSERT_EQ(mesh.vertex.size(), result["heights"].size());
  std::vector<std::array<double, 2>> position;
  std::vector<double> height;
  std::vector<std::uint32_t> triangle;
  for (const auto& v : mesh.vertex) {
    position.push_back({v[0], v[1]});
    height.push_back(v[2]);
  }
  for (const auto& t : mesh.triangle) triangle.insert(triangle.end(), t.begin(), t.end());
  std::vector<RiverEdge> rivers;
  const VectorParts edges =
      read_vector(folder / "layers.gpkg", {VectorGeometry::line, "", "", {"from", "to", "valid"}});
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges.layer[i] != 0) continue;
    rivers.push_back({static_cast<std::uint32_t>(std::stoul(edges.value[3 * i])),
                      static_cast<std::uint32_t>(std::stoul(edges.value[3 * i + 1]))});
    EXPECT_EQ(edges.value[3 * i + 2], "1");
    const auto line = edges.ring(edges.ring_begin[i]);
    ASSERT_EQ(line.size(), 2u);
    EXPECT_EQ(line[0][0], position[rivers.back().from][0]);
    EXPECT_EQ(line[1][2], height[rivers.back().to]);
  }
  EXPECT_EQ(rivers.size(), result["river_edges"].get<std::size_t>());
  const RiverTerrain terrain{position, height, triangle};
  EXPECT_EQ(check_network(terrain, rivers).fault, NetworkFault::none);
  const RiverStatistics after = river_statistics(terrain, rivers, height, 0);
  EXPECT_EQ(after.wrong_flow + after.not_valley, 0u);
}

TEST(EmbedLines, SnappedAndInsertedRiversAreValidWhicheverWayTheyWereDrawn) {
  for (const bool is_turned : {false, true})
    for (const std::string match : {"snap", "insert"})
      for (const std::string fill : {"", "--fill lift", "--fill least-change"}) {
        SCOPED_TRACE(match + " " + fill + (is_turned ? " turned" : ""));
        const TemporaryFolder folder;
        const Mesh mesh = valley(3, 34);
        write_ply(folder / "tin.ply", mesh.vertex, mesh.triangle, "");
        write_text(folder / "rivers.geojson", rivers_json(is_turned));
        const json result =
            run(folder, "--match " + match + " --quantum 0.01 --out out.ply --layers layers.gpkg " + fill);
        ASSERT_FALSE(result.is_null());
        expect_valid(folder, result);
        EXPECT_EQ(result["lines"]["lines"], 4);
        EXPECT_EQ(result["lines"]["without_geometry"], 1);
        EXPECT_EQ(result["lines"]["lines_turned"], is_turned ? 4 : 0);
        EXPECT_EQ(result["lines"]["mouths_at_outlets"], 1);
        EXPECT_EQ(result["lines"]["mouths_with_chains"], 0);
        EXPECT_GT(result["wrong_flow_before"].get<int>() + result["not_valley_before"].get<int>(), 5);
        EXPECT_EQ(result["rivers"].size(), 1u);
        if (match == "insert") {
          EXPECT_GT(result["vertices_added"].get<int>(), 5);
        }
        if (fill.empty()) continue;
        EXPECT_EQ(result["fill"]["pits_after"], 0);
        EXPECT_EQ(result["fill"]["river_vertices_moved"], 0);
        EXPECT_GT(result["fill"]["pits_before"].get<int>(), 10);
      }
}

TEST(EmbedLines, DirectionIsTakenAsToldAndMouthsInsideGetChains) {
  const TemporaryFolder folder;
  const Mesh mesh = valley(5, 30);
  write_ply(folder / "tin.ply", mesh.vertex, mesh.triangle, "");
  write_text(folder / "rivers.geojson",
             R"({"type":"FeatureCollection","features":[
    {"type":"Feature","properties":{"drawn":"-1"},"geometry":{"type":"LineString","coordinates":[[430180,5412150],[430040,5412150]]}},
    {"type":"Feature","properties":{"drawn":"1"},"geometry":{"type":"LineString","coordinates":[[430100,5412050],[430180,5412150]]}}]})");
  EXPECT_EQ(run(folder, "--direction digitised")["lines"]["lines_turned"], 0);
  EXPECT_EQ(run(folder, "--direction reversed")["lines"]["lines_turned"], 2);
  const json result = run(folder,
                          "--direction attribute --direction-field drawn --out out.ply --layers layers.gpkg "
                          "--river-name drawn --profiles svg --quantum 0.001");
  expect_valid(folder, result);
  EXPECT_EQ(result["lines"]["lines_turned"], 1);
  EXPECT_EQ(result["lines"]["mouths_with_chains"], 1);
  EXPECT_GT(result["lines"]["chain_edges"].get<int>(), 3);
  EXPECT_EQ(result["rivers"].size(), 2u);
  const std::string svg = testing::read_text(folder / "svg/01-1.svg") + testing::read_text(folder / "svg/02-1.svg");
  EXPECT_NE(svg.find("<polyline"), std::string::npos);
  // A sink declared at the mouth needs no chain.
  const VectorParts edges = read_vector(folder / "layers.gpkg", {VectorGeometry::line, "", "", {"from", "to"}});
  std::map<std::string, int> ends;
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (edges.layer[i] == 0) {
      ends[edges.value[2 * i]] += 1000;
      ends[edges.value[2 * i + 1]] += 1;
    }
  std::string mouth;
  for (const auto& [v, n] : ends)
    if (n < 1000) mouth = v;
  write_text(folder / "sinks.csv", "vertex\n" + mouth + "\n");
  const json sink = run(folder, "--direction attribute --direction-field drawn --outlets sinks.csv");
  EXPECT_EQ(sink["lines"]["mouths_at_outlets"], 1);
  EXPECT_EQ(sink["lines"]["chain_edges"], 0);
}

TEST(EmbedLines, LinesInDegreesAndHeightsOfLinesAreUsed) {
  const TemporaryFolder folder;
  const Mesh mesh = valley(7, 30);
  write_ply(folder / "tin.ply", mesh.vertex, mesh.triangle, "");
  // Around 8.04 E 48.86 N: the valley in UTM 32.
  write_text(
      folder / "rivers.geojson",
      R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":"LineString",
    "coordinates":[[8.0465,48.85838,210.5],[8.0478,48.85838,205],[8.0492,48.85838,199.25]]}}]})");
  const json result = run(folder, "--crs EPSG:32632 --match insert --use-z --variant VF --points-out points.las");
  ASSERT_FALSE(result.is_null());
  EXPECT_EQ(result["lines"]["heights_from_lines"], 3);
  EXPECT_EQ(result["wrong_flow_after"], 0);
  LasFile las((folder / "points.las").string());
  EXPECT_GT(las.header().point_count, 2u);
  EXPECT_EQ(run(folder, "--crs EPSG:32632 --points-out points.gpkg")["wrong_flow_after"], 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "points.gpkg"));
}

TEST(EmbedLines, MoreConstraintsHold) {
  const TemporaryFolder folder;
  const Mesh mesh = valley(9, 26);
  write_ply(folder / "tin.ply", mesh.vertex, mesh.triangle, "");
  write_text(folder / "rivers.geojson", rivers_json(false));
  write_text(folder / "lakes.geojson",
             R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"level":231.5},"geometry":
    {"type":"Polygon","coordinates":[[[430140,5412130],[430200,5412130],[430200,5412170],[430140,5412170],[430140,5412130]]]}}]})");
  const json result =
      run(folder,
          "--lakes lakes.geojson --lake-level level --triangle-directions 4 "
          "--triangle-slope-limit 80% --max-change 60 --quantum 0.01 --out out.ply --layers layers.gpkg");
  ASSERT_FALSE(result.is_null());
  expect_valid(folder, result);
  const Mesh out = read_mesh(folder / "out.ply");
  std::size_t in_lake = 0;
  for (std::size_t v = 0; v < mesh.vertex.size(); ++v) {
    const auto& p = out.vertex[v];
    if (p[0] < 430140 || p[0] > 430200 || p[1] < 5412130 || p[1] > 5412170) continue;
    ++in_lake;
    EXPECT_EQ(p[2], 231.5);
  }
  EXPECT_GT(in_lake, 10u);
  const auto& t = mesh.triangle[40];
  write_text(folder / "edges.csv", "a,b\n" + std::to_string(t[0]) + "," + std::to_string(t[1]) + "\n");
  EXPECT_FALSE(run(folder, "--preserve-edges edges.csv --preserve both").is_null());
}

/// The height of w over the line of the edge: on which side a triangle is.
double side_of(const Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t w) {
  const auto &p = mesh.vertex[a], &q = mesh.vertex[b], &r = mesh.vertex[w];
  const double x = q[0] - p[0], y = q[1] - p[1], size = x * x + y * y;
  const double t = ((r[0] - p[0]) * x + (r[1] - p[1]) * y) / size;
  return r[2] - ((1 - t) * p[2] + t * q[2]);
}

// Edges that inserted lines leave keep their type, those cut are counted.
TEST(EmbedLines, PreservedEdges_KeepTheirTypeWithInsertedLines) {
  const TemporaryFolder folder;
  const Mesh mesh = valley(3, 34);
  write_ply(folder / "tin.ply", mesh.vertex, mesh.triangle, "EPSG:32632");
  write_text(folder / "rivers.geojson", rivers_json(false));
  std::string edges = "a,b\n";
  for (std::size_t t = 0; t < mesh.triangle.size(); t += 4)
    edges += std::to_string(mesh.triangle[t][0]) + "," + std::to_string(mesh.triangle[t][1]) + "\n";
  write_text(folder / "edges.csv", edges);
  const std::string base = "tin.ply --rivers rivers.geojson --match insert --variant VFR --decline 1% ";
  ASSERT_EQ(embed(folder, base + "--no-flow --no-valley --out before.ply").code, 0);
  ASSERT_EQ(embed(folder, base + "--out free.ply").code, 0);
  const Outcome outcome = embed(folder, base + "--preserve-edges edges.csv --out kept.ply --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("edges to be preserved were cut by inserted lines"), std::string::npos) << outcome.err;
  EXPECT_TRUE(json::parse(outcome.out).at("broken").empty());
  const Mesh before = read_mesh(folder / "before.ply"), loose = read_mesh(folder / "free.ply"),
             kept = read_mesh(folder / "kept.ply");
  ASSERT_EQ(before.triangle, kept.triangle);
  std::size_t sides = 0, changed = 0;
  for (std::size_t e = 0; e < mesh.triangle.size(); e += 4)
    for (const auto& t : before.triangle)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = t[i], b = t[(i + 1) % 3], w = t[(i + 2) % 3];
        if (std::minmax(a, b) != std::minmax(mesh.triangle[e][0], mesh.triangle[e][1])) continue;
        const double then = side_of(before, a, b, w), now = side_of(kept, a, b, w), freely = side_of(loose, a, b, w);
        ++sides;
        changed += (then > 1e-6 && freely < -1e-6) || (then < -1e-6 && freely > 1e-6) ? 1 : 0;
        EXPECT_FALSE((then > 1e-6 && now < -1e-6) || (then < -1e-6 && now > 1e-6)) << a << " " << b << " " << w;
      }
  EXPECT_GT(sides, 500U);
  EXPECT_GT(changed, 0U);
}

TEST(EmbedLines, BadInput_GetsAClearError) {
  const TemporaryFolder folder;
  const Mesh mesh = valley(3, 34);
  write_ply(folder / "tin.ply", mesh.vertex, mesh.triangle, "");
  write_text(folder / "rivers.geojson", rivers_json(false));
  write_text(folder / "far.geojson", R"({"type":"LineString","coordinates":[[1,2],[3,4],[1e300,1e300]]})");
  write_text(folder / "empty.geojson", R"({"type":"FeatureCollection","features":[]})");
  const auto expect = [&](const std::string& arguments, int code, const std::string& words) {
    const Outcome outcome = embed(folder, arguments);
    EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << arguments << "\n" << outcome.err;
    EXPECT_TRUE(outcome.out.empty());
  };
  const std::string tin = "tin.ply --rivers rivers.geojson ";
  expect("tin.ply --rivers far.geojson", 3, "no line runs along or across");
  expect("tin.ply --rivers empty.geojson", 3, "has no line");
  expect("tin.ply --rivers none.gpkg", 3, "none.gpkg");
  expect(tin + "--match weld", 2, "--match");
  expect(tin + "--direction uphill", 2, "--direction");
  expect(tin + "--direction attribute", 2, "--direction-field");
  expect(tin + "--direction attribute --direction-field nothing", 3, "nothing");
  expect(tin + "--rivers-crs EPSG:0", 2, "--rivers-crs");
  expect(tin + "--crs nowhere", 2, "--crs");
  expect(tin + "--use-z", 2, "--use-z");
  expect(tin + "--fill breach", 2, "--fill");
  expect(tin + "--outlets nowhere.csv", 2, "--outlets");
  expect(tin + "--method dp --max-change 1", 2, "--method");
  expect(tin + "--points-out points.txt", 2, "--points-out");
  expect(tin + "--lake-level level", 2, "--lake-level");
  expect("tin.ply --river-edges e.csv --match insert", 2, "--match");
  write_text(folder / "edges.csv", "a,b\n0,900\n");
  expect(tin + "--preserve-edges edges.csv", 3, "is not an edge");
}

TEST(EmbedLines, OrderOfTheFeaturesDoesNotMatter) {
  const TemporaryFolder folder;
  const Mesh mesh = valley(11, 34);
  write_ply(folder / "tin.ply", mesh.vertex, mesh.triangle, "");
  json features = json::parse(rivers_json(false));
  for (const std::string match : {"snap", "insert"}) {
    std::string first;
    for (int turn = 0; turn < 2; ++turn) {
      write_text(folder / "rivers.geojson", features.dump());
      ASSERT_FALSE(run(folder, "--quantum 0.01 --fill least-change --out out.ply --match " + match).is_null());
      if (turn == 0)
        first = testing::read_text(folder / "out.ply");
      else
        EXPECT_EQ(testing::read_text(folder / "out.ply"), first) << match;
      std::reverse(features["features"].begin(), features["features"].end());
    }
  }
}

TEST(EmbedLines, NoRiverAtAll_ChangesNothing) {
  const TemporaryFolder folder;
  const Mesh mesh = valley(3, 8);
  write_ply(folder / "tin.ply", mesh.vertex, mesh.triangle, "");
  write_text(folder / "rivers.csv", "from,to\n");
  const Outcome outcome = embed(folder,
                                "tin.ply --river-edges rivers.csv --out out.ply --layers l.gpkg --profiles p "
                                "--points-out points.las");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(read_mesh(folder / "out.ply").vertex, mesh.vertex);
  // Edges may have mouths and pits, too.
  write_text(folder / "rivers.csv",
             "from,to\n" + std::to_string(mesh.triangle[5][0]) + "," + std::to_string(mesh.triangle[5][1]) + "\n");
  const Outcome filled = embed(folder, "tin.ply --river-edges rivers.csv --fill lift --layers l.gpkg --json");
  ASSERT_EQ(filled.code, 0) << filled.err;
  EXPECT_EQ(json::parse(filled.out)["fill"]["pits_after"], 0);
  EXPECT_EQ(json::parse(filled.out)["vertices_added"], 0);
}

struct RealCase {
  std::string dem, rivers, options;
  int lines, turned;
};

TEST(EmbedLines, RealRiversAreValidFromDemToEmbeddedTin) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const std::string nc = "dem_rivers_nc/", logan = "dem_rivers_logan/";
  const std::vector<RealCase> cases = {
      {nc + "elev_ned_30m.tif", nc + "streams.shp",
       "--fill least-change --lakes '" + testing::shared_path(nc + "lakes.shp") + "'", 8288, 0},
      {logan + "output.vrt", logan + "logannet.shp", "--fill lift", 152, 152},
      {logan + "output.vrt", logan + "logannet.shp", "--match insert --fill least-change", 152, 152}};
  for (const RealCase& c : cases) {
    SCOPED_TRACE(c.rivers + " " + c.options);
    const TemporaryFolder folder;
    const Mesh mesh = testing::dem_mesh(testing::shared_path(c.dem), 0.01);
    write_ply(folder / "tin.ply", mesh.vertex, mesh.triangle, mesh.crs_wkt);
    const Outcome outcome =
        embed(folder, "tin.ply --rivers '" + testing::shared_path(c.rivers) +
                          "' --quantum 0.01 --json --out out.ply --layers layers.gpkg " + c.options);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json result = json::parse(outcome.out);
    expect_valid(folder, result);
    EXPECT_EQ(result["lines"]["lines"], c.lines);
    EXPECT_EQ(result["lines"]["lines_turned"], c.turned);
    EXPECT_EQ(result["lines"]["triangles_too_small"], 0);
    EXPECT_EQ(result["fill"]["pits_after"], 0);
    EXPECT_EQ(result["fill"]["river_vertices_moved"], 0);
  }
}

}  // namespace
}  // namespace hydrotin
