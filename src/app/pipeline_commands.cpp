#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands.h"
#include "config.h"
#include "hydrotin/error.h"
#include "hydrotin/pipeline.h"
#include "progress_display.h"

namespace hydrotin::app {
namespace {

using Json = nlohmann::ordered_json;

/// What every command on a config takes.
struct ConfigArguments {
  std::string config;
  std::vector<std::string> set;
  std::string workers, memory;
  bool json = false;

  [[nodiscard]] PipelineOptions read() const {
    std::vector<ConfigOverride> overrides;
    for (const auto& assignment : set) overrides.push_back(parse_override(assignment));
    if (!workers.empty()) overrides.push_back({"run.workers", workers, "--workers"});
    if (!memory.empty()) overrides.push_back({"run.memory", memory, "--memory"});
    return read_config(config, overrides);
  }
};

CLI::App* add_command(CLI::App& program, const std::string& name, const std::string& description,
                      ConfigArguments& arguments, bool with_json = true) {
  CLI::App* command = program.add_subcommand(name, description);
  command->add_option("config", arguments.config, "config file (YAML)")->required()->type_name("CONFIG");
  command->add_option("--set", arguments.set, "override a key of the config, for example tiles.target_points=1000000")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command->add_option("--workers", arguments.workers, "threads, or auto (run.workers)")->type_name("N");
  command->add_option("--memory", arguments.memory, "memory budget, for example 4GiB (run.memory)")->type_name("SIZE");
  if (with_json) command->add_flag("--json", arguments.json, "print JSON");
  return command;
}

Phase phase_or_complain(const std::string& text, const std::string& option) {
  if (const auto phase = phase_named(text)) return *phase;
  std::string names;
  for (const auto known : kPhaseNames) names += (names.empty() ? "" : ", ") + std::string(known);
  throw Error(ErrorKind::config, option + ": no phase is called '" + text + "' (phases: " + names + ")");
}

std::filesystem::path events_file(const PipelineOptions& options) {
  const std::filesystem::path scratch = options.run.scratch.empty() ? std::filesystem::path(options.output.dir) / "work"
                                                                    : std::filesystem::path(options.run.scratch);
  return scratch / "events.jsonl";
}

ProgressDisplay make_display(const PipelineOptions& options) {
  return {stderr, isatty(STDERR_FILENO) == 1, events_file(options)};
}

Json summary_json(const DatasetSummary& summary) {
  return {{"ok", summary.ok},
          {"points", summary.points},
          {"vertices", summary.vertices},
          {"duplicates", summary.duplicates},
          {"triangles", summary.triangles},
          {"order", summary.order},
          {"max_triangle_order", summary.max_triangle_order},
          {"order_sample", summary.order_sample},
          {"pits", summary.pits},
          {"river_edges", summary.river_edges},
          {"invalid_river_edges", summary.invalid_river_edges},
          {"problems", summary.problems},
          {"fingerprint", summary.fingerprint}};
}

void print_summary(const DatasetSummary& summary, bool as_json) {
  if (as_json) {
    fmt::print("{}\n", summary_json(summary).dump(2));
    return;
  }
  fmt::print("points              {}\n", summary.points);
  fmt::print("duplicates          {}\n", summary.duplicates);
  fmt::print("vertices            {}\n", summary.vertices);
  fmt::print("triangles           {}\n", summary.triangles);
  fmt::print("order               {}\n", summary.order);
  const std::string recounted =
      summary.order_sample > 0 ? fmt::format(" (recounted for {} triangles)", summary.order_sample) : "";
  fmt::print("max triangle order  {}{}\n", summary.max_triangle_order, recounted);
  fmt::print("pits                {}\n", summary.pits);
  fmt::print("fingerprint         {}\n", summary.fingerprint);
  for (const auto& problem : summary.problems) fmt::print("problem: {}\n", problem);
  fmt::print("{}\n", summary.ok ? "ok" : "NOT ok");
}

int print_plan(const PipelineOptions& options, bool as_json) {
  const PlanSummary plan = plan_run(options);
  Json units = Json::object();
  for (std::size_t i = 0; i < plan.units.size() && i < kNumPhases; ++i)
    units[std::string(kPhaseNames[i])] = plan.units[i];
  if (as_json) {
    const Json json = {{"files", plan.files},
                       {"points", plan.points},
                       {"crs", plan.crs.empty() ? Json(nullptr) : Json(plan.crs)},
                       {"tiles", plan.tiles},
                       {"worst_tile", plan.worst_tile},
                       {"worst_tile_points", plan.worst_tile_points},
                       {"tile_bytes", plan.tile_bytes},
                       {"tiles_in_flight", plan.tiles_in_flight},
                       {"memory_bytes", plan.memory_bytes},
                       {"disk_bytes", plan.disk_bytes},
                       {"river_edges", plan.river_edges},
                       {"river_bytes", plan.river_bytes},
                       {"seconds", plan.seconds},
                       {"units", units}};
    fmt::print("{}\n", json.dump(2));
    return 0;
  }
  constexpr double kMiB = 1024.0 * 1024.0;
  fmt::print("files            {}\n", plan.files);
  fmt::print("points           {}\n", plan.points);
  fmt::print("crs              {}\n", plan.crs.empty() ? "unknown" : plan.crs);
  fmt::print("tiles            {}\n", plan.tiles);
  fmt::print("worst tile       {} with {} points, {:.1f} MiB\n", plan.worst_tile, plan.worst_tile_points,
             static_cast<double>(plan.tile_bytes) / kMiB);
  fmt::print("tiles in flight  {}\n", plan.tiles_in_flight);
  fmt::print("memory           {:.1f} MiB\n", static_cast<double>(plan.memory_bytes) / kMiB);
  if (plan.river_edges > 0) {
    fmt::print("rivers           about {} river edges, {:.1f} MiB while they are matched ({:.1f} KiB an edge){}\n",
               plan.river_edges, static_cast<double>(plan.river_bytes) / kMiB,
               static_cast<double>(plan.river_bytes) / 1024.0 / static_cast<double>(plan.river_edges),
               plan.river_bytes > options.run.memory_bytes
                   ? ": more than run.memory, unless classes and thinning leave "
                     "fewer points"
                   : "");
  }
  fmt::print("disk             {:.1f} MiB\n", static_cast<double>(plan.disk_bytes) / kMiB);
  fmt::print("time             {} (rough)\n", as_duration(plan.seconds));
  for (const auto& [phase, count] : units.items())
    fmt::print("units            {:<12} {}\n", phase, count.get<std::uint64_t>());
  return 0;
}

int print_status(const PipelineOptions& options, bool as_json) {
  const auto phases = pipeline_status(options);
  if (as_json) {
    Json rows = Json::array();
    for (const auto& row : phases)
      rows.push_back({{"phase", name(row.phase)},
                      {"units", row.units},
                      {"done", row.done},
                      {"running", row.running},
                      {"failed", row.failed},
                      {"left", row.left}});
    fmt::print("{}\n", Json{{"phases", rows}}.dump(2));
    return 0;
  }
  fmt::print("{:<12} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "phase", "units", "done", "running", "failed", "left");
  for (const auto& row : phases)
    fmt::print("{:<12} {:>8} {:>8} {:>8} {:>8} {:>8}\n", name(row.phase), row.units, row.done, row.running, row.failed,
               row.left);
  return 0;
}

void add_run(CLI::App& program, Action& action) {
  struct Arguments : ConfigArguments {
    std::string until = "report";
    bool overwrite = false, dry_run = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = add_command(program, "run", "run all phases in this process", *arguments);
  command->add_option("--until", arguments->until, "stop after this phase")->type_name("PHASE");
  command->add_flag("--overwrite", arguments->overwrite, "forget what an earlier run has done");
  command->add_flag("--dry-run", arguments->dry_run, "only say what would be done");
  command->callback([arguments, &action] {
    action = [arguments] {
      const PipelineOptions options = arguments->read();
      const RunControl control{.until = phase_or_complain(arguments->until, "--until"),
                               .overwrite = arguments->overwrite};
      if (arguments->dry_run) return print_plan(options, arguments->json);
      ProgressDisplay display = make_display(options);
      const DatasetSummary summary = run_pipeline(options, control, display);
      if (control.until != Phase::report) return 0;
      print_summary(summary, arguments->json);
      return summary.ok ? 0 : static_cast<int>(ErrorKind::check);
    };
  });
}

void add_phase(CLI::App& program, Action& action) {
  struct Arguments : ConfigArguments {
    std::string phase;
    std::uint64_t task = 0, of = 1;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand("phase", "run this task's share of one phase (job arrays)");
  command->add_option("name", arguments->phase, "phase")->required()->type_name("NAME");
  command->add_option("config", arguments->config, "config file (YAML)")->required()->type_name("CONFIG");
  command->add_option("--task", arguments->task, "number of this task, from 0")->required()->type_name("I");
  command->add_option("--of", arguments->of, "number of tasks")->required()->type_name("N");
  command->add_option("--set", arguments->set, "override a key of the config")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command->add_option("--workers", arguments->workers, "threads, or auto (run.workers)")->type_name("N");
  command->add_option("--memory", arguments->memory, "memory budget, for example 4GiB (run.memory)")->type_name("SIZE");
  command->callback([arguments, &action] {
    action = [arguments] {
      const Phase phase = phase_or_complain(arguments->phase, "phase");
      if (arguments->of == 0 || arguments->task >= arguments->of)
        throw Error(ErrorKind::config, fmt::format("--task {} --of {}: tasks are numbered from 0 to N - 1",
                                                   arguments->task, arguments->of));
      const PipelineOptions options = arguments->read();
      ProgressDisplay display = make_display(options);
      run_phase(options, phase, arguments->task, arguments->of, display);
      return 0;
    };
  });
}

void add_check(CLI::App& program, Action& action) {
  struct Arguments : ConfigArguments {
    std::uint64_t order_sample = 1'000'000;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand("check", "verify a finished data set from its files alone");
  command->add_option("config", arguments->config, "config file, or the folder of a finished data set")
      ->required()
      ->type_name("CONFIG|DIR");
  command->add_option("--set", arguments->set, "override a key of the config")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command->add_option("--order-sample", arguments->order_sample, "recount the order of so many triangles; 0: of all")
      ->type_name("N");
  command->add_flag("--json", arguments->json, "print JSON");
  command->callback([arguments, &action] {
    action = [arguments] {
      std::string dir = arguments->config;
      if (!std::filesystem::is_directory(dir)) dir = arguments->read().output.dir;
      const DatasetSummary summary = check_dataset(dir, arguments->order_sample);
      print_summary(summary, arguments->json);
      return summary.ok ? 0 : static_cast<int>(ErrorKind::check);
    };
  });
}

}  // namespace

void add_pipeline_commands(CLI::App& program, Action& action) {
  add_run(program, action);
  auto plan = std::make_shared<ConfigArguments>();
  add_command(program, "plan", "say what would be done: tiles, units, memory, disk, time", *plan)
      ->callback([plan, &action] { action = [plan] { return print_plan(plan->read(), plan->json); }; });
  add_phase(program, action);
  auto status = std::make_shared<ConfigArguments>();
  add_command(program, "status", "how far a run is", *status)->callback([status, &action] {
    action = [status] { return print_status(status->read(), status->json); };
  });
  add_check(program, action);
  auto report = std::make_shared<ConfigArguments>();
  add_command(program, "report", "the report of a finished run", *report, false)->callback([report, &action] {
    action = [report] {
      fmt::print("{}", report_text(report->read()));
      return 0;
    };
  });
}

}  // namespace hydrotin::app
