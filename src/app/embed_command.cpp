#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands.h"
#include "edge_list.h"
#include "embed_input.h"
#include "embed_options.h"
#include "hydrotin/error.h"
#include "hydrotin/mesh.h"
#include "hydrotin/river_burning.h"
#include "hydrotin/river_embedding.h"
#include "hydrotin/river_statistics.h"

namespace hydrotin::app {
namespace {

// Doubles without margin: what the simplex leaves open does not count as a fault or a move.
constexpr double kUnstoredTolerance = 1e-7;
constexpr std::size_t kMostListed = 10;

struct EmbedResult {
  Embedding embedding;
  RiverStatistics before, after;
  HeightChange change;
};

Embedding burn(const EmbedArguments& arguments, const EmbedInput& input, const RiverConstraints& constraints) {
  const RiverTerrain terrain = input.terrain();
  std::vector<double> decline(input.rivers.size(), 0.0);
  if (constraints.decline_measure == DeclineMeasure::fraction)
    decline = fractional_declines(terrain, input.rivers, constraints.decline);
  if (constraints.decline_measure == DeclineMeasure::slope)
    for (std::size_t e = 0; e < decline.size(); ++e) decline[e] = constraints.decline * input.length(input.rivers[e]);
  Burning burning = burn_rivers(terrain, input.rivers, decline, constraints.side_slope);
  const std::string edge = burning.fault == BurningFault::none ? "" : input.name_of(burning.edge);
  if (burning.fault == BurningFault::not_a_forest)
    throw Error(ErrorKind::input, fmt::format("{}: {} leaves a vertex that has a river edge down already "
                                              "(--method dp wants rivers that only merge; use --method lp)",
                                              input.rivers_path, edge));
  if (burning.fault == BurningFault::river_at_wingtip)
    throw Error(ErrorKind::input, fmt::format("{}: a triangle at {} has a third river vertex "
                                              "(--method dp cannot handle it; use --method lp)",
                                              input.rivers_path, edge));
  if (burning.fault == BurningFault::infeasible)
    throw Error(ErrorKind::input, fmt::format("{}: the river down to and with {} cannot be embedded by moving river "
                                              "vertices only (use --method lp without --river-only)",
                                              arguments.tin, edge));
  Embedding embedding;
  embedding.height = std::move(burning.height);
  embedding.objective = embedding.bound = burning.objective;
  embedding.optimal = true;
  embedding.rounds = 1;
  embedding.rows = input.rivers.size() + input.num_wingtips();
  embedding.columns = input.num_river_vertices();
  return embedding;
}

void warn(const EmbedInput& input, const Embedding& embedding) {
  for (const std::uint32_t network : embedding.clamped_networks)
    fmt::print(stderr, "hydrotin: the average slope of river network {} is not positive: its decline is set to 0\n",
               network);
  if (!embedding.optimal)
    fmt::print(stderr, "hydrotin: stopped before the optimum: no answer is better than {}\n", embedding.bound);
  for (std::size_t i = 0; i < embedding.broken.size(); ++i) {
    if (i == kMostListed) {
      fmt::print(stderr, "hydrotin: and {} more\n", embedding.broken.size() - i);
      break;
    }
    const BrokenRow& broken = embedding.broken[i];
    const auto& place = input.position[broken.vertex.front()];
    fmt::print(stderr, "hydrotin: near x {} y {}: the {} row of vertices {} contradicts others: {} m are missing{}\n",
               place[0], place[1], name_of(broken.kind), fmt::join(broken.vertex, ", "), broken.missing,
               broken.is_strict_part ? " of what goes beyond the weak row" : "");
  }
}

void print_json(const EmbedInput& input, const EmbedResult& result) {
  nlohmann::ordered_json heights = nlohmann::ordered_json::array(), broken = nlohmann::ordered_json::array();
  for (const double h : result.embedding.height) heights.push_back(h);
  for (const BrokenRow& row : result.embedding.broken)
    broken.push_back({{"constraint", name_of(row.kind)}, {"vertices", row.vertex}, {"missing", row.missing}});
  const nlohmann::ordered_json json = {{"river_edges", input.rivers.size()},
                                       {"wrong_flow_before", result.before.wrong_flow},
                                       {"not_valley_before", result.before.not_valley},
                                       {"wrong_flow_after", result.after.wrong_flow},
                                       {"not_valley_after", result.after.not_valley},
                                       {"rows", result.embedding.rows},
                                       {"columns", result.embedding.columns},
                                       {"rounds", result.embedding.rounds},
                                       {"objective", result.embedding.objective},
                                       {"bound", result.embedding.bound},
                                       {"optimal", result.embedding.optimal},
                                       {"vertices_moved", result.change.moved},
                                       {"average_change", result.change.average},
                                       {"max_change", result.change.largest},
                                       {"flat_river_edges", result.after.flat_edges},
                                       {"leak_vertices", result.after.leak_vertices},
                                       {"local_minima_before", result.before.local_minima},
                                       {"local_minima_after", result.after.local_minima},
                                       {"broken", broken},
                                       {"heights", heights}};
  fmt::print("{}\n", json.dump());
}

void print_table(const EmbedInput& input, const EmbedResult& result) {
  const auto line = [](const char* name, auto before, auto after) {
    fmt::print("{:<20}{:>12}{:>12}\n", name, before, after);
  };
  line("", "before", "after");
  line("river edges", input.rivers.size(), input.rivers.size());
  line("wrong flow", result.before.wrong_flow, result.after.wrong_flow);
  line("not valley", result.before.not_valley, result.after.not_valley);
  line("flat river edges", result.before.flat_edges, result.after.flat_edges);
  line("leak vertices", result.before.leak_vertices, result.after.leak_vertices);
  line("local minima", result.before.local_minima, result.after.local_minima);
  fmt::print("{:<20}{:>24}\n{:<20}{:>24.6f}\n{:<20}{:>24.6f}\n{:<20}{:>24.6f}\n", "vertices moved", result.change.moved,
             "total change", result.embedding.objective, "average change", result.change.average, "max change",
             result.change.largest);
  fmt::print("{:<20}{:>24}\n{:<20}{:>24}\n{:<20}{:>24}\n", "rows", result.embedding.rows, "columns",
             result.embedding.columns, "rounds", result.embedding.rounds);
}

int embed(const EmbedArguments& arguments) {
  EmbeddingOptions options = embedding_options(arguments);
  const EmbedInput input = read_embed_input(arguments, options.constraints);
  if (arguments.time_limit > 0) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(arguments.time_limit);
    options.stop = [end] { return std::chrono::steady_clock::now() >= end; };
  }
  const RiverTerrain terrain = input.terrain();
  const double tolerance = options.quantum > 0 ? 0 : kUnstoredTolerance;
  EmbedResult result;
  result.embedding = arguments.method == "dp" ? burn(arguments, input, options.constraints)
                                              : embed_rivers(terrain, input.rivers, options);
  result.before = river_statistics(terrain, input.rivers, input.height, tolerance);
  result.after = river_statistics(terrain, input.rivers, result.embedding.height, tolerance);
  result.change = height_change(input.height, result.embedding.height, tolerance);
  if (!arguments.out.empty()) {
    std::vector<MeshVertex> vertices = input.mesh.vertex;
    for (std::size_t v = 0; v < vertices.size(); ++v) vertices[v][2] = result.embedding.height[v];
    write_ply(arguments.out, vertices, input.mesh.triangle, input.mesh.crs_wkt);
  }
  warn(input, result.embedding);
  arguments.json ? print_json(input, result) : print_table(input, result);
  return 0;
}

}  // namespace

void add_embed_command(CLI::App& program, Action& action) {
  auto arguments = std::make_shared<EmbedArguments>();
  CLI::App* command = program.add_subcommand("embed", "make river edges of one TIN valley edges, with least change");
  add_embed_options(*command, *arguments);
  command->callback([arguments, &action] { action = [arguments] { return embed(*arguments); }; });
}

}  // namespace hydrotin::app
