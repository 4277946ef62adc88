#include "schedule.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <mutex>

#include "store.h"

namespace hydrotin {
namespace {

bool is_single(Phase phase) {
  return phase == Phase::plan || phase == Phase::survey || phase == Phase::outline || phase == Phase::join ||
         phase == Phase::mend || phase == Phase::match || phase == Phase::unite || phase == Phase::rank ||
         phase == Phase::choose || phase == Phase::drain || phase == Phase::lakes || phase == Phase::groups ||
         phase == Phase::report;
}

bool is_of_thinning(Phase phase) {
  return phase == Phase::survey || phase == Phase::thin || phase == Phase::verify;
}

bool is_of_rivers(Phase phase) {
  return phase >= Phase::lay && phase <= Phase::unite;
}

void do_unit(const RunContext& context, Phase phase, std::uint32_t unit) {
  switch (phase) {
    case Phase::plan:
      return save_plan(context.plan, context.layout.unit(phase, 0));
    case Phase::ingest:
      return ingest_file(context, unit);
    case Phase::arrange:
      return arrange_tile(context, unit);
    case Phase::survey:
      return survey_points(context);
    case Phase::thin:
      return thin_tile(context, unit);
    case Phase::outline:
      return make_outline(context);
    case Phase::triangulate:
      return triangulate_tile(context, unit);
    case Phase::join:
      return join_pieces(context);
    case Phase::seam:
      return solve_seams(context, unit);
    case Phase::mend:
      return mend_minima(context);
    case Phase::lay:
      return lay_tile(context, unit);
    case Phase::match:
      return match_rivers(context);
    case Phase::embed:
      return embed_groups(context, unit);
    case Phase::unite:
      return unite_groups(context);
    case Phase::nest:
      return nest_pools(context, unit);
    case Phase::rank:
      return rank_pools_of_all(context);
    case Phase::weigh:
      return weigh_pools_of(context, unit);
    case Phase::choose:
      return choose_pits(context);
    case Phase::spill:
      return reduce_tile(context, unit);
    case Phase::drain:
      return drain_tiles(context);
    case Phase::pools:
      return pool_tile(context, unit);
    case Phase::lakes:
      return join_lakes(context);
    case Phase::breach:
      return breach_lakes(context, unit);
    case Phase::members:
      return find_members(context, unit);
    case Phase::groups:
      return join_groups(context);
    case Phase::settle:
      return settle_groups(context, unit);
    case Phase::finish:
      return finish_tile(context, unit);
    case Phase::verify:
      return verify_tile(context, unit);
    case Phase::raster:
      return rasterize_tile(context, unit);
    case Phase::report:
      return write_report(context);
  }
}

// Points of the tiles: as counted last, or as expected.
const std::vector<std::uint64_t>& counts_known(const RunContext& context) {
  if (!context.outline.count.empty()) return context.outline.count;
  return context.survey.count.empty() ? context.plan.expected : context.survey.count;
}

std::uint64_t work_of(const RunContext& context, Phase phase, std::uint64_t unit) {
  if (phase == Phase::ingest) return context.plan.files[unit].points;
  const std::vector<std::uint64_t>& count = counts_known(context);
  if (!is_single(phase)) return count[unit];
  std::uint64_t all = 0;
  for (const std::uint64_t n : count) all += n;
  return all;
}

std::uint32_t units_at_once(const RunContext& context, Phase phase) {
  if (is_single(phase)) return 1;
  if (phase == Phase::ingest) {
    constexpr std::uint64_t kFileNeed = std::uint64_t{128} << 20;
    return std::clamp<std::uint32_t>(static_cast<std::uint32_t>(context.options.run.memory_bytes / kFileNeed), 1,
                                     worker_count(context.options.run));
  }
  std::vector<std::uint64_t> count = counts_known(context);
  if (!context.outline.count.empty())
    for (std::size_t t = 0; t < count.size(); ++t) count[t] += context.outline.reference_count[t] / kReferencePerPoint;
  const auto largest = std::max_element(count.begin(), count.end());
  return tiles_in_flight(context.options.run, *largest, static_cast<std::uint64_t>(largest - count.begin()));
}

// A text beside the output of a unit that failed, for `status`.
class FailureNote {
 public:
  explicit FailureNote(const std::string& unit) : path_(unit + ".failed") {}
  void write(const std::string& text) const {
    std::error_code ignored;
    std::filesystem::create_directories(std::filesystem::path(path_).parent_path(), ignored);
    std::ofstream(path_) << text << '\n';
  }
  void remove() const {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }

 private:
  std::string path_;
};

}  // namespace

std::uint64_t tile_need_bytes(std::uint64_t points) {
  return (std::uint64_t{24} << 20) + 640 * points;
}

std::uint32_t worker_count(const ExecutionOptions& run) {
  return static_cast<std::uint32_t>(run.workers > 0 ? run.workers : tbb::info::default_concurrency());
}

std::uint32_t tiles_in_flight(const ExecutionOptions& run, std::uint64_t largest_tile, std::uint64_t tile) {
  const std::uint64_t need = tile_need_bytes(largest_tile);
  if (need > run.memory_bytes)
    throw Error(ErrorKind::resource, "tile " + std::to_string(tile) + " has " + std::to_string(largest_tile) +
                                         " points and needs " + std::to_string(need >> 20) +
                                         " MiB, but run.memory is " + std::to_string(run.memory_bytes >> 20) +
                                         " MiB; raise run.memory or lower tiles.target_points");
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(run.memory_bytes / need, worker_count(run)));
}

std::uint64_t num_units(const RunContext& context, Phase phase) {
  if (is_of_thinning(phase) && !context.thins()) return 0;
  if (is_of_rivers(phase) && !context.has_rivers()) return 0;
  const Plan& plan = context.plan;
  const PitMethod method = context.options.pits.method;
  if (phase >= Phase::pools && phase <= Phase::settle && method == PitMethod::none) return 0;
  if ((phase == Phase::lakes || phase == Phase::breach) && method == PitMethod::lift) return 0;  // breaches nothing
  return is_single(phase) ? 1 : phase == Phase::ingest ? plan.files.size() : plan.num_tiles();
}

void run_units(const RunContext& context, Phase phase, std::uint64_t task, std::uint64_t of, bool force,
               Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const std::uint64_t end = num_units(context, phase);
  const std::string recipe = phase == Phase::plan ? context.plan.recipe : context.recipe(phase);
  std::uint64_t units = 0, work = 0;
  for (std::uint64_t unit = task; unit < end; unit += of, ++units) work += work_of(context, phase, unit);
  progress.phase_begins(phase, units, work);

  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, worker_count(context.options.run));
  std::mutex reporting;
  std::uint64_t upcoming = task;
  const auto next_unit = [&](tbb::flow_control& control) -> std::uint64_t {
    if (upcoming >= end) control.stop();
    const std::uint64_t unit = upcoming;
    upcoming += of;
    return unit;
  };
  const auto make = [&](std::uint64_t unit) {
    const std::string path = context.layout.unit(phase, unit);
    const bool complete = !force && store::recipe_of(path) == recipe;
    if (!complete) {
      const FailureNote failure(path);
      try {
        do_unit(context, phase, static_cast<std::uint32_t>(unit));
      } catch (const std::exception& error) {
        failure.write(error.what());
        throw;
      }
      failure.remove();
    }
    const std::lock_guard lock(reporting);
    progress.unit_done(phase, unit, work_of(context, phase, unit), complete);
  };
  if (is_single(phase)) {
    for (; upcoming < end; upcoming += of) make(upcoming);  // no TBB task around loops that use OpenMP
  } else {
    tbb::parallel_pipeline(units_at_once(context, phase),
                           tbb::make_filter<void, std::uint64_t>(tbb::filter_mode::serial_in_order, next_unit) &
                               tbb::make_filter<std::uint64_t, void>(tbb::filter_mode::parallel, make));
  }
  progress.phase_ends(phase, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

}  // namespace hydrotin
