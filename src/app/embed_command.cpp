#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "edge_list.h"
#include "embed_fill.h"
#include "embed_input.h"
#include "embed_layers.h"
#include "embed_options.h"
#include "hydrotin/error.h"
#include "hydrotin/mesh.h"
#include "hydrotin/river_burning.h"
#include "hydrotin/river_embedding.h"
#include "hydrotin/river_statistics.h"
#include "profile_svg.h"
#include "worker_executor.h"

namespace hydrotin::app {
namespace {

// Doubles without margin: what the simplex leaves open does not count as a fault or a move.
constexpr double kUnstoredTolerance = 1e-7;
constexpr std::size_t kMostListed = 10, kMostRivers = 25;

struct EmbedResult {
  Embedding embedding;
  std::optional<RiverFill> fill;
  std::vector<double> height;  ///< final
  RiverStatistics before, after;
  HeightChange change;
  NamedRivers rivers;
};

Embedding burn(const EmbedArguments& arguments, const EmbedInput& input, const EmbeddingOptions& options) {
  BurnedEmbedding burned = embed_by_burning(input.terrain(), input.rivers, options);
  const auto [from, to] = burned.edge;
  const std::string edge = fmt::format("the river edge {} -> {}", from, to);
  if (burned.fault == BurningFault::not_a_forest)
    throw Error(ErrorKind::input, fmt::format("{}: {} leaves a vertex that has a river edge down already "
                                              "(--method dp wants rivers that only merge; use --method lp)",
                                              input.rivers_path, edge));
  if (burned.fault == BurningFault::river_at_wingtip)
    throw Error(ErrorKind::input, fmt::format("{}: a triangle at {} has a third river vertex "
                                              "(--method dp cannot handle it; use --method lp)",
                                              input.rivers_path, edge));
  if (burned.fault == BurningFault::infeasible)
    throw Error(ErrorKind::input, fmt::format("{}: the river down to and with {} cannot be embedded by moving river "
                                              "vertices only (use --method lp without --river-only)",
                                              arguments.tin, edge));
  return std::move(burned.embedding);
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
    fmt::print(stderr, "hydrotin: near x {} y {}: the {} row of vertices {} {}: {} m are missing{}\n", place[0],
               place[1], name_of(broken.kind), fmt::join(broken.vertex, ", "),
               embedding.optimal ? "contradicts others" : "does not hold yet", broken.missing,
               broken.is_strict_part ? " of what goes beyond the weak row" : "");
  }
}

/// What the lines called for that the user should know.
void warn_about_lines(const EmbedInput& input) {
  if (!input.lines) return;
  const LineMatch& match = *input.lines;
  const auto feature = [&](std::uint32_t part) { return fmt::format("{}", match.parts.feature[part]); };
  for (std::size_t i = 0; i < match.cycles.size(); ++i) {
    if (i == kMostListed) {
      fmt::print(stderr, "hydrotin: and {} circles more (see the layer lines)\n", match.cycles.size() - i);
      break;
    }
    std::vector<std::string> names;
    for (const std::uint32_t part : match.cycles[i])
      if (names.size() < kMostListed) names.push_back(feature(part));
    fmt::print(stderr,
               "hydrotin: {}: features {}{} run in a circle: of feature {}, which rises most, the reach in it was left "
               "out (turn or remove one)\n",
               input.rivers_path, fmt::join(names, ", "), match.cycles[i].size() > names.size() ? ", ..." : "",
               names[0]);
  }
  if (!match.disagrees.empty())
    fmt::print(stderr, "hydrotin: {}: {} of {} lines rise downstream, by the terrain (see the layer lines_that_rise)\n",
               input.rivers_path, match.disagrees.size(), match.parts.size());
  for (const RiverMouth& mouth : input.mouths.mouth)
    if (mouth.kind == MouthKind::closed)
      fmt::print(stderr,
                 "hydrotin: near x {} y {}: the river ends inside its own course: its mouth counts as an outlet\n",
                 input.position[mouth.vertex][0], input.position[mouth.vertex][1]);
}

nlohmann::ordered_json river_rows(const NamedRivers& rivers) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < rivers.name.size(); ++i) {
    const RiverRow& row = rivers.row[i];
    list.push_back({{"name", rivers.name[i]},
                    {"edges", row.edges},
                    {"length", row.length},
                    {"drop_before", row.drop_before},
                    {"drop_after", row.drop_after},
                    {"wrong_flow_before", row.wrong_flow_before},
                    {"not_valley_before", row.not_valley_before},
                    {"flat_before", row.flat_before},
                    {"leak_vertices_before", row.leaks_before},
                    {"wrong_flow_after", row.wrong_flow_after},
                    {"not_valley_after", row.not_valley_after},
                    {"flat_after", row.flat_after},
                    {"leak_vertices_after", row.leaks_after},
                    {"vertices_moved", row.moved},
                    {"total_change", row.total},
                    {"average_change", row.moved > 0 ? row.total / static_cast<double>(row.moved) : 0.0},
                    {"max_change", row.largest}});
  }
  return list;
}

nlohmann::ordered_json fill_fields(const RiverFill& fill) {
  return {{"pits_before", fill.pits_before},
          {"pits_after", fill.pits_after},
          {"vertices_moved", fill.moved},
          {"river_vertices_moved", fill.river_vertices_moved},
          {"total_change", fill.total},
          {"max_change", fill.largest},
          {"slopes_beyond_limit", fill.slopes_beyond_limit}};
}

void print_json(const EmbedInput& input, const EmbedResult& result) {
  nlohmann::ordered_json heights = nlohmann::ordered_json::array(), broken = nlohmann::ordered_json::array();
  for (const double h : result.height) heights.push_back(h);
  for (const BrokenRow& row : result.embedding.broken)
    broken.push_back({{"constraint", name_of(row.kind)}, {"vertices", row.vertex}, {"missing", row.missing}});
  nlohmann::ordered_json json = {{"river_edges", input.rivers.size()},
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
                                 {"broken", broken}};
  json["flat_river_edges_before"] = result.before.flat_edges;
  json["leak_vertices_before"] = result.before.leak_vertices;
  json["total_change"] = result.change.total;
  json["vertices_added"] = input.position.size() - input.num_given;
  json["rivers"] = river_rows(result.rivers);
  if (input.lines) {
    nlohmann::ordered_json steps;
    for (const auto& [name, number] : input.lines->counts) steps[name] = number;
    json["lines"] = steps;
  }
  if (result.fill) json["fill"] = fill_fields(*result.fill);
  json["heights"] = heights;
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
             "total change", result.change.total, "average change", result.change.average, "max change",
             result.change.largest);
  fmt::print("{:<20}{:>24}\n{:<20}{:>24}\n{:<20}{:>24}\n", "rows", result.embedding.rows, "columns",
             result.embedding.columns, "rounds", result.embedding.rounds);
}

void print_lines(const EmbedInput& input) {
  if (!input.lines) return;
  fmt::print("\nlines\n");
  for (const auto& [name, number] : input.lines->counts) {
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    fmt::print("{:<32}{:>12}\n", words, number);
  }
}

void print_fill(const EmbedResult& result) {
  if (!result.fill) return;
  const RiverFill& fill = *result.fill;
  fmt::print(
      "\npits\n{:<32}{:>12}\n{:<32}{:>12}\n{:<32}{:>12}\n{:<32}{:>12}\n{:<32}{:>12.6f}\n{:<32}{:>12.6f}\n{:<32}{:>12}"
      "\n",
      "before", fill.pits_before, "after", fill.pits_after, "vertices moved", fill.moved, "of these on rivers",
      fill.river_vertices_moved, "total change", fill.total, "max change", fill.largest, "slopes beyond the limit",
      fill.slopes_beyond_limit);
}

/// The tables of Section 7.2, a river a line.
void print_rivers(const NamedRivers& rivers) {
  if (rivers.name.empty() || (rivers.name.size() == 1 && rivers.name[0].starts_with("network"))) return;
  fmt::print("\n{:<28}{:>7}{:>11}  {:>13}{:>13}{:>11}{:>11}{:>9}{:>11}{:>9}\n", "river", "edges", "length",
             "wrong flow", "not valley", "flat", "leaks", "moved", "change", "average");
  for (std::size_t i = 0; i < rivers.name.size(); ++i) {
    if (i == kMostRivers) {
      fmt::print("and {} more (all of them: --json)\n", rivers.name.size() - i);
      break;
    }
    const RiverRow& r = rivers.row[i];
    const auto pair = [](std::uint64_t a, std::uint64_t b) { return fmt::format("{} > {}", a, b); };
    fmt::print("{:<28.27}{:>7}{:>11.0f}  {:>13}{:>13}{:>11}{:>11}{:>9}{:>11.2f}{:>9.3f}\n", rivers.name[i], r.edges,
               r.length, pair(r.wrong_flow_before, r.wrong_flow_after), pair(r.not_valley_before, r.not_valley_after),
               pair(r.flat_before, r.flat_after), pair(r.leaks_before, r.leaks_after), r.moved, r.total,
               r.moved > 0 ? r.total / static_cast<double>(r.moved) : 0.0);
  }
}

void write_outputs(const EmbedArguments& arguments, const EmbedInput& input, const EmbeddingOptions& options,
                   const EmbedResult& result, double tolerance) {
  if (!arguments.out.empty()) {
    std::vector<MeshVertex> vertices = input.mesh.vertex;
    for (std::size_t v = 0; v < vertices.size(); ++v) vertices[v][2] = result.height[v];
    write_ply(arguments.out, vertices, input.mesh.triangle, input.mesh.crs_wkt);
  }
  if (!arguments.layers.empty())
    write_layers(arguments.layers, input, options, result.embedding, result.height, result.rivers, tolerance);
  if (!arguments.profiles.empty()) write_profiles(arguments.profiles, input, result.height, result.rivers);
  if (!arguments.points_out.empty()) write_river_points(arguments.points_out, input, result.height);
}

int embed(const EmbedArguments& arguments) {
  EmbeddingOptions options = embedding_options(arguments);
  const EmbedInput input = read_embed_input(arguments, options.constraints);
  if (arguments.time_limit > 0) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(arguments.time_limit);
    options.stop = [end] { return std::chrono::steady_clock::now() >= end; };
  }
  options.executor = worker_executor(arguments.workers);
  const RiverTerrain terrain = input.terrain();
  const double tolerance = options.quantum > 0 ? 0 : kUnstoredTolerance;
  EmbedResult result;
  result.embedding =
      arguments.method == "dp" ? burn(arguments, input, options) : embed_rivers(terrain, input.rivers, options);
  result.height = result.embedding.height;
  if (!arguments.fill.empty()) {
    result.fill = fill_rivers(arguments.fill, input, options.constraints, result.embedding.height, tolerance);
    result.height = result.fill->height;
  }
  result.before = river_statistics(terrain, input.rivers, input.height, tolerance);
  result.after = river_statistics(terrain, input.rivers, result.height, tolerance);
  result.change = height_change(input.height, result.height, tolerance);
  result.rivers = name_rivers(input, result.height, tolerance);
  write_outputs(arguments, input, options, result, tolerance);
  warn(input, result.embedding);
  warn_about_lines(input);
  if (arguments.json) {
    print_json(input, result);
    return 0;
  }
  print_table(input, result);
  print_rivers(result.rivers);
  print_fill(result);
  print_lines(input);
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
