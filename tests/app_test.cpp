#include <gdal.h>
#include <gtest/gtest.h>
#include <ogr_api.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "hydrotin/mesh.h"
#include "shared_data.h"
#include "temporary_folder.h"

namespace hydrotin {
namespace {

using nlohmann::json;
using Triples = std::set<std::array<int, 3>>;
using Quadruples = std::set<std::array<int, 4>>;
using testing::read_text;
using testing::TemporaryFolder;
using testing::write_text;

struct Outcome {
  int code = -1;
  std::string out, err;
};

/// Calls the program as a shell would.
Outcome call(const TemporaryFolder& folder, const std::string& arguments) {
  const auto out = folder / "stdout", err = folder / "stderr";
  const std::string command = "cd '" + folder.path().string() + "' && '" HYDROTIN_PROGRAM "' " + arguments + " >'" +
                              out.string() + "' 2>'" + err.string() + "' </dev/null";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(out), read_text(err)};
}

std::string csv_of(const std::vector<std::array<double, 3>>& points) {
  std::string text = "x,y,z\n";
  char line[100];
  for (const auto& p : points) {
    std::snprintf(line, sizeof line, "%.2f,%.2f,%.2f\n", p[0], p[1], p[2]);
    text += line;
  }
  return text;
}

std::vector<std::array<double, 3>> random_points(std::uint32_t seed, int n) {
  std::mt19937 random(seed);
  std::vector<std::array<double, 3>> points;
  for (int i = 0; i < n; ++i)
    points.push_back({static_cast<double>(random() % 10000) / 100, static_cast<double>(random() % 10000) / 100,
                      static_cast<double>(random() % 1000) / 100});
  return points;
}

/// Twice the signed area.
double area(const std::array<double, 3>& a, const std::array<double, 3>& b, const std::array<double, 3>& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Points strictly inside the circumcircle, by distances; fit for random points only.
int order_of(const std::vector<std::array<double, 3>>& points, const std::array<int, 3>& t) {
  const auto &a = points[static_cast<std::size_t>(t[0])], &b = points[static_cast<std::size_t>(t[1])],
             &c = points[static_cast<std::size_t>(t[2])];
  const double bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1], d = 2 * (bx * cy - by * cx);
  const double ux = (cy * (bx * bx + by * by) - by * (cx * cx + cy * cy)) / d;
  const double uy = (bx * (cx * cx + cy * cy) - cx * (bx * bx + by * by)) / d;
  int inside = 0;
  for (const auto& p : points)
    if (std::hypot(p[0] - a[0] - ux, p[1] - a[1] - uy) < std::hypot(ux, uy) - 1e-9) ++inside;
  return inside;
}

TEST(App, Usage_HasExitCode2AndTalksOnStderr) {
  const TemporaryFolder folder;
  for (const char* arguments : {"", "bogus", "run", "synth", "synth a --tiles", "phase ingest c.yaml", "fill", "info",
                                "triangulate p.csv --order", "run c.yaml --no-such-flag"}) {
    SCOPED_TRACE(arguments);
    const Outcome outcome = call(folder, arguments);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err, "");
  }
}

TEST(App, HelpAndVersion_GoToStdout) {
  const TemporaryFolder folder;
  const Outcome help = call(folder, "--help");
  EXPECT_EQ(help.code, 0);
  for (const char* name :
       {"run", "plan", "phase", "status", "check", "report", "info", "synth", "triangulate", "orders", "fill"}) {
    EXPECT_NE(help.out.find(name), std::string::npos) << name;
    EXPECT_EQ(call(folder, std::string(name) + " --help").code, 0);
  }
  EXPECT_EQ(call(folder, "--version").out, "0.1.0\n");
}

TEST(App, FullStandardOutput_IsAStorageError) {
  const TemporaryFolder folder;
  write_text(folder / "p.csv", csv_of(random_points(1, 2000)));
  for (const std::string arguments : {"--help", "orders p.csv --json", "info p.csv --json"}) {
    SCOPED_TRACE(arguments);
    const int status = std::system(
        ("cd '" + folder.path().string() + "' && '" HYDROTIN_PROGRAM "' " + arguments + " >/dev/full 2>/dev/null")
            .c_str());
    EXPECT_EQ(WEXITSTATUS(status), 4);
  }
}

TEST(App, ConfigErrors_HaveExitCode2AndComeBeforeAnyWork) {
  const TemporaryFolder folder;
  write_text(folder / "c.yaml", "input: {points: [a.las]}\noutput: {dir: results}\ntriangulation: {order: 8}\n");
  for (const char* command : {"run", "plan", "status", "check", "report", "phase ingest"}) {
    SCOPED_TRACE(command);
    const std::string more = std::string(command) == "phase ingest" ? " --task 0 --of 1" : "";
    const Outcome outcome = call(folder, std::string(command) + " c.yaml" + more);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.err,
              "hydrotin: c.yaml:3:24: triangulation.order: '8' is not possible (allowed: an integer from 0 to 6)\n");
    EXPECT_FALSE(std::filesystem::exists(folder / "results"));
  }
  EXPECT_EQ(call(folder, "run c.yaml --set triangulation.order=2 --until later").code, 2);
  EXPECT_EQ(call(folder, "phase ingest c.yaml --set triangulation.order=2 --task 3 --of 3").code, 2);
  EXPECT_EQ(call(folder, "phase nothing c.yaml --set triangulation.order=2 --task 0 --of 1").code, 2);
  const Outcome memory = call(folder, "run c.yaml --set triangulation.order=2 --memory lots");
  EXPECT_EQ(memory.err.rfind("hydrotin: --memory: run.memory: 'lots'", 0), 0U) << memory.err;
  EXPECT_EQ(call(folder, "run none.yaml").err, "hydrotin: none.yaml: no such config file\n");
}

TEST(App, InputErrors_HaveExitCode3) {
  const TemporaryFolder folder;
  write_text(folder / "p.csv", "x,y,z\n1,2\n");
  write_text(folder / "line.csv", "x,y,z\n0,0,1\n1,1,1\n2,2,1\n");
  write_text(folder / "empty.csv", "x,y,z\n");
  for (const char* arguments :
       {"triangulate p.csv", "triangulate none.csv", "triangulate line.csv", "triangulate empty.csv", "fill p.csv",
        "fill none.ply", "info p.csv", "info none.las", "orders p.csv"}) {
    SCOPED_TRACE(arguments);
    const Outcome outcome = call(folder, arguments);
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_EQ(outcome.err.rfind("hydrotin: ", 0), 0U);
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << "one clear sentence";
  }
  EXPECT_EQ(call(folder, "triangulate p.csv").err, "hydrotin: p.csv:2:4: the line ends before its z\n");
}

TEST(App, Synth_MakesTilesThatInfoReads) {
  const TemporaryFolder folder;
  const Outcome made =
      call(folder, "synth a --kind fluvial --points 40000 --tiles 2x2 --seed 7 --noise 0.1 --voids --rivers");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_EQ(made.err, "");
  const Outcome info =
      call(folder, "info a/tile_0_0.las a/tile_1_0.las a/tile_0_1.las a/tile_1_1.las --json --checksum");
  ASSERT_EQ(info.code, 0) << info.err;
  const json files = json::parse(info.out).at("files");
  ASSERT_EQ(files.size(), 4U);
  std::uint64_t points = 0;
  std::set<std::string> checksums;
  for (const json& file : files) {
    points += file.at("points").get<std::uint64_t>();
    EXPECT_EQ(file.at("crs"), "EPSG:32631");
    EXPECT_EQ(file.at("complete"), true);
    EXPECT_EQ(file.at("problem"), nullptr);
    EXPECT_EQ(file.at("compressed"), false);
    EXPECT_EQ(file.at("classes"), json({{"2", file.at("points")}}));
    EXPECT_EQ(file.at("scale"), json({0.01, 0.01, 0.01}));
    EXPECT_GE(file.at("min").at(0).get<double>(), 500000);
    EXPECT_LE(file.at("max").at(0).get<double>(), 500200);
    checksums.insert(file.at("checksum").get<std::string>());
  }
  EXPECT_EQ(checksums.size(), 4U);
  EXPECT_GT(points, 30'000U);
  EXPECT_NE(made.out.find("points  " + std::to_string(points)), std::string::npos) << made.out;

  GDALAllRegister();
  GDALDatasetH rivers = GDALOpenEx((folder / "a/rivers.gpkg").c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr);
  ASSERT_NE(rivers, nullptr);
  EXPECT_GT(OGR_L_GetFeatureCount(GDALDatasetGetLayerByName(rivers, "rivers"), TRUE), 0);
  GDALClose(rivers);

  ASSERT_EQ(
      call(folder, "synth b --kind fluvial --points 40000 --tiles 2x2 --seed 7 --noise 0.1 --voids --rivers").code, 0);
  for (const char* name : {"tile_0_0.las", "tile_1_1.las", "rivers.gpkg"})
    EXPECT_EQ(read_text(folder / ("a/" + std::string(name))), read_text(folder / ("b/" + std::string(name)))) << name;
}

TEST(App, Synth_RefusesNonsense) {
  const TemporaryFolder folder;
  for (const char* arguments :
       {"--kind moon", "--tiles 2", "--tiles 0x2", "--tiles 2x", "--tiles 2x2x2", "--points 3", "--points 1e30",
        "--noise -1", "--noise nan", "--kind urban --rivers", "--points many"}) {
    SCOPED_TRACE(arguments);
    EXPECT_EQ(call(folder, "synth d " + std::string(arguments)).code, 2);
    EXPECT_FALSE(std::filesystem::exists(folder / "d"));
  }
}

TEST(App, Info_TellsWhatIsWrongWithEachFile) {
  const TemporaryFolder folder;
  ASSERT_EQ(call(folder, "synth . --kind lattice --points 2500").code, 0);
  const std::string whole = read_text(folder / "tile_0_0.las");
  write_text(folder / "cut.las", whole.substr(0, whole.size() / 2));
  write_text(folder / "text.las", "LASF, but not really");
  const Outcome outcome = call(folder, "info tile_0_0.las cut.las text.las none.las --json");
  EXPECT_EQ(outcome.code, 3);
  const json files = json::parse(outcome.out).at("files");
  EXPECT_EQ(files.at(0).at("complete"), true);
  EXPECT_EQ(files.at(0).at("points"), 2500);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_EQ(files.at(i).at("complete"), false) << i;
    EXPECT_TRUE(files.at(i).at("problem").is_string()) << i;
  }
}

TEST(App, Info_RealPair_HasOneChecksum) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const TemporaryFolder folder;
  const std::string file = testing::shared_path("quickstart/Blanca_in_Pozo_USGS_UTM11_NAD83_all_color_cl2_SC12.laz");
  const Outcome outcome = call(folder, "info --json '" + file + "'");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json info = json::parse(outcome.out).at("files").at(0);
  EXPECT_EQ(info.at("points"), 574092);
  EXPECT_EQ(info.at("classes"), json({{"2", 574092}}));
  EXPECT_EQ(info.at("crs"), "EPSG:26911");
  EXPECT_EQ(info.at("compressed"), true);
}

/// A folder with a small cloud of four files and a config for it.
void prepare_run(const TemporaryFolder& folder) {
  ASSERT_EQ(call(folder, "synth points --kind fluvial --points 30000 --tiles 2x2 --seed 3 --noise 0.2 --voids").code,
            0);
  write_text(
      folder / "c.yaml",
      "input: {points: [\"points/*.las\"]}\noutput: {dir: out}\ntiles: {target_points: 8000}\nrun: {workers: 2}\n");
}

TEST(App, Run_MakesAllResultsAndTheyCheck) {
  const TemporaryFolder folder;
  prepare_run(folder);
  const Outcome dry = call(folder, "run c.yaml --dry-run --json");
  ASSERT_EQ(dry.code, 0) << dry.err;
  EXPECT_GT(json::parse(dry.out).at("tiles"), 1);
  EXPECT_EQ(json::parse(dry.out).at("files"), 4);
  EXPECT_EQ(json::parse(dry.out), json::parse(call(folder, "plan c.yaml --json").out));
  EXPECT_FALSE(std::filesystem::exists(folder / "out")) << "a dry run writes nothing";

  const Outcome run = call(folder, "run c.yaml --json");
  ASSERT_EQ(run.code, 0) << run.err;
  const json summary = json::parse(run.out);
  EXPECT_EQ(summary.at("ok"), true);
  EXPECT_EQ(summary.at("pits"), 0);
  EXPECT_EQ(summary.at("points"), json::parse(dry.out).at("points"));
  for (const char* name : {"dem.tif", "hillshade.png", "layers.gpkg", "mesh", "report.txt", "report.json"})
    EXPECT_TRUE(std::filesystem::exists(folder / ("out/" + std::string(name)))) << name;
  EXPECT_NE(read_text(folder / "out/work/events.jsonl").find("\"event\":\"phase_ends\",\"phase\":\"report\""),
            std::string::npos);

  for (const char* target : {"c.yaml", "out"}) {
    const Outcome check = call(folder, std::string("check ") + target + " --json --order-sample 0");
    ASSERT_EQ(check.code, 0) << check.err;
    for (const char* key : {"ok", "points", "vertices", "duplicates", "triangles", "order", "max_triangle_order",
                            "pits", "river_edges", "invalid_river_edges", "problems", "fingerprint"})
      EXPECT_EQ(json::parse(check.out).at(key), summary.at(key)) << key;
  }
  EXPECT_EQ(call(folder, "report c.yaml").out, read_text(folder / "out/report.txt"));
  const json status = json::parse(call(folder, "status c.yaml --json").out);
  for (const json& phase : status.at("phases")) EXPECT_EQ(phase.at("done"), phase.at("units")) << phase;
}

TEST(App, Phases_AsTasksOfAJobArrayGiveTheSameTerrain) {
  const TemporaryFolder folder;
  prepare_run(folder);
  const json summary = json::parse(call(folder, "run c.yaml --json").out);
  const json status = json::parse(call(folder, "status c.yaml --json").out);
  ASSERT_FALSE(status.at("phases").empty());
  for (const json& phase : status.at("phases"))
    for (int task = 0; task < 2; ++task) {
      const Outcome outcome =
          call(folder, "phase " + phase.at("phase").get<std::string>() + " c.yaml --set output.dir=array --task " +
                           std::to_string(task) + " --of 2");
      ASSERT_EQ(outcome.code, 0) << outcome.err;
    }
  const Outcome check = call(folder, "check array --json");
  ASSERT_EQ(check.code, 0) << check.err;
  EXPECT_EQ(json::parse(check.out).at("fingerprint"), summary.at("fingerprint"));
}

TEST(App, Check_OfADamagedDataSet_HasExitCode6) {
  const TemporaryFolder folder;
  prepare_run(folder);
  ASSERT_EQ(call(folder, "run c.yaml").code, 0);
  const auto file = folder / "out/terrain/tile_000000.h5";
  std::string bytes = read_text(file);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  write_text(file, bytes);
  const Outcome check = call(folder, "check c.yaml --json");
  EXPECT_EQ(check.code, 6);
  const json result = json::parse(check.out);
  EXPECT_EQ(result.at("ok"), false);
  EXPECT_FALSE(result.at("problems").empty());
}

TEST(App, Triangulate_Order0_IsDelaunay) {
  const TemporaryFolder folder;
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    SCOPED_TRACE(seed);
    const auto points = random_points(seed, 60);
    write_text(folder / "p.csv", csv_of(points));
    const Outcome outcome = call(folder, "triangulate p.csv --order 0 --objective delaunay --json --out t.ply");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json result = json::parse(outcome.out);
    std::set<std::array<int, 3>> expected;
    for (int a = 0; a < 60; ++a)
      for (int b = a + 1; b < 60; ++b)
        for (int c = b + 1; c < 60; ++c)
          if (order_of(points, {a, b, c}) == 0) expected.insert({a, b, c});
    EXPECT_EQ(result.at("triangles").get<Triples>(), expected);
    EXPECT_EQ(result.at("max_triangle_order"), 0);
    EXPECT_EQ(result.at("points"), 60);
    const Mesh mesh = read_mesh(folder / "t.ply");
    EXPECT_EQ(mesh.vertex.size(), 60U);
    EXPECT_EQ(mesh.triangle.size(), expected.size());
    for (std::size_t v = 0; v < 60; ++v)
      for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(mesh.vertex[v][axis], points[v][axis], 1e-9) << "vertex i is row i";
    Triples written;
    for (const auto& t : mesh.triangle) {
      std::array<int, 3> rows{static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])};
      std::sort(rows.begin(), rows.end());
      written.insert(rows);
    }
    EXPECT_EQ(written, expected);
  }
}

TEST(App, Triangulate_KeepsItsOrderAndBounds) {
  const TemporaryFolder folder;
  const auto points = random_points(11, 400);
  write_text(folder / "p.csv", csv_of(points));
  std::map<std::pair<std::string, int>, double> values;
  for (const std::string objective : {"min-weight", "local-minima"})
    for (int order = 0; order <= 4; order += 2) {
      SCOPED_TRACE(objective + " " + std::to_string(order));
      const Outcome outcome =
          call(folder, "triangulate p.csv --order " + std::to_string(order) + " --objective " + objective + " --json");
      ASSERT_EQ(outcome.code, 0) << outcome.err;
      const json result = json::parse(outcome.out);
      int most = 0;
      double total = 0;
      std::map<std::pair<int, int>, int> edges;
      for (const auto& triangle : result.at("triangles").get<std::vector<std::array<int, 3>>>()) {
        most = std::max(most, order_of(points, triangle));
        total +=
            std::abs(area(points[static_cast<std::size_t>(triangle[0])], points[static_cast<std::size_t>(triangle[1])],
                          points[static_cast<std::size_t>(triangle[2])]));
        for (const auto& [a, b] : {std::pair{0, 1}, {1, 2}, {0, 2}})
          ++edges[{triangle[static_cast<std::size_t>(a)], triangle[static_cast<std::size_t>(b)]}];
      }
      EXPECT_LE(most, order);
      EXPECT_EQ(result.at("max_triangle_order"), most);
      static double hull = 0;
      if (order == 0) hull = total;
      EXPECT_NEAR(total, hull, 1e-6) << "the same hull is covered";
      const double value = result.at("value"), bound = result.at("bound");
      EXPECT_LE(bound, value + 1e-9);
      if (order > 0) {
        EXPECT_LE(value, (values[{objective, order - 2}]) + 1e-9) << "more freedom is never worse";
      }
      values[{objective, order}] = value;
      if (objective == "min-weight") {
        double length = 0;
        for (const auto& [edge, count] : edges) {
          const auto &a = points[static_cast<std::size_t>(edge.first)],
                     &b = points[static_cast<std::size_t>(edge.second)];
          length += std::hypot(a[0] - b[0], a[1] - b[1]);
        }
        EXPECT_NEAR(value, length, 1e-6);
      } else {
        EXPECT_EQ(result.at("local_minima").get<double>(), value);
      }
    }
}

TEST(App, Triangulate_RefusesWhatItCannotDo) {
  const TemporaryFolder folder;
  write_text(folder / "p.csv", "x,y,z\n0,0,1\n1,0,1\n0,1,1\n");
  for (const char* arguments : {"--order 21", "--order -1", "--objective best", "--order two"})
    EXPECT_EQ(call(folder, "triangulate p.csv " + std::string(arguments)).code, 2) << arguments;
  EXPECT_EQ(call(folder, "triangulate p.csv").code, 0);
}

TEST(App, Triangulate_PolygonsAndReferencesAreChecked) {
  const TemporaryFolder folder;
  write_text(folder / "p.csv", "x,y,z\n0,0,5\n10,0,4\n10,10,3\n0,10,1\n5,4,2\n");
  write_text(folder / "comb.csv", "x,y,z\n6,5,0\n19,5,0\n16,15,0\n14,14,0\n16,18,0\n14,17,0\n3,14,0\n");
  write_text(folder / "bow.csv", "x,y,z\n0,0,0\n4,4,0\n4,0,0\n0,4,0\n");
  write_text(folder / "e.csv", "a,b\n0,4\n");
  write_text(folder / "bad.csv", "a,b\n0,9\n");
  write_text(folder / "r.csv", "x,y,z\n5.5,2,3.25\n90,90,1\n0,0,7\n");
  const auto code = [&](const std::string& arguments) { return call(folder, "triangulate " + arguments).code; };
  const auto says = [&](const std::string& arguments, const std::string& what) {
    const Outcome outcome = call(folder, "triangulate " + arguments);
    EXPECT_NE(outcome.code, 0) << arguments;
    EXPECT_NE(outcome.err.find(what), std::string::npos) << outcome.err;
  };
  for (const char* arguments :
       {"p.csv --edges e.csv", "p.csv --boundary 4", "p.csv --objective min-max-error", "p.csv --max-error 1",
        "p.csv --objective min-weight,min-weight", "p.csv --objective delaunay,min-weight", "p.csv --method best",
        "p.csv --method hull --objective min-weight", "p.csv --reference r.csv --max-error -1",
        "p.csv --polygon --boundary 9", "p.csv --polygon --order -1"})
    EXPECT_EQ(code(arguments), 2) << arguments;
  EXPECT_EQ(code("bow.csv --polygon"), 3);
  EXPECT_EQ(code("p.csv --polygon --boundary 4 --edges bad.csv"), 3);
  EXPECT_EQ(code("p.csv --polygon --boundary 4 --edges e.csv"), 0);
  says("comb.csv --polygon --order 0", "the smallest order that has one is 1");
  says("bow.csv --polygon", "bow.csv: the edges (");
  says("p.csv --polygon --boundary 4 --edges bad.csv", "bad.csv:2:");
  const auto printed = nlohmann::json::parse(
      call(folder, "triangulate p.csv --order 2 --objective min-max-error,min-weight --reference r.csv --json").out);
  EXPECT_EQ(printed["objective"], "min-max-error,min-weight");
  EXPECT_EQ(printed["values"].size(), 2U);
  EXPECT_EQ(printed["reference"]["points"], 3);
  EXPECT_EQ(printed["reference"]["outside"], 1);
  EXPECT_EQ(printed["reference"]["at_vertices"], 1);
  EXPECT_EQ(printed["reference"]["max_error"], 2.0) << "the point at the corner is two above it";
  const auto polygon = nlohmann::json::parse(
      call(folder, "triangulate p.csv --polygon --boundary 4 --order 3 --objective max-min-angle --json").out);
  EXPECT_EQ(polygon["triangles"].size(), 4U);
  EXPECT_EQ(polygon["local_minima"], 1);
}

TEST(App, Orders_AreThoseOfTheDefinition) {
  const TemporaryFolder folder;
  auto points = random_points(3, 40);
  points.push_back(points[5]);  // a duplicate, not lower
  write_text(folder / "p.csv", csv_of(points));
  points.pop_back();
  const Outcome outcome = call(folder, "orders p.csv --order 3 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result.at("points"), 41);
  EXPECT_EQ(result.at("duplicates"), json::parse("[[40, 5]]"));
  std::set<std::pair<int, int>> useful;
  for (const auto& edge : result.at("useful_edges").get<std::vector<std::array<int, 3>>>())
    useful.insert({edge[0], edge[1]});
  std::set<std::array<int, 4>> expected;
  for (int a = 0; a < 40; ++a)
    for (int b = a + 1; b < 40; ++b)
      for (int c = b + 1; c < 40; ++c) {
        const int order = order_of(points, {a, b, c});
        if (order > 3 || !useful.contains({a, b}) || !useful.contains({b, c}) || !useful.contains({a, c})) continue;
        bool is_empty = true;
        for (int p = 0; p < 40 && is_empty; ++p) {
          if (p == a || p == b || p == c) continue;
          const auto at = [&](int i) { return points[static_cast<std::size_t>(i)]; };
          const bool left = area(at(a), at(b), at(p)) > 0, middle = area(at(b), at(c), at(p)) > 0,
                     right = area(at(c), at(a), at(p)) > 0;
          is_empty = !(left == middle && middle == right);
        }
        if (is_empty) expected.insert({a, b, c, order});
      }
  EXPECT_EQ(result.at("order_k_triangles").get<Quadruples>(), expected);
  std::size_t size = 0;
  for (const json& polygon : result.at("polygons")) size += polygon.at("size").get<std::size_t>();
  EXPECT_EQ(size, result.at("delaunay_triangles").size());
}

/// A terrain over a triangulated grid with heights of few values, as PLY.
Mesh grid_mesh(std::uint32_t seed, std::uint32_t side) {
  std::mt19937 random(seed);
  Mesh mesh;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x)
      mesh.vertex.push_back({x * 1.5, y * 1.5, 0.1 * static_cast<double>(random() % 7)});
  for (std::uint32_t y = 0; y + 1 < side; ++y)
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t v = y * side + x;
      mesh.triangle.push_back({v, v + 1, v + side});
      mesh.triangle.push_back({v + 1, v + side + 1, v + side});
    }
  return mesh;
}

std::vector<std::set<std::uint32_t>> neighbours_of(const Mesh& mesh) {
  std::vector<std::set<std::uint32_t>> neighbours(mesh.vertex.size());
  for (const auto& t : mesh.triangle)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        if (i != j) neighbours[t[i]].insert(t[j]);
  return neighbours;
}

/// The greatest solution of f(v) = max(h(v), min f(neighbour)), by sweeping until nothing changes.
std::vector<double> filled(const Mesh& mesh, const std::set<std::uint32_t>& outlets) {
  const auto neighbours = neighbours_of(mesh);
  std::vector<double> f(mesh.vertex.size(), std::numeric_limits<double>::infinity());
  for (const auto v : outlets) f[v] = mesh.vertex[v][2];
  for (bool changed = true; changed;) {
    changed = false;
    for (std::uint32_t v = 0; v < f.size(); ++v) {
      if (outlets.contains(v)) continue;
      double least = std::numeric_limits<double>::infinity();
      for (const auto w : neighbours[v]) least = std::min(least, f[w]);
      const double level = std::max(mesh.vertex[v][2], least);
      changed = changed || level != f[v];
      f[v] = level;
    }
  }
  return f;
}

TEST(App, Fill_LiftsToTheLeastPitFreeSurface) {
  const TemporaryFolder folder;
  for (std::uint32_t seed = 0; seed < 4; ++seed)
    for (const std::string outlets : {"hull", "lowest"}) {
      SCOPED_TRACE(outlets + std::to_string(seed));
      const Mesh mesh = grid_mesh(seed, 12);
      write_ply(folder / "t.ply", mesh.vertex, mesh.triangle, "");
      const Outcome outcome =
          call(folder, "fill t.ply --method lift --outlets " + outlets + " --json --out lifted.ply");
      ASSERT_EQ(outcome.code, 0) << outcome.err;
      const json result = json::parse(outcome.out);
      std::set<std::uint32_t> where;
      std::uint32_t lowest = 0;
      for (std::uint32_t v = 0; v < 144; ++v) {
        const auto key = [&](std::uint32_t i) {
          return std::tuple(mesh.vertex[i][2], mesh.vertex[i][0], mesh.vertex[i][1]);
        };
        if (key(v) < key(lowest)) lowest = v;
        if (outlets == "hull" && (v % 12 == 0 || v % 12 == 11 || v < 12 || v >= 132)) where.insert(v);
      }
      if (outlets == "lowest") where.insert(lowest);
      const auto expected = filled(mesh, where);
      EXPECT_EQ(result.at("heights").get<std::vector<double>>(), expected);
      double total = 0;
      int moved = 0;
      for (std::size_t v = 0; v < expected.size(); ++v) {
        total += expected[v] - mesh.vertex[v][2];
        moved += expected[v] != mesh.vertex[v][2] ? 1 : 0;
      }
      EXPECT_NEAR(result.at("total_displacement").get<double>(), total, 1e-9);
      EXPECT_EQ(result.at("vertices_moved"), moved);
      EXPECT_GT(result.at("minima_before"), 0);
      EXPECT_EQ(result.at("minima_after"), 0);
      EXPECT_EQ(result.at("vertices"), 144);
      const Mesh lifted = read_mesh(folder / "lifted.ply");
      for (std::size_t v = 0; v < expected.size(); ++v) EXPECT_EQ(lifted.vertex[v][2], expected[v]);
    }
}

/// A flat square with two holes of depth 1 and 2.
Mesh two_pits() {
  Mesh mesh = grid_mesh(0, 7);
  for (auto& vertex : mesh.vertex) vertex[2] = 10;
  mesh.vertex[16][2] = 9;
  mesh.vertex[32][2] = 8;
  return mesh;
}

TEST(App, Fill_OnlyTheChosenPits) {
  const TemporaryFolder folder;
  const Mesh mesh = two_pits();
  write_ply(folder / "t.ply", mesh.vertex, mesh.triangle, "");
  const json one = json::parse(call(folder, "fill t.ply --method lift --pits 32 --json").out);
  EXPECT_EQ(one.at("minima_before"), 2);
  EXPECT_EQ(one.at("minima_after"), 1);
  EXPECT_EQ(one.at("heights").at(16), 9);
  EXPECT_EQ(one.at("heights").at(32), 10);
  EXPECT_EQ(json::parse(call(folder, "fill t.ply --pits 32,16 --json").out).at("minima_after"), 0);
  EXPECT_EQ(call(folder, "fill t.ply --pits 3").code, 2);
  EXPECT_EQ(call(folder, "fill t.ply --pits 99").code, 2);
}

/// A fan of triangles around vertex 0 of the terrain of Figure 6.9 (1 - 5 - 10 - 3 - lowest), walled in by high
/// vertices.
Mesh figure_6_9() {
  Mesh mesh;
  mesh.vertex = {{0, 0, 1},    {1, 1, 5},   {2, 0, 10}, {4, 0, 3},  {6, 0, 0},
                 {-3, -5, 99}, {-3, 5, 99}, {8, 5, 99}, {8, -5, 99}};
  mesh.triangle = {{0, 2, 1}, {0, 1, 6}, {0, 6, 5}, {0, 5, 2}, {1, 2, 6}, {2, 7, 6},
                   {2, 3, 7}, {3, 4, 7}, {2, 5, 8}, {2, 8, 3}, {3, 8, 4}, {4, 8, 7}};
  return mesh;
}

TEST(App, Fill_Figure6_9InAllMethodsAndMeasures) {
  const TemporaryFolder folder;
  const Mesh mesh = figure_6_9();
  write_ply(folder / "t.ply", mesh.vertex, mesh.triangle, "");
  write_text(folder / "outlet.csv", "a,b\n4,4\n");
  const std::map<std::string, double> total{{"lift", 14}, {"breach", 11}, {"greedy-breach", 11}, {"least-change", 9}};
  for (const auto& [method, expected] : total)
    for (const std::string measure : {"total", "max", "count", "volume"})
      for (const std::string outlets : {"lowest", "outlet.csv"}) {
        SCOPED_TRACE(method + measure + outlets);
        const Outcome outcome = call(folder, "fill t.ply --json --out new.ply --method " + method + " --measure " +
                                                 measure + " --outlets " + outlets);
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        const json result = json::parse(outcome.out);
        EXPECT_EQ(result.at("method"), method);
        EXPECT_EQ(result.at("measure"), measure);
        EXPECT_EQ(result.at("minima_before"), 1);
        EXPECT_EQ(result.at("minima_after"), 0);
        EXPECT_LE(result.at("bound").get<double>(), measure == "max"     ? result.at("max_displacement").get<double>()
                                                    : measure == "count" ? result.at("vertices_moved").get<double>()
                                                    : measure == "volume"
                                                        ? result.at("volume_change").get<double>() + 1e-9
                                                        : result.at("total_displacement").get<double>());
        if (measure == "total") {
          EXPECT_EQ(result.at("total_displacement"), expected);
        }
        if (measure == "total") {
          EXPECT_TRUE(result.at("optimal"));
        }
        if (measure == "max") {
          EXPECT_EQ(result.at("max_displacement"), method == "least-change" ? 5 : 9);
        }
        const Mesh changed = read_mesh(folder / "new.ply");
        for (std::size_t v = 0; v < mesh.vertex.size(); ++v)
          EXPECT_EQ(result.at("heights").at(v), changed.vertex[v][2]);
        const json again =
            json::parse(call(folder, "fill new.ply --json --method " + method + " --outlets " + outlets).out);
        EXPECT_EQ(again.at("vertices_moved"), 0);
      }
}

// Heights that no lattice of 32 bits holds.
TEST(App, Fill_HeightsWithAllDigits) {
  const TemporaryFolder folder;
  for (std::uint32_t seed = 0; seed < 3; ++seed) {
    Mesh mesh = grid_mesh(seed, 12);
    std::mt19937 random(seed);
    for (auto& vertex : mesh.vertex) vertex[2] = std::sqrt(static_cast<double>(random() % 1000)) / 3;
    write_ply(folder / "t.ply", mesh.vertex, mesh.triangle, "");
    double lift_total = 0;
    for (const std::string method : {"lift", "breach", "greedy-breach", "least-change"}) {
      SCOPED_TRACE(method);
      const Outcome outcome = call(folder, "fill t.ply --json --method " + method);
      ASSERT_EQ(outcome.code, 0) << outcome.err;
      const json result = json::parse(outcome.out);
      EXPECT_EQ(result.at("minima_after"), 0);
      const double cost = result.at("total_displacement");
      if (method == "lift") lift_total = cost;
      if (method == "least-change") {
        EXPECT_LE(cost, lift_total * (1 + 1e-9));
      }
    }
  }
}

TEST(App, Fill_RefusesBadOutlets) {
  const TemporaryFolder folder;
  const Mesh mesh = figure_6_9();
  write_ply(folder / "t.ply", mesh.vertex, mesh.triangle, "");
  int number = 0;
  for (const char* text : {"a,b\n4,9\n", "a,b\n4;5\n", "a,b\n1,2,3\n", "a\n-1\n", "a\nx\n", "a\n", ""}) {
    SCOPED_TRACE(text);
    write_text(folder / "o.csv", text);
    const Outcome outcome = call(folder, "fill t.ply --outlets o.csv");
    EXPECT_EQ(outcome.code, 3);
    EXPECT_FALSE(outcome.err.empty());
    if (++number < 6) {
      EXPECT_NE(outcome.err.find("o.csv:2"), std::string::npos) << outcome.err;
    }
  }
  EXPECT_EQ(call(folder, "fill t.ply --outlets lowest --pits 4").code, 2);
}

TEST(App, Fill_RefusesWhatIsNoTerrain) {
  const TemporaryFolder folder;
  Mesh mesh = two_pits();
  write_ply(folder / "good.ply", mesh.vertex, mesh.triangle, "");
  for (const char* arguments : {"--method dig", "--measure beauty", "--outlets sea"})
    EXPECT_EQ(call(folder, "fill good.ply " + std::string(arguments)).code, 2) << arguments;
  Mesh doubled = mesh;
  doubled.vertex[3] = doubled.vertex[2];
  write_ply(folder / "doubled.ply", doubled.vertex, doubled.triangle, "");
  EXPECT_NE(call(folder, "fill doubled.ply").err.find("vertices 2 and 3 have the same x and y"), std::string::npos);
  Mesh fins = mesh;
  fins.triangle.push_back({8, 9, 40});
  write_ply(folder / "fins.ply", fins.vertex, fins.triangle, "");
  EXPECT_NE(call(folder, "fill fins.ply").err.find("belongs to 3 triangles"), std::string::npos);
  Mesh pieces = mesh;
  for (const MeshVertex v : {MeshVertex{50, 50, 1}, {51, 50, 1}, {50, 51, 1}}) pieces.vertex.push_back(v);
  pieces.triangle.push_back({49, 50, 51});
  write_ply(folder / "pieces.ply", pieces.vertex, pieces.triangle, "");
  EXPECT_EQ(call(folder, "fill pieces.ply --outlets hull").code, 0);
  const Outcome outcome = call(folder, "fill pieces.ply --outlets lowest");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_NE(outcome.err.find("several pieces"), std::string::npos);
}

}  // namespace
}  // namespace hydrotin
