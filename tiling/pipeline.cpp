#include "hydrotin/pipeline.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "embedded_rivers.h"
#include "report.h"
#include "river_input.h"
#include "river_need.h"
#include "schedule.h"
#include "store.h"

namespace hydrotin {
namespace {

namespace fs = std::filesystem;

// Impossible values of options, whoever filled them in.
void check(const PipelineOptions& options) {
  const auto fail = [](const std::string& text) { throw Error(ErrorKind::config, text); };
  if (options.output.dir.empty()) fail("output.dir: no folder is named; say where the results shall go");
  if (options.triangulation.order < 0 || options.triangulation.order > 6)
    fail("triangulation.order: " + std::to_string(options.triangulation.order) + " is not possible; give 0 to 6");
  if (const auto objection = objection_to_run(options.triangulation)) fail("triangulation.objective: " + *objection);
  if (const auto limit = options.thin.vertical_error_m; limit && !(*limit >= 0))
    fail("thin.vertical_error_m: give a length from 0 on");
  if (const auto cell = options.thin.cell_m; cell && !(*cell > 0))
    fail("thin.cell_m: a cell must have a positive size");
  if (const auto limit = options.triangulation.max_error_m) {
    if (!(*limit >= 0)) fail("triangulation.max_error_m: give a length from 0 on");
    if (!options.triangulation.has_reference())
      fail("triangulation.max_error_m: errors are those of reference points; give triangulation.reference");
  }
  const PitOptions& pits = options.pits;
  if (pits.outlets == OutletPolicy::layer && pits.outlet_layer.empty())
    fail("pits.outlets: no layer is named; give a file of points, lines or polygons");
  if (pits.voids_drain && !(pits.void_edge_m > 0)) fail("pits.void_edge_m: give a length above 0");
  if (pits.max_breach_length_m && !(*pits.max_breach_length_m >= 0))
    fail("pits.max_breach_length_m: give a length from 0 on");
  if (pits.max_breach_depth_m && !(*pits.max_breach_depth_m >= 0))
    fail("pits.max_breach_depth_m: give a height from 0 on");
  if (pits.cheapest && pits.keep.any())
    fail("pits.cheapest: it says which pits to keep, as pits.keep does; give one of the two");
  if (options.input.dem_band < 1) fail("input.dem_band: bands count from 1");
  if (!(options.input.dem_quantum_m >= 1e-6 && options.input.dem_quantum_m <= 1e3))
    fail("input.dem_quantum_m: give a length from 0.000001 to 1000");
  if (options.triangulation.removed_reference && !options.thin.vertical_error_m)
    fail(
        "triangulation.reference: no point is removed that could be one; set thin.vertical_error_m, or leave out "
        "'removed'");
  if (options.tiles.target_points < 1000)
    fail("tiles.target_points: " + std::to_string(options.tiles.target_points) + " is too few; give 1,000 or more");
  if (!(options.output.dem.cell_m > 0)) fail("output.dem.cell_m: a cell must have a positive size");
  if (!(options.output.dem.max_edge_m >= 0)) fail("output.dem.max_edge_m: give a length, or 0 for no limit");
}

// What thinning implies: the points removed are reference points unless others are named, and its limit is theirs.
PipelineOptions settled(PipelineOptions options) {
  TriangulationOptions& triangulation = options.triangulation;
  if (!options.thin.vertical_error_m) return options;
  if (!triangulation.has_reference()) triangulation.removed_reference = true;
  if (triangulation.removed_reference && !triangulation.max_error_m)
    triangulation.max_error_m = options.thin.vertical_error_m;
  return options;
}

RunContext plan_context(const PipelineOptions& given) {
  const PipelineOptions options = settled(given);
  check(options);
  RunContext context{options, Layout(options), make_plan(options), {}, {}};
  context.places = load_pit_places(options.pits, context.plan);
  context.river_input = load_river_input(options.rivers, context.plan);
  return context;
}

// The plan that a job array agreed on, and the outline if it is there.
RunContext stored_context(const PipelineOptions& given) {
  const PipelineOptions options = settled(given);
  check(options);
  RunContext context{options, Layout(options), {}, {}, {}};
  context.plan = load_plan(context.layout.unit(Phase::plan, 0));
  context.places = load_pit_places(options.pits, context.plan);
  context.river_input = load_river_input(options.rivers, context.plan);
  return context;
}

// The largest tile expected must fit: said now, not after all files are decoded.
void require_memory(const RunContext& context) {
  const std::vector<std::uint64_t>& expected = context.plan.expected;
  const auto worst = std::max_element(expected.begin(), expected.end());
  (void)tiles_in_flight(context.options.run, *worst, static_cast<std::uint64_t>(worst - expected.begin()));
}

Outline outline_by(const RunContext& context, Phase phase) {
  Outline out = load_outline(context.layout.unit(phase, 0));
  if (out.count.size() != context.plan.num_tiles())
    throw Error(ErrorKind::storage, context.layout.unit(phase, 0) + ": it does not fit the plan; run the phase " +
                                        std::string(name(phase)) + " again");
  return out;
}

void load_outline_into(RunContext& context) {
  context.outline = outline_by(context, Phase::outline);
}

void load_survey_into(RunContext& context) {
  context.survey = outline_by(context, Phase::survey);
}

// Nothing is left to do if the index and everything it lists are complete and were made from the same.
bool is_finished(const RunContext& context) {
  if (store::recipe_of(context.layout.index()) != context.recipe(Phase::report)) return false;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t)
    if (store::recipe_of(context.layout.terrain(t)) != context.recipe(Phase::finish)) return false;
  return outputs_are_present(context);
}

void remove_scratch(const RunContext& context) {
  if (context.options.output.keep == KeepWork::always) return;
  std::error_code ignored;
  for (std::size_t p = 0; p < kNumPhases; ++p)
    fs::remove_all(fs::path(context.layout.scratch()) / kPhaseNames[p], ignored);
  fs::remove(context.layout.scratch(), ignored);  // only if nothing else lies there
}

}  // namespace

std::optional<std::string> objection_to_run(const TriangulationOptions& options) {
  const Objectives& objectives = options.objectives;
  for (const Objective objective : objectives) {
    std::string quoted("'");
    quoted.append(name(objective)).append("'");
    switch (kind_of(objective)) {
      case ObjectiveKind::degree:
      case ObjectiveKind::quadrilateral_sum:
      case ObjectiveKind::quadrilateral_bottleneck:
        return quoted + " couples neighbouring polygons, which tiles solve apart; use hydrotin triangulate";
      default:
        break;
    }
    if (needs_reference(objective) && !options.has_reference())
      return quoted + " needs reference points; give their files as triangulation.reference";
  }
  if (const auto objection = objection_to(objectives))
    return std::string("'").append(name(objectives)).append("' is not possible: ").append(*objection);
  return std::nullopt;
}

PlanSummary plan_run(const PipelineOptions& options) {
  const RunContext context = plan_context(options);
  const Plan& plan = context.plan;
  PlanSummary out;
  std::uint64_t reference = 0;
  for (const PlanFile& f : plan.files) {
    out.files += !f.is_reference && f.is_first();
    (f.is_reference ? reference : out.points) += f.points;
  }
  out.tiles = plan.num_tiles();
  const auto worst = std::max_element(plan.expected.begin(), plan.expected.end());
  out.worst_tile = static_cast<std::uint64_t>(worst - plan.expected.begin());
  out.worst_tile_points = *worst;
  out.tile_bytes = tile_need_bytes(*worst);
  out.tiles_in_flight = tiles_in_flight(options.run, *worst, out.worst_tile);
  out.memory_bytes = out.tile_bytes * out.tiles_in_flight + (std::uint64_t{64} << 20);
  constexpr double kBytesPerPoint = 130, kSecondsPerPoint = 5e-6;
  const double points = static_cast<double>(out.points) + static_cast<double>(reference) / kReferencePerPoint;
  const RiverNeed rivers = river_need(context);
  out.river_edges = rivers.edges;
  out.river_bytes = rivers.bytes;
  out.memory_bytes = std::max(out.memory_bytes, rivers.bytes + (std::uint64_t{64} << 20));
  out.disk_bytes = static_cast<std::uint64_t>(kBytesPerPoint * points);
  out.seconds = kSecondsPerPoint * points / worker_count(options.run) + rivers.seconds;
  out.crs = plan.crs;
  for (std::size_t p = 0; p < kNumPhases; ++p) out.units.push_back(num_units(context, static_cast<Phase>(p)));
  return out;
}

DatasetSummary run_pipeline(const PipelineOptions& options, const RunControl& control, Progress& progress) {
  RunContext context = plan_context(options);
  if (!control.overwrite && control.until == Phase::report && is_finished(context)) {
    progress.note("everything is complete already; nothing to do");
    return read_report(context.layout.report_json());
  }
  require_memory(context);
  for (std::size_t p = 0; p <= static_cast<std::size_t>(control.until); ++p) {
    const auto phase = static_cast<Phase>(p);
    if (num_units(context, phase) == 0) continue;
    run_units(context, phase, 0, 1, control.overwrite, progress);
    if (phase == Phase::survey) load_survey_into(context);
    if (phase == Phase::outline) {
      load_outline_into(context);
      require_river_memory(context);  // before the triangulation, not after
    }
    if (phase == Phase::unite) context.rivers = load_embedded_rivers(context);
  }
  if (control.until != Phase::report) return {};
  remove_scratch(context);
  return read_report(context.layout.report_json());
}

void run_phase(const PipelineOptions& options, Phase phase, std::uint64_t task, std::uint64_t of, Progress& progress) {
  if (of == 0 || task >= of)
    throw Error(ErrorKind::config,
                "task " + std::to_string(task) + " of " + std::to_string(of) + " does not exist; tasks count from 0");
  RunContext context = phase == Phase::plan ? plan_context(options) : stored_context(options);
  if (phase > Phase::survey && context.thins()) load_survey_into(context);
  if (phase > Phase::outline) load_outline_into(context);
  if (phase > Phase::unite && context.has_rivers()) context.rivers = load_embedded_rivers(context);
  run_units(context, phase, task, of, false, progress);
  if (phase != Phase::outline || task != 0) return;
  load_outline_into(context);
  require_river_memory(context);
}

std::vector<PhaseStatus> pipeline_status(const PipelineOptions& options) {
  RunContext context = plan_context(options);
  std::vector<PhaseStatus> out;
  for (std::size_t p = 0; p < kNumPhases; ++p) {
    PhaseStatus status;
    status.phase = static_cast<Phase>(p);
    status.units = num_units(context, status.phase);
    const std::string recipe = p == 0 ? context.plan.recipe : context.recipe(status.phase);
    for (std::uint64_t unit = 0; unit < status.units; ++unit) {
      const fs::path path = context.layout.unit(status.phase, unit);
      if (store::recipe_of(path.string()) == recipe)
        ++status.done;
      else if (fs::exists(path.string() + ".failed"))
        ++status.failed;
    }
    std::error_code ignored;
    const fs::path folder = fs::path(context.layout.unit(status.phase, 0)).parent_path();
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      const std::string file = entry.path().filename().string();
      const bool of_index = file.starts_with("index");
      if (file.find(".part-") != std::string::npos && (status.phase == Phase::report) == of_index) ++status.running;
    }
    status.running = std::min(status.running, status.units - status.done - status.failed);
    status.left = status.units - status.done - status.failed - status.running;
    out.push_back(status);
  }
  // A finished run has dropped the scratch folder: its phases count as done.
  if (out.back().done == 1)
    for (PhaseStatus& status : out) status = {status.phase, status.units, status.units, 0, 0, 0};
  return out;
}

std::string report_text(const PipelineOptions& options) {
  const Layout layout(options);
  std::ifstream in(layout.report_text());
  if (!in) throw Error(ErrorKind::input, layout.report_text() + ": there is no report yet; finish the run first");
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace hydrotin
