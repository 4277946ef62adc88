#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "hydrotin/mesh.h"
#include "program_call.h"

namespace hydrotin {
namespace {

using nlohmann::json;
using testing::call;
using testing::Outcome;
using testing::read_text;
using testing::TemporaryFolder;
using testing::write_text;

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
          EXPECT_EQ(result.at("max_displacement"), method == "least-change" ? 4.5 : 9);
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
