#include "config.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "hydrotin/crs.h"
#include "hydrotin/error.h"
#include "river_measures.h"

namespace hydrotin::app {
namespace {

[[noreturn]] void fail(const std::string& place, const std::string& what) {
  throw Error(ErrorKind::config, place + ": " + what);
}

std::optional<double> number_in(std::string_view text) {
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// A value with its path, read as what the schema says it is.
class Reader {
 public:
  Reader(const ConfigValue* value, std::string name) : value_(value), name_(std::move(name)) {}

  [[nodiscard]] bool is_given() const { return value_ != nullptr && value_->kind != ConfigValue::Kind::absent; }
  [[nodiscard]] bool is(ConfigValue::Kind kind) const { return is_given() && value_->kind == kind; }
  [[nodiscard]] const std::string& place() const { return value_->place; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[noreturn]] void refuse(const std::string& allowed) const {
    const std::string shown = value_->kind == ConfigValue::Kind::scalar ? "'" + value_->text + "'"
                              : value_->kind == ConfigValue::Kind::list ? "a list"
                                                                        : "a section";
    fail(value_->place, name_ + ": " + shown + " is not possible (allowed: " + allowed + ")");
  }

  /// Checks that the value is a section with no other keys than these.
  void require_keys(const std::vector<std::string>& keys) const {
    if (!is_given()) return;
    std::string allowed;
    for (const auto& key : keys) allowed += (allowed.empty() ? "" : ", ") + key;
    if (value_->kind != ConfigValue::Kind::section) refuse("a section with " + allowed);
    for (std::size_t i = 0; i < value_->entries.size(); ++i)
      if (std::find(keys.begin(), keys.end(), value_->entries[i].first) == keys.end())
        fail(value_->key_places[i], "unknown key '" + value_->entries[i].first + "'" +
                                        (name_.empty() ? " in the config" : " in " + name_) + " (allowed: " + allowed +
                                        ")");
  }

  [[nodiscard]] Reader at(const std::string& key) const {
    const ConfigValue* entry = is_given() ? value_->find(key) : nullptr;
    return {entry, name_.empty() ? key : name_ + "." + key};
  }

  [[nodiscard]] const std::string& text(const std::string& allowed) const {
    if (value_->kind != ConfigValue::Kind::scalar || value_->text.empty()) refuse(allowed);
    return value_->text;
  }

  [[nodiscard]] bool boolean() const {
    if (value_->kind == ConfigValue::Kind::scalar && !value_->is_quoted) {
      if (value_->text == "true") return true;
      if (value_->text == "false") return false;
    }
    refuse("true, false");
  }

  [[nodiscard]] double real(double low, double high, const std::string& allowed) const {
    const auto value =
        value_->kind == ConfigValue::Kind::scalar && !value_->is_quoted ? number_in(value_->text) : std::nullopt;
    if (!value || *value < low || *value > high) refuse(allowed);
    return *value;
  }

  [[nodiscard]] std::uint64_t integer(std::uint64_t low, std::uint64_t high) const {
    const std::string allowed = "an integer from " + std::to_string(low) + " to " + std::to_string(high);
    const double value = real(static_cast<double>(low), static_cast<double>(high), allowed);
    if (value != std::floor(value)) refuse(allowed);
    return static_cast<std::uint64_t>(value);
  }

  /// The value's place among `names`.
  [[nodiscard]] std::size_t choice(const std::vector<std::string>& names) const {
    const auto found =
        value_->kind == ConfigValue::Kind::scalar ? std::find(names.begin(), names.end(), value_->text) : names.end();
    if (found == names.end()) {
      std::string allowed;
      for (const auto& one : names) allowed += (allowed.empty() ? "" : ", ") + one;
      refuse(allowed);
    }
    return static_cast<std::size_t>(found - names.begin());
  }

  /// The items of a list; a single value is a list of one.
  [[nodiscard]] std::vector<Reader> list(const std::string& allowed) const {
    std::vector<Reader> items;
    if (value_->kind == ConfigValue::Kind::section) refuse(allowed);
    if (value_->kind == ConfigValue::Kind::scalar) return {*this};
    for (const auto& item : value_->items) {
      if (item.kind != ConfigValue::Kind::scalar)
        fail(item.place, name_ + ": every item must be a plain value (allowed: " + allowed + ")");
      items.emplace_back(&item, name_);
    }
    return items;
  }

 private:
  const ConfigValue* value_;
  std::string name_;
};

std::string resolved(const std::filesystem::path& folder, const std::string& path) {
  if (path.starts_with("/vsi")) return path;
  return (folder / path).lexically_normal().string();  // an absolute path stays what it is
}

// Rasters whose cells are points.
void read_dem_input(const Reader& input, const std::filesystem::path& folder, InputOptions& options) {
  const std::string patterns = "a list of rasters or patterns";
  if (const Reader dem = input.at("dem"); dem.is_given()) {
    for (const Reader& item : dem.list(patterns)) options.dem.push_back(resolved(folder, item.text(patterns)));
    if (options.dem.empty()) dem.refuse(patterns + " that is not empty");
  }
  if (const Reader band = input.at("dem_band"); band.is_given())
    options.dem_band = static_cast<int>(band.integer(1, 100000));
  if (const Reader quantum = input.at("dem_quantum_m"); quantum.is_given())
    options.dem_quantum_m = quantum.real(1e-6, 1e3, "a length from 0.000001 to 1000");
  if (const Reader nodata = input.at("dem_nodata"); nodata.is_given())
    options.dem_nodata =
        nodata.real(-std::numeric_limits<double>::max(), std::numeric_limits<double>::max(), "a number");
}

void read_input(const Reader& input, const std::filesystem::path& folder, const std::string& file,
                InputOptions& options) {
  input.require_keys({"points", "dem", "dem_band", "dem_quantum_m", "dem_nodata", "classes", "rivers", "lakes", "crs",
                      "withheld", "synthetic"});
  const Reader points = input.at("points");
  const std::string patterns = "a list of LAS or LAZ files or patterns";
  read_dem_input(input, folder, options);
  if (!points.is_given() && options.dem.empty())
    fail(input.is_given() ? input.place() : file,
         "input.points is missing (give " + patterns + ", or rasters as input.dem)");
  if (points.is_given()) {
    for (const Reader& item : points.list(patterns)) options.points.push_back(resolved(folder, item.text(patterns)));
    if (options.points.empty() && options.dem.empty()) points.refuse(patterns + " that is not empty");
  }

  if (const Reader classes = input.at("classes"); classes.is_given()) {
    options.classes.clear();
    const bool all = classes.is(ConfigValue::Kind::scalar) && classes.text("all") == "all";
    const std::string allowed = "a list of class numbers from 0 to 255, or all";
    if (!all) {
      for (const Reader& item : classes.list(allowed)) {
        const double value = item.real(0, 255, allowed);
        if (value != std::floor(value)) item.refuse(allowed);
        options.classes.push_back(static_cast<std::uint8_t>(value));
      }
      if (options.classes.empty()) classes.refuse(allowed);
      std::sort(options.classes.begin(), options.classes.end());
      options.classes.erase(std::unique(options.classes.begin(), options.classes.end()), options.classes.end());
    }
  }
  if (const Reader crs = input.at("crs"); crs.is_given()) {
    options.crs = crs.text("EPSG:n, WKT or none");
    if (options.crs != "none") (void)parse_crs(options.crs, crs.place() + ": " + crs.name());
  }
  if (const Reader withheld = input.at("withheld"); withheld.is_given()) options.withheld = withheld.boolean();
  if (const Reader synthetic = input.at("synthetic"); synthetic.is_given()) options.synthetic = synthetic.boolean();
}

void read_dem(const Reader& dem, DemOptions& options) {
  if (!dem.is_given()) return;
  if (dem.is(ConfigValue::Kind::scalar)) {
    options.enabled = dem.boolean();
    return;
  }
  dem.require_keys({"cell_m", "max_edge_m", "format", "hillshade", "change"});
  if (const Reader cell = dem.at("cell_m"); cell.is_given())
    options.cell_m = cell.real(1e-3, 1e6, "a length in metres from 0.001 to 1000000");
  if (const Reader edge = dem.at("max_edge_m"); edge.is_given())
    options.max_edge_m = edge.real(0, 1e9, "a length in metres, or 0 for no limit");
  if (const Reader format = dem.at("format"); format.is_given()) options.cog = format.choice({"COG", "tiles"}) == 0;
  if (const Reader hillshade = dem.at("hillshade"); hillshade.is_given()) options.hillshade = hillshade.boolean();
  if (const Reader change = dem.at("change"); change.is_given()) options.change = change.boolean();
}

void read_output(const Reader& output, const std::filesystem::path& folder, OutputOptions& options) {
  output.require_keys({"dir", "dem", "mesh", "keep"});
  options.dir = resolved(folder, "out");
  if (const Reader dir = output.at("dir"); dir.is_given()) options.dir = resolved(folder, dir.text("a folder"));
  read_dem(output.at("dem"), options.dem);
  if (const Reader mesh = output.at("mesh"); mesh.is_given()) {
    options.mesh_ply = false;
    for (const Reader& item : mesh.list("ply")) options.mesh_ply = item.choice({"ply"}) == 0;
  }
  if (const Reader keep = output.at("keep"); keep.is_given()) {
    constexpr KeepWork kValues[] = {KeepWork::never, KeepWork::on_failure, KeepWork::always};
    options.keep = kValues[keep.choice({"never", "on-failure", "always"})];
  }
}

// The objectives that some run can have.
std::string possible_objectives() {
  std::string out;
  TriangulationOptions options;
  options.reference = {"any"};
  for (std::size_t i = 0; i < kObjectiveNames.size(); ++i) {
    options.objectives = {static_cast<Objective>(i)};
    if (!objection_to_run(options)) out += (out.empty() ? "" : ", ") + std::string(kObjectiveNames[i]);
  }
  return out + "; or a list of them by priority";
}

void read_budget(const Reader& budget, PolygonBudget& options) {
  budget.require_keys({"triangles", "ways", "columns", "branches"});
  for (const auto& [key, most] : {std::pair{"triangles", &options.max_triangles},
                                  {"ways", &options.max_ways},
                                  {"columns", &options.max_program},
                                  {"branches", &options.max_branches}})
    if (const Reader given = budget.at(key); given.is_given())
      *most = static_cast<std::uint32_t>(given.integer(1, std::uint64_t{1} << 31));
}

void read_thin(const Reader& thin, ThinOptions& options) {
  thin.require_keys({"vertical_error_m", "cell_m", "prune"});
  if (const Reader limit = thin.at("vertical_error_m"); limit.is_given())
    options.vertical_error_m = limit.real(0, 1e6, "a height in metres from 0 to 1000000");
  if (const Reader cell = thin.at("cell_m"); cell.is_given())
    options.cell_m = cell.real(1e-3, 1e6, "a length in metres from 0.001 to 1000000");
  if (const Reader prune = thin.at("prune"); prune.is_given()) options.prune = prune.boolean();
  for (const char* key : {"cell_m", "prune"})
    if (const Reader given = thin.at(key); given.is_given() && !options.vertical_error_m)
      fail(given.place(), given.name() + ": nothing is thinned (give thin.vertical_error_m)");
}

void read_triangulation(const Reader& triangulation, const std::filesystem::path& folder, bool thins,
                        TriangulationOptions& options) {
  triangulation.require_keys({"order", "objective", "reference", "max_error_m", "budget"});
  read_budget(triangulation.at("budget"), options.budget);
  if (const Reader order = triangulation.at("order"); order.is_given())
    options.order = static_cast<int>(order.integer(0, 6));
  const Reader reference = triangulation.at("reference");
  if (reference.is_given()) {
    const std::string patterns = "a list of LAS or LAZ files or patterns, or removed";
    for (const Reader& item : reference.list(patterns)) {
      if (item.text(patterns) != "removed") {
        options.reference.push_back(resolved(folder, item.text(patterns)));
        continue;
      }
      if (!thins) fail(item.place(), item.name() + ": nothing is removed (give thin.vertical_error_m)");
      options.removed_reference = true;
    }
  } else {
    options.removed_reference = thins;
  }
  if (const Reader limit = triangulation.at("max_error_m"); limit.is_given()) {
    options.max_error_m = limit.real(0, 1e6, "a height in metres from 0 to 1000000");
    if (!options.has_reference())
      fail(limit.place(), limit.name() + ": errors are those of reference points (give triangulation.reference)");
  }
  if (const Reader objective = triangulation.at("objective"); objective.is_given()) {
    const std::string allowed = possible_objectives();
    options.objectives.clear();
    for (const Reader& item : objective.list(allowed)) {
      const auto known = objective_named(item.text(allowed));
      if (!known) item.refuse(allowed);
      options.objectives.push_back(*known);
    }
    if (const auto objection = objection_to_run(options)) fail(objective.place(), objective.name() + ": " + *objection);
  }
}

// What the rows of the rivers ask.
void read_constraints(const Reader& rivers, RiverConstraints& constraints) {
  const auto text = [&](const std::string& key, const std::string& other, const std::string& allowed) {
    const Reader given = rivers.at(key);
    return given.is_given() ? given.text(allowed) : other;
  };
  const auto place = [&](const std::string& key) {
    const Reader given = rivers.at(key);
    return given.is_given() ? given.place() + ": " + given.name() : given.name();
  };
  set_decline(place("decline"), text("decline", "10%", "10%, 1deg or rise over run"), constraints);
  set_variant(place("variant"), text("variant", "VFRS", "VF, VFR, VFRS"), constraints);
  constraints.edge_slope_change = parse_slope_limit(
      place("max_edge_slope_change"), text("max_edge_slope_change", "50%", "50% of the old slope, or 0.5"));
  set_contiguity(place("contiguous"), text("contiguous", "", "a number of imaginary points, or exact"), constraints);
  if (const Reader directions = rivers.at("triangle_directions"); directions.is_given())
    set_directions(place("triangle_directions"), static_cast<std::uint32_t>(directions.integer(0, 180)), constraints);
  constraints.triangle_slope_change = parse_slope_limit(
      place("max_triangle_slope_change"), text("max_triangle_slope_change", "50%", "50% of the old slope, or 0.5"));
  for (const auto& [key, flag] :
       {std::pair{"flow", &constraints.flow}, {"valley", &constraints.valley}, {"river_only", &constraints.river_only}})
    if (const Reader given = rivers.at(key); given.is_given()) *flag = given.boolean();
  if (const Reader slope = rivers.at("side_slope"); slope.is_given())
    constraints.side_slope = slope.real(0, 1e6, "rise over run, not negative");
  if (const Reader most = rivers.at("max_change_m"); most.is_given())
    constraints.max_change = most.real(1e-9, 1e6, "a height in metres above 0");
}

// How the program is solved, and what it must leave as it is.
void read_method(const Reader& rivers, bool has_lakes, const std::filesystem::path& folder, RiverOptions& options) {
  if (const Reader limit = rivers.at("time_limit"); limit.is_given())
    options.time_limit = limit.real(1e-9, 1e9, "seconds, above 0");
  const Reader edges = rivers.at("preserve_edges"), kind = rivers.at("preserve");
  if (edges.is_given()) options.preserve_edges = resolved(folder, edges.text("a file of lines"));
  if (kind.is_given()) {
    if (!edges.is_given()) fail(kind.place(), kind.name() + ": there are no edges (give rivers.preserve_edges)");
    const std::size_t chosen = kind.choice({"drainage", "curvature", "both"});
    options.preserve_drainage = chosen != 1;
    options.preserve_curvature = chosen != 0;
  }
  const Reader method = rivers.at("method");
  if (!method.is_given() || method.choice({"lp", "dp"}) == 0) return;
  options.method = RiverMethod::dp;
  const auto clash = [&](const std::string& key) {
    fail(method.place(), method.name() + ": dp moves river vertices for flow, valley, decline and side slope only, " +
                             "and ends by itself, so not with " + key + " (leave that out, or give lp)");
  };
  if (has_lakes) clash("input.lakes");
  for (const char* key : {"contiguous", "max_change_m", "time_limit", "preserve_edges"})
    if (rivers.at(key).is_given()) clash(std::string("rivers.") + key);
  if (!options.constraints.directions.empty()) clash("rivers.triangle_directions");
  if (!options.constraints.flow) clash("rivers.flow: false");
  if (!options.constraints.valley) clash("rivers.valley: false");
}

void read_rivers(const Reader& input, const Reader& rivers, const std::filesystem::path& folder,
                 RiverOptions& options) {
  rivers.require_keys({"variant",
                       "decline",
                       "max_edge_slope_change",
                       "max_change_m",
                       "side_slope",
                       "contiguous",
                       "triangle_directions",
                       "max_triangle_slope_change",
                       "flow",
                       "valley",
                       "river_only",
                       "match",
                       "use_z",
                       "direction",
                       "direction_field",
                       "reversed_values",
                       "name_field",
                       "lake_level_field",
                       "crs",
                       "points_out",
                       "method",
                       "time_limit",
                       "preserve_edges",
                       "preserve"});
  const Reader lines = input.at("rivers"), lakes = input.at("lakes");
  if (lines.is_given()) options.lines = resolved(folder, lines.text("a file of lines"));
  if (lakes.is_given()) options.lakes = resolved(folder, lakes.text("a file of polygons"));
  if (lakes.is_given() && !lines.is_given())
    fail(lakes.place(), lakes.name() + ": lakes are those that rivers run through (give input.rivers)");
  if (rivers.is_given() && !lines.is_given())
    fail(rivers.place(), "rivers: there are none (give their lines as input.rivers)");
  read_constraints(rivers, options.constraints);
  read_method(rivers, lakes.is_given(), folder, options);
  if (const Reader match = rivers.at("match"); match.is_given())
    options.matching.insert = match.choice({"snap", "insert"}) == 1;
  if (const Reader z = rivers.at("use_z"); z.is_given()) {
    options.use_z = z.boolean();
    if (options.use_z && !options.matching.insert)
      fail(z.place(), z.name() + ": snapped rivers keep the heights of the terrain (give rivers.match: insert)");
  }
  if (const Reader direction = rivers.at("direction"); direction.is_given()) {
    constexpr LineDirection kValues[] = {LineDirection::automatic, LineDirection::digitised, LineDirection::reversed,
                                         LineDirection::attribute};
    options.matching.direction = kValues[direction.choice({"auto", "digitised", "reversed", "attribute"})];
  }
  const Reader field = rivers.at("direction_field");
  if (field.is_given()) options.direction_field = field.text("an attribute of the lines");
  if ((options.matching.direction == LineDirection::attribute) != field.is_given())
    fail((field.is_given() ? field : rivers).place(),
         "rivers.direction: attribute and rivers.direction_field belong together (give both or none)");
  if (const Reader values = rivers.at("reversed_values"); values.is_given()) {
    const std::string allowed = "a list of values of rivers.direction_field";
    if (!field.is_given()) fail(values.place(), values.name() + ": give rivers.direction_field, too");
    options.reversed_values.clear();
    for (const Reader& item : values.list(allowed)) options.reversed_values.push_back(item.text(allowed));
  }
  if (const Reader name = rivers.at("name_field"); name.is_given())
    options.name_field = name.text("an attribute of the lines");
  if (const Reader level = rivers.at("lake_level_field"); level.is_given()) {
    options.lake_level_field = level.text("an attribute of the lakes");
    if (!lakes.is_given()) fail(level.place(), level.name() + ": there are no lakes (give input.lakes)");
  }
  if (const Reader points = rivers.at("points_out"); points.is_given()) {
    constexpr PointsFile kValues[] = {PointsFile::none, PointsFile::las, PointsFile::gpkg};
    options.points_out = kValues[points.choice({"none", "las", "gpkg"})];
  }
  if (const Reader crs = rivers.at("crs"); crs.is_given()) {
    options.crs = crs.text("EPSG:n or WKT");
    (void)parse_crs(options.crs, crs.place() + ": " + crs.name());
  }
}

void read_keep(const Reader& keep, const std::filesystem::path& folder, KeepPits& options) {
  keep.require_keys({"deeper_than_m", "larger_than_m2", "volume_above_m3", "inside", "ids", "combine"});
  const auto read_limit = [&](const std::string& key, std::optional<double>& limit) {
    if (const Reader value = keep.at(key); value.is_given()) limit = value.real(0, 1e15, "a number from 0 on");
  };
  read_limit("deeper_than_m", options.deeper_than_m);
  read_limit("larger_than_m2", options.larger_than_m2);
  read_limit("volume_above_m3", options.volume_above_m3);
  if (const Reader inside = keep.at("inside"); inside.is_given())
    options.inside = resolved(folder, inside.text("a file of polygons"));
  if (const Reader ids = keep.at("ids"); ids.is_given()) {
    const std::string allowed = "a list of ids from the layer pits";
    for (const Reader& item : ids.list(allowed)) {
      const double id = item.real(0, 1e15, allowed);
      if (id != std::floor(id)) item.refuse(allowed);
      options.ids.push_back(static_cast<std::uint64_t>(id));
    }
  }
  if (const Reader combine = keep.at("combine"); combine.is_given())
    options.all_conditions = combine.choice({"or", "and"}) == 1;
}

void read_pits(const Reader& pits, const std::filesystem::path& folder, PitOptions& options) {
  pits.require_keys({"method", "measure", "max_breach_length_m", "max_breach_depth_m", "largest_lake", "largest_group",
                     "keep", "cheapest", "outlets", "voids_drain", "void_edge_m"});
  if (const Reader method = pits.at("method"); method.is_given())
    options.method = static_cast<PitMethod>(method.choice({"none", "lift", "breach", "greedy-breach", "least-change"}));
  if (const Reader measure = pits.at("measure"); measure.is_given())
    options.measure = static_cast<ChangeMeasure>(measure.choice({"total", "max", "count", "volume"}));
  if (const Reader length = pits.at("max_breach_length_m"); length.is_given())
    options.max_breach_length_m = length.real(0, 1e9, "a length in metres");
  if (const Reader depth = pits.at("max_breach_depth_m"); depth.is_given())
    options.max_breach_depth_m = depth.real(0, 1e6, "a height in metres");
  if (const Reader lake = pits.at("largest_lake"); lake.is_given())
    options.largest_lake = lake.integer(1, 1'000'000'000'000);
  if (const Reader group = pits.at("largest_group"); group.is_given())
    options.largest_group = group.integer(1, 1'000'000'000'000);
  read_keep(pits.at("keep"), folder, options.keep);
  if (const Reader cheapest = pits.at("cheapest"); cheapest.is_given()) {
    options.cheapest = cheapest.integer(0, 1'000'000'000'000);
    if (options.keep.any())
      fail(cheapest.place(), cheapest.name() + ": it says which pits to keep, as pits.keep does (give one of the two)");
  }
  if (const Reader outlets = pits.at("outlets"); outlets.is_given()) {
    const std::string& text = outlets.text("hull, lowest, or a file of points, lines or polygons");
    options.outlets = text == "hull"     ? OutletPolicy::hull
                      : text == "lowest" ? OutletPolicy::lowest
                                         : OutletPolicy::layer;
    if (options.outlets == OutletPolicy::layer) options.outlet_layer = resolved(folder, text);
    if (options.outlets == OutletPolicy::layer && !options.outlet_layer.starts_with("/vsi") &&
        !std::filesystem::exists(options.outlet_layer))
      outlets.refuse("hull, lowest, or a file of points, lines or polygons");
  }
  if (const Reader voids = pits.at("voids_drain"); voids.is_given()) options.voids_drain = voids.boolean();
  if (const Reader edge = pits.at("void_edge_m"); edge.is_given())
    options.void_edge_m = edge.real(1e-6, 1e9, "a length in metres above 0");
}

void read_run(const Reader& run, const std::filesystem::path& folder, ExecutionOptions& options) {
  run.require_keys({"workers", "memory", "scratch"});
  if (const Reader workers = run.at("workers"); workers.is_given()) {
    const bool automatic = workers.is(ConfigValue::Kind::scalar) && workers.text("auto") == "auto";
    const std::string allowed = "auto, or an integer from 1 to 1024";
    const double value = automatic ? 0 : workers.real(1, 1024, allowed);
    if (value != std::floor(value)) workers.refuse(allowed);
    options.workers = static_cast<int>(value);
  }
  if (const Reader memory = run.at("memory"); memory.is_given()) {
    const std::string allowed = "a size of at least 64MiB, for example 4GiB or 500MB";
    const auto bytes = parse_byte_count(memory.text(allowed));
    if (!bytes || *bytes < std::uint64_t{64} << 20) memory.refuse(allowed);
    options.memory_bytes = *bytes;
  }
  if (const Reader scratch = run.at("scratch"); scratch.is_given())
    options.scratch = resolved(folder, scratch.text("a folder"));
}

}  // namespace

std::optional<std::uint64_t> parse_byte_count(std::string_view text) {
  static constexpr std::pair<std::string_view, double> kUnits[] = {{"", 1},
                                                                   {"B", 1},
                                                                   {"kB", 1e3},
                                                                   {"KB", 1e3},
                                                                   {"MB", 1e6},
                                                                   {"GB", 1e9},
                                                                   {"TB", 1e12},
                                                                   {"KiB", 1024},
                                                                   {"MiB", 1048576.0},
                                                                   {"GiB", 1073741824.0},
                                                                   {"TiB", 1099511627776.0}};
  const std::size_t unit = std::min(text.find_first_not_of("0123456789.eE"), text.size());
  const auto number = number_in(text.substr(0, unit));
  std::string_view name = text.substr(unit);
  while (!name.empty() && name.front() == ' ') name.remove_prefix(1);
  for (const auto& [known, factor] : kUnits)
    if (number && name == known && *number * factor < 9e18) return static_cast<std::uint64_t>(*number * factor);
  return std::nullopt;
}

PipelineOptions read_config(const std::filesystem::path& path, std::span<const ConfigOverride> overrides) {
  ConfigValue tree = read_config_tree(path);
  for (const auto& override : overrides) apply_override(tree, override);
  const Reader root(&tree, "");
  root.require_keys({"input", "output", "tiles", "thin", "triangulation", "rivers", "pits", "run"});

  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  PipelineOptions options;
  read_input(root.at("input"), folder, path.string(), options.input);
  read_output(root.at("output"), folder, options.output);
  const Reader tiles = root.at("tiles");
  tiles.require_keys({"target_points"});
  if (const Reader target = tiles.at("target_points"); target.is_given())
    options.tiles.target_points = target.integer(1000, 1'000'000'000);
  read_thin(root.at("thin"), options.thin);
  read_triangulation(root.at("triangulation"), folder, options.thin.vertical_error_m.has_value(),
                     options.triangulation);
  read_rivers(root.at("input"), root.at("rivers"), folder, options.rivers);
  read_pits(root.at("pits"), folder, options.pits);
  read_run(root.at("run"), folder, options.run);
  return options;
}

PitOptions read_pit_options(std::span<const ConfigOverride> given, const std::filesystem::path& folder) {
  ConfigValue tree{.kind = ConfigValue::Kind::section};
  for (const auto& value : given) apply_override(tree, value);
  PitOptions options;
  read_pits(Reader(&tree, ""), folder, options);
  return options;
}

}  // namespace hydrotin::app
