#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "hydrotin/lifting.h"
#include "hydrotin/spill_tree.h"
#include "part.h"
#include "phases.h"
#include "tiling_fixture.h"

// Lifting in tiles against lifting in memory: the same TIN, one thread, one process, CPU time.
//
// What belongs to lifting in tiles is what turns heights of parts into levels: each part reduced to its rim, the global
// pass, and the levels inside the parts. Reading triangles, building graphs and writing results belong to the phases
// around it: lifting in memory finds its graph made, too. What whole phases take, files and all, is printed as well.
//   cmake --preset release && cmake --build --preset release --target tiled_lifting_benchmark &&
//   build/release/tests/tiled_lifting_benchmark --points 1e6 --target-points 1e5 --noise 20

namespace hydrotin {
namespace {

struct Arguments {
  double points = 1e6;
  std::uint64_t target_points = 100'000;
  std::int32_t noise = 20;
  int repeats = 5;
};

double cpu_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The least time of some runs: noise only adds.
double time_of(int repeats, const std::function<void()>& run) {
  double best = 0;
  for (int i = 0; i < repeats; ++i) {
    const double start = cpu_seconds();
    run();
    const double taken = cpu_seconds() - start;
    best = i == 0 ? taken : std::min(best, taken);
  }
  return best;
}

/// The parts as one TIN: vertices by ascending id, so along the curve inside each tile, as a terrain in memory is kept.
struct Whole {
  VertexGraph graph;
  std::vector<std::int32_t> height;
  std::vector<std::uint8_t> is_outlet;
};

Whole merge(const std::vector<Part>& parts, const std::vector<std::vector<std::uint8_t>>& outlet) {
  std::vector<std::uint64_t> id;
  for (const Part& part : parts) id.insert(id.end(), part.point.begin(), part.point.end());
  std::sort(id.begin(), id.end());
  id.erase(std::unique(id.begin(), id.end()), id.end());
  Whole w;
  w.height.resize(id.size());
  w.is_outlet.resize(id.size());
  std::vector<std::uint32_t> triangle, number;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    number.clear();
    for (std::uint32_t v = 0; v < parts[p].num_vertices(); ++v) {
      const auto at =
          static_cast<std::uint32_t>(std::lower_bound(id.begin(), id.end(), parts[p].point[v]) - id.begin());
      number.push_back(at);
      w.height[at] = parts[p].height[v];
      w.is_outlet[at] |= outlet[p][v];
    }
    for (const std::uint32_t v : parts[p].triangle) triangle.push_back(number[v]);
  }
  w.graph = make_vertex_graph(static_cast<std::uint32_t>(id.size()), triangle);
  return w;
}

PipelineOptions make_store(const Arguments& arguments, const testing::TemporaryFolder& folder) {
  const auto n = static_cast<std::size_t>(arguments.points);
  const auto position = testing::distinct(testing::make_cloud(testing::CloudKind::uniform, 1, n, 100));
  std::vector<std::int32_t> height;
  for (const LatticePoint p : position) height.push_back(testing::relief_at(1, p, 30000, 30000, arguments.noise));
  PipelineOptions options = testing::options_for(testing::write_files(folder, position, height, 4), folder / "out");
  options.triangulation.order = 0;
  options.pits.method = PitMethod::lift;
  options.tiles.target_points = arguments.target_points;
  options.run.workers = 1;
  options.run.memory_bytes = std::uint64_t{8} << 30;
  testing::Silent silent;
  RunControl control;
  control.until = Phase::mend;
  (void)run_pipeline(options, control, silent);
  return options;
}

void run(const Arguments& arguments) {
  const testing::TemporaryFolder folder;
  const PipelineOptions options = make_store(arguments, folder);
  const Layout layout(options);
  RunContext context{
      options, layout, load_plan(layout.unit(Phase::plan, 0)), load_outline(layout.unit(Phase::outline, 0)), {}};
  std::vector<Part> parts;
  std::vector<std::vector<std::uint8_t>> outlet;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    parts.push_back(load_part(context, t));
    outlet.push_back(outlet_flags(context, parts.back()));
  }
  const Whole whole = merge(parts, outlet);
  std::vector<std::int32_t> level;
  const double in_memory =
      time_of(arguments.repeats, [&] { level = lift(whole.graph, whole.height, whole.is_outlet); });
  const auto raised = std::count_if(level.begin(), level.end(),
                                    [&, v = std::size_t{0}](std::int32_t l) mutable { return l != whole.height[v++]; });

  std::vector<SpillTree> trees(parts.size());
  RimLevels rims;
  const double reduce = time_of(arguments.repeats, [&] {
    for (std::size_t t = 0; t < parts.size(); ++t)
      trees[t] = reduce_to_rim(parts[t].graph, parts[t].height, parts[t].point, parts[t].is_rim, outlet[t]);
  });
  const double global = time_of(arguments.repeats, [&] { rims = drain(trees); });
  const double again = time_of(arguments.repeats, [&] {
    for (std::size_t t = 0; t < parts.size(); ++t) {
      std::vector<std::int32_t> source(parts[t].num_vertices(), kNoLevel);
      const std::vector<std::uint32_t> rim = parts[t].rim();
      const std::vector<std::int32_t> known = rims.of(trees[t].rim);
      for (std::size_t i = 0; i < rim.size(); ++i) source[rim[i]] = known[i];
      (void)lift_from(parts[t].graph, parts[t].height, outlet[t], source);
    }
  });
  std::vector<Catchments> catchments(parts.size());
  const double reduce_and_keep = time_of(arguments.repeats, [&] {
    for (std::size_t t = 0; t < parts.size(); ++t)
      trees[t] =
          reduce_to_rim(parts[t].graph, parts[t].height, parts[t].point, parts[t].is_rim, outlet[t], &catchments[t]);
  });
  const double levels = time_of(arguments.repeats, [&] {
    for (std::size_t t = 0; t < parts.size(); ++t) (void)lift_catchments(catchments[t], rims.of(trees[t].rim));
  });

  fmt::print("{} vertices, {} raised, {} tiles, {} on rims\n", level.size(), raised, parts.size(), rims.vertex.size());
  const auto row = [&](const char* what, double seconds) {
    fmt::print("{:<52}{:>9.4f} s{:>8.2f}\n", what, seconds, seconds / in_memory);
  };
  row("lift in memory", in_memory);
  row("  reduce to rims", reduce);
  row("  drain", global);
  row("  flood parts from their rims", again);
  row("in tiles, two floods", reduce + global + again);
  row("  reduce to rims, catchments kept", reduce_and_keep);
  row("  levels from catchments", levels);
  row("in tiles, as runs do it (target: 1.3)", reduce_and_keep + global + levels);
  testing::Silent silent;
  for (const Phase phase : {Phase::nest, Phase::rank, Phase::weigh, Phase::choose, Phase::spill, Phase::drain,
                            Phase::pools, Phase::members, Phase::groups, Phase::settle, Phase::finish})
    row(("phase " + std::string(name(phase))).c_str(), time_of(1, [&] { run_phase(options, phase, 0, 1, silent); }));
}

}  // namespace
}  // namespace hydrotin

int main(int argc, char** argv) {
  hydrotin::Arguments arguments;
  CLI::App program("times lifting in tiles against lifting in memory");
  program.add_option("--points", arguments.points, "points")->capture_default_str();
  program.add_option("--target-points", arguments.target_points, "points per tile")->capture_default_str();
  program.add_option("--noise", arguments.noise, "of heights, in lattice units; 0: few pits")->capture_default_str();
  program.add_option("--repeats", arguments.repeats, "the least time of so many")->capture_default_str();
  CLI11_PARSE(program, argc, argv);
  hydrotin::run(arguments);
  return 0;
}
