#include <gdal.h>
#include <gtest/gtest.h>
#include <ogr_api.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "csv_text.h"
#include "program_call.h"
#include "shared_data.h"

namespace hydrotin {
namespace {

using nlohmann::json;
using testing::call;
using testing::csv_of;
using testing::Outcome;
using testing::random_points;
using testing::read_text;
using testing::TemporaryFolder;
using testing::write_text;

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
}  // namespace
}  // namespace hydrotin
