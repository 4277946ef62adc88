// What users see of rivers is the same whether the terrain is in tiles (`run`) or in memory (`embed`).

#include "hydrotin/river_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "layer_rows.h"
#include "program_call.h"

namespace hydrotin {
namespace {

using testing::call;
using testing::read_layers;
using testing::read_text;
using testing::TemporaryFolder;
using testing::write_text;

// What only a TIN in memory has.
const std::set<std::string> kNumbers{"vertex", "vertices", "from", "to"};
const std::vector<std::string> kLayers{"river_edges",     "moved_vertices", "binding_limits",
                                       "largest_changes", "contradictions", "mouths",
                                       "outlet_chains",   "lines",          "lines_that_rise"};

void expect_ok(const testing::Outcome& outcome) {
  ASSERT_EQ(outcome.code, 0) << outcome.err;
}

/// Points, river lines, and the TIN without rivers as one mesh.
void make_scene(const TemporaryFolder& folder) {
  expect_ok(call(folder, "synth data --kind fluvial --points 40000 --tiles 1x1 --seed 3 --rivers --noise 0.3"));
  write_text(folder / "plain.yaml",
             "input: {points: [data/tile_0_0.las], classes: all}\noutput: {dir: plain, dem: false}\n"
             "triangulation: {order: 1}\npits: {method: none}\n");
  expect_ok(call(folder, "run plain.yaml"));
}

void run_rivers(const TemporaryFolder& folder, const std::string& out, const std::string& rivers,
                const std::string& target) {
  write_text(folder / (out + ".yaml"),
             "input: {points: [data/tile_0_0.las], classes: all, rivers: data/rivers.gpkg}\noutput: {dir: " + out +
                 ", dem: false, mesh: []}\ntriangulation: {order: 1}\ntiles: {target_points: " + target +
                 "}\npits: {method: none}\nrivers: {" + rivers + "}\n");
  const auto outcome = call(folder, "run " + out + ".yaml");
  ASSERT_TRUE(outcome.code == 0 || outcome.code == 6) << outcome.err;
}

/// The sum of all changes.
double change_in(const testing::LayerRows& moved) {
  double sum = 0;
  for (const auto& row : moved.row) sum += std::abs(row.real.at(2));  // before, after, change
  return sum;
}

TEST(RiverLayers, RunAndEmbedWriteTheSame) {
  const TemporaryFolder folder;
  make_scene(folder);
  struct Case {
    const char *name, *config, *options;
    std::vector<std::string> same, not_empty;
  };
  // There may be several best answers: heights are compared by what they cost together.
  const std::vector<Case> cases{
      {"freely",
       "variant: VFRS",
       "",
       {"river_edges", "mouths", "outlet_chains", "lines", "lines_that_rise", "contradictions"},
       {"moved_vertices", "binding_limits", "mouths"}},
      {"limited", "max_change_m: 0.3", "--max-change 0.3", {"mouths", "lines"}, {"largest_changes", "contradictions"}},
      {"against", "direction: reversed", "--direction reversed", {"lines", "lines_that_rise"}, {"lines_that_rise"}}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const std::string in_memory_file = folder / (std::string(c.name) + ".gpkg");
    expect_ok(call(folder, std::string("embed plain/mesh/tile_000000.ply --rivers data/rivers.gpkg --quantum 0.01 ") +
                               c.options + " --layers " + c.name + ".gpkg"));
    run_rivers(folder, c.name, c.config, "20000");
    const auto in_memory = read_layers(in_memory_file, kNumbers);
    const auto in_tiles = read_layers(folder / (std::string(c.name) + "/layers.gpkg"), kNumbers);
    for (const std::string& layer : kLayers) {
      SCOPED_TRACE(layer);
      ASSERT_TRUE(in_memory.contains(layer) && in_tiles.contains(layer));
      EXPECT_EQ(in_tiles.at(layer).field, in_memory.at(layer).field);
    }
    for (const std::string& layer : c.same) {
      SCOPED_TRACE(layer);
      testing::expect_same_rows(in_tiles.at(layer), in_memory.at(layer), layer == "mouths" ? 1 : 2);
    }
    for (const std::string& layer : c.not_empty) {
      EXPECT_FALSE(in_tiles.at(layer).row.empty()) << layer;
      EXPECT_FALSE(in_memory.at(layer).row.empty()) << layer;
    }
    if (c.options[0] != 0) continue;
    const double cost = change_in(in_memory.at("moved_vertices"));
    EXPECT_NEAR(change_in(in_tiles.at("moved_vertices")), cost, 0.002 * cost);
    std::size_t was_wrong = 0;
    for (const auto& row : in_tiles.at("river_edges").row)
      was_wrong += row.text.find("is valid, before it flows uphill") != std::string::npos ? 1 : 0;
    EXPECT_GT(was_wrong, 10U);
  }
}

TEST(RiverLayers, StatusSaysWhatChanged) {
  EXPECT_EQ(river_edge_status({}, {}), "is valid");
  EXPECT_EQ(river_edge_status({false, false, true}, {}), "is valid, before it was level");
  EXPECT_EQ(river_edge_status({true, true, false}, {false, true, false}),
            "is no valley, before it flows uphill and is no valley");
  EXPECT_EQ(river_edge_status({false, true, false}, {true, false, false}), "flows uphill, before it was no valley");
}

}  // namespace
}  // namespace hydrotin
