#include "fill_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

#include "config.h"
#include "hydrotin/error.h"

namespace hydrotin::app {
namespace {

void add_choice_of_pits(CLI::App& command, FillArguments& arguments) {
  command.add_option("--pits", arguments.pits, "remove only the pits of these vertices")
      ->delimiter(',')
      ->type_name("V,V,...");
  command
      .add_option("--keep", arguments.keep,
                  "pits that stay: deeper_than_m=M, larger_than_m2=A, volume_above_m3=V, inside=POLYGONS, "
                  "ids=[N,N,...] of --table; combine=or (one is enough, the default) or combine=and")
      ->type_name("KEY=VALUE ...");
  command.add_option("--cheapest", arguments.cheapest, "remove only so many, those that are cheapest to lift together")
      ->type_name("N");
}

void add_outlets(CLI::App& command, FillArguments& arguments) {
  command
      .add_option(
          "--outlets", arguments.outlets,
          "hull: water may leave at the rim; lowest: at the lowest vertex only; a CSV file: at the vertices in it "
          "(a header line, then one or two indices a line); any other file: at its points, lines or polygons")
      ->capture_default_str();
  command.add_flag("--voids-drain", arguments.voids_drain, "water may leave at triangles with a long edge too");
  command.add_option("--void-edge", arguments.void_edge, "which edges are long [m] (default: 100)")->type_name("M");
  command.add_option("--crs", arguments.crs, "of the TIN, in place of its own")->type_name("EPSG:n");
}

void add_results(CLI::App& command, FillArguments& arguments) {
  command.add_option("--out", arguments.out, "write the new TIN")->type_name("TIN.ply");
  command.add_option("--layers", arguments.layers, "write pits, lifted regions and breaches as layers")
      ->type_name("FILE.gpkg");
  command.add_option("--table", arguments.table, "write the pits as a table")->type_name("FILE.csv");
  command.add_option("--change-raster", arguments.change_raster, "write new minus old heights where they differ")
      ->type_name("FILE.tif");
  command.add_option("--cell", arguments.cell, "side of its cells [m]")->capture_default_str()->type_name("M");
  command.add_option("--max-edge", arguments.max_edge, "triangles with a longer edge have no cells [m]; 0: all have")
      ->capture_default_str()
      ->type_name("M");
  command.add_flag("--json", arguments.json, "print JSON");
}

}  // namespace

void add_fill_options(CLI::App& command, FillArguments& arguments) {
  command.add_option("tin", arguments.tin, "PLY or OBJ")->required()->type_name("TIN");
  command
      .add_option("--method", arguments.method,
                  "lift: raise only; breach, greedy-breach (Algorithm 6.1): lower only; least-change: both")
      ->capture_default_str();
  command
      .add_option("--measure", arguments.measure,
                  "what is to be small: total or max displacement, count of vertices moved, or volume")
      ->capture_default_str();
  command.add_option("--max-breach-length", arguments.max_breach_length, "no pit is breached along a longer way [m]")
      ->type_name("M");
  command.add_option("--max-breach-depth", arguments.max_breach_depth, "no vertex is lowered by more [m]")
      ->type_name("M");
  command
      .add_option("--search", arguments.search,
                  "for breaches: auto (the better of scalable and thorough where the terrain is small), or scalable "
                  "(what `run` does)")
      ->capture_default_str();
  add_choice_of_pits(command, arguments);
  add_outlets(command, arguments);
  add_results(command, arguments);
}

PitOptions pit_options(const FillArguments& arguments) {
  if (arguments.method == "none")
    throw Error(ErrorKind::config,
                "--method: 'none' is not possible (allowed: lift, breach, greedy-breach, least-change)");
  std::vector<ConfigOverride> given;
  for (const ConfigOverride& option : {ConfigOverride{"method", arguments.method, "--method"},
                                       {"measure", arguments.measure, "--measure"},
                                       {"max_breach_length_m", arguments.max_breach_length, "--max-breach-length"},
                                       {"max_breach_depth_m", arguments.max_breach_depth, "--max-breach-depth"},
                                       {"void_edge_m", arguments.void_edge, "--void-edge"},
                                       {"cheapest", arguments.cheapest, "--cheapest"}})
    if (!option.text.empty()) given.push_back(option);
  for (const std::string& condition : arguments.keep) {
    const std::size_t equals = condition.find('=');
    if (equals == std::string::npos || equals == 0)
      throw Error(
          ErrorKind::config,
          fmt::format("--keep: '{}' is not possible (allowed: KEY=VALUE, for example deeper_than_m=3)", condition));
    given.push_back({"keep." + condition.substr(0, equals), condition.substr(equals + 1), "--keep"});
  }
  PitOptions options = read_pit_options(given, std::filesystem::current_path());
  options.voids_drain = arguments.voids_drain;
  if (!arguments.void_edge.empty() && !arguments.voids_drain)
    throw Error(ErrorKind::config, "--void-edge: voids do not drain (give --voids-drain)");
  if (!arguments.pits.empty() && (options.keep.any() || options.cheapest))
    throw Error(ErrorKind::config, fmt::format("--pits: it says which pits to remove, as {} does (give one of the two)",
                                               options.cheapest ? "--cheapest" : "--keep"));
  if (arguments.search != "auto" && arguments.search != "scalable")
    throw Error(ErrorKind::config,
                fmt::format("--search: '{}' is not possible (allowed: auto, scalable)", arguments.search));
  if (!(arguments.cell > 0 && arguments.cell <= 1e6))
    throw Error(ErrorKind::config,
                fmt::format("--cell: {} is not possible (allowed: a length above 0)", arguments.cell));
  if (!(arguments.max_edge >= 0 && arguments.max_edge <= 1e9))
    throw Error(ErrorKind::config, fmt::format("--max-edge: {} is not possible (allowed: a length, or 0 for no limit)",
                                               arguments.max_edge));
  return options;
}

}  // namespace hydrotin::app
