#include "embed_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "hydrotin/error.h"
#include "river_measures.h"

namespace hydrotin::app {
namespace {

void check_names(const EmbedArguments& arguments) {
  const auto check = [](const std::string& option, const std::string& text, std::initializer_list<const char*> known) {
    for (const char* name : known)
      if (text == name) return;
    refuse(option, text, fmt::format("allowed: {}", fmt::join(known, ", ")));
  };
  check("--match", arguments.match, {"snap", "insert"});
  check("--direction", arguments.direction, {"auto", "digitised", "reversed", "attribute"});
  check("--preserve", arguments.preserve, {"drainage", "curvature", "both"});
  if (!arguments.fill.empty()) check("--fill", arguments.fill, {"lift", "least-change"});
  if ((arguments.direction == "attribute") == arguments.direction_field.empty())
    throw Error(ErrorKind::config, "--direction: attribute and --direction-field NAME belong together");
  const auto needs_lines = [&](const char* option, bool is_given) {
    if (is_given && arguments.rivers.empty())
      throw Error(ErrorKind::config, fmt::format("{}: is about lines (give --rivers LINES)", option));
  };
  needs_lines("--match", arguments.match != "snap");
  needs_lines("--direction", arguments.direction != "auto");
  needs_lines("--river-name", !arguments.river_name.empty());
  needs_lines("--use-z", arguments.use_z);
  if (arguments.use_z && arguments.match != "insert")
    throw Error(ErrorKind::config, "--use-z: snapped rivers keep the heights of the TIN (use --match insert)");
  const std::string& points = arguments.points_out;
  if (!points.empty() && !points.ends_with(".las") && !points.ends_with(".gpkg"))
    refuse("--points-out", points, "let the name end in .las or .gpkg");
  if (!arguments.lake_level.empty() && arguments.lakes.empty())
    throw Error(ErrorKind::config, "--lake-level: is about lakes (give --lakes FILE)");
}

void check_method(const EmbedArguments& arguments, const RiverConstraints& constraints) {
  if (arguments.method == "lp") return;
  if (arguments.method != "dp") refuse("--method", arguments.method, "allowed: lp, dp");
  const auto clash = [](const std::string& option) {
    throw Error(ErrorKind::config, option +
                                       ": --method dp moves river vertices for flow, valley, decline and side "
                                       "slope only, and ends by itself (use --method lp)");
  };
  if (constraints.contiguity != Contiguity::none) clash("--contiguous");
  if (!arguments.lakes.empty()) clash("--lakes");
  if (arguments.max_change > 0) clash("--max-change");
  if (arguments.no_flow) clash("--no-flow");
  if (arguments.no_valley) clash("--no-valley");
  if (arguments.triangle_directions > 0) clash("--triangle-directions");
  if (!arguments.preserve_edges.empty()) clash("--preserve-edges");
  if (arguments.time_limit > 0) clash("--time-limit");
}

}  // namespace

EmbeddingOptions embedding_options(const EmbedArguments& arguments) {
  if (arguments.river_edges.empty() == arguments.rivers.empty())
    throw Error(ErrorKind::config, "embed: say where the rivers are: either --river-edges EDGES or --rivers LINES");
  EmbeddingOptions options;
  RiverConstraints& constraints = options.constraints;
  set_decline("--decline", arguments.decline, constraints);
  set_variant("--variant", arguments.variant, constraints);
  constraints.edge_slope_change = parse_slope_limit("--slope-limit", arguments.slope_limit);
  set_contiguity("--contiguous", arguments.contiguous, constraints);
  const auto check = [](const char* option, double value) {
    if (!std::isfinite(value) || value < 0) refuse(option, fmt::format("{}", value), "a number, not negative");
  };
  check("--side-slope", arguments.side_slope);
  check("--max-change", arguments.max_change);
  check("--quantum", arguments.quantum);
  check("--time-limit", arguments.time_limit);
  constraints.flow = !arguments.no_flow;
  constraints.valley = !arguments.no_valley;
  constraints.side_slope = arguments.side_slope;
  constraints.river_only = arguments.river_only;
  constraints.max_change = arguments.max_change;
  options.quantum = arguments.quantum;
  set_directions("--triangle-directions", arguments.triangle_directions, constraints);
  constraints.triangle_slope_change = parse_slope_limit("--triangle-slope-limit", arguments.triangle_slope_limit);
  check_names(arguments);
  check_method(arguments, constraints);
  return options;
}

void add_embed_options(CLI::App& command, EmbedArguments& arguments) {
  command.add_option("tin", arguments.tin, "PLY or OBJ")->required()->type_name("TIN");
  command.add_option("--river-edges", arguments.river_edges, "CSV: a header, then from, to: downstream")
      ->type_name("EDGES");
  command.add_option("--rivers", arguments.rivers, "river lines in any vector format and CRS")->type_name("LINES.gpkg");
  command.add_option("--match", arguments.match, "snap lines to edges of the TIN, or insert them as edges")
      ->capture_default_str();
  command
      .add_option("--direction", arguments.direction,
                  "of lines: auto (each network votes against the terrain), digitised, reversed, attribute")
      ->capture_default_str();
  command.add_option("--direction-field", arguments.direction_field, "attribute that says how a line was drawn")
      ->type_name("NAME");
  command.add_option("--reversed-values", arguments.reversed_values, "its values for lines drawn upstream")
      ->delimiter(',')
      ->type_name("V,V,...");
  command.add_option("--rivers-crs", arguments.rivers_crs, "of lines and lakes whose file names none")
      ->type_name("EPSG:n");
  command.add_option("--crs", arguments.crs, "of the TIN, in place of its own")->type_name("EPSG:n");
  command.add_option("--river-name", arguments.river_name, "attribute that names rivers: tables and profiles by name")
      ->type_name("NAME");
  command.add_flag("--use-z", arguments.use_z, "inserted vertices take the z of the lines");
  command
      .add_option("--outlets", arguments.outlets,
                  "where rivers may end: hull, lowest, or a CSV file of vertices; lakes always; other mouths get an "
                  "outlet chain (default: hull with --rivers or --fill)")
      ->type_name("hull|lowest|FILE");
  command.add_option("--fill", arguments.fill, "then remove all pits: lift, or least-change")
      ->type_name("lift|least-change");
  command.add_option("--variant", arguments.variant, "VF, VFR (decline) or VFRS (and limited change of slopes)")
      ->capture_default_str();
  command.add_option("--decline", arguments.decline, "least: 10% of the river's average slope, 1deg, or rise over run")
      ->capture_default_str();
  command.add_option("--side-slope", arguments.side_slope, "least slope of the sides towards the river, rise over run");
  command.add_option("--slope-limit", arguments.slope_limit, "how much the slope of an edge may change")
      ->capture_default_str();
  command.add_option("--contiguous", arguments.contiguous, "no leaks: by N imaginary points a triangle, or exact")
      ->type_name("N|exact");
  command.add_flag("--no-flow", arguments.no_flow, "directions of flow need not hold");
  command.add_flag("--no-valley", arguments.no_valley, "river edges need not be valleys");
  command
      .add_option("--triangle-directions", arguments.triangle_directions,
                  "limit the change of the slope of triangles in so many directions")
      ->type_name("N");
  command.add_option("--triangle-slope-limit", arguments.triangle_slope_limit, "and how much it may change")
      ->capture_default_str();
  command.add_option("--preserve-edges", arguments.preserve_edges, "CSV of edges whose type must not change")
      ->type_name("EDGES");
  command
      .add_option("--preserve", arguments.preserve,
                  "drainage (ridge, valley, transfluent), curvature (convex, reflex), or both")
      ->capture_default_str();
  command.add_flag("--river-only", arguments.river_only, "only river vertices may move");
  command.add_option("--lakes", arguments.lakes, "polygons that become level")->type_name("FILE");
  command.add_option("--lake-level", arguments.lake_level, "attribute with the level of a lake")->type_name("NAME");
  command.add_option("--max-change", arguments.max_change, "of each vertex")->type_name("M");
  command.add_option("--quantum", arguments.quantum, "heights that move become multiples of it")->type_name("M");
  command.add_option("--time-limit", arguments.time_limit, "end with what there is, and the bound")->type_name("S");
  command.add_option("--workers", arguments.workers, "threads; 0: all cores")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber);
  command.add_option("--method", arguments.method, "lp, or dp: river vertices only, exact and strongly polynomial")
      ->capture_default_str();
  command.add_option("--out", arguments.out, "write the TIN with its rivers")->type_name("TIN.ply");
  command.add_option("--layers", arguments.layers, "write river edges, moved vertices, limits, mouths as layers")
      ->type_name("FILE.gpkg");
  command.add_option("--profiles", arguments.profiles, "write longitudinal profiles as SVG into this folder")
      ->type_name("DIR");
  command.add_option("--points-out", arguments.points_out, "write the river vertices as points")
      ->type_name("FILE.las|FILE.gpkg");
  command.add_flag("--json", arguments.json, "print JSON");
}

}  // namespace hydrotin::app
