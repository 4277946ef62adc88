#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hydrotin/options.h"
#include "hydrotin/phase.h"
#include "hydrotin/progress.h"

/// The pipeline: points in, terrain out.
///
/// Every function reads and writes nothing but the folders of the options. Results do not depend on tiling, workers,
/// memory or interruption. Errors are thrown as `Error`; whatever was complete stays complete.

namespace hydrotin {

/// What would be done.
struct PlanSummary {
  std::uint64_t files = 0, points = 0, tiles = 0;
  std::uint64_t worst_tile = 0, worst_tile_points = 0;
  std::uint64_t tile_bytes = 0;  ///< memory that the worst tile needs
  std::uint64_t tiles_in_flight = 0;
  std::uint64_t memory_bytes = 0;    ///< peak expected
  std::uint64_t disk_bytes = 0;      ///< scratch and output together
  double seconds = 0;                ///< rough, on this machine's workers
  std::uint64_t river_edges = 0;     ///< expected, by the points that the headers claim
  std::uint64_t river_bytes = 0;     ///< memory while they are matched
  std::string crs;                   ///< as EPSG:n or WKT; empty: none known
  std::vector<std::uint64_t> units;  ///< [kNumPhases]
};

struct PhaseStatus {
  Phase phase = Phase::plan;
  std::uint64_t units = 0, done = 0, running = 0, failed = 0, left = 0;
};

/// Facts about a finished data set; the end of report.json and the answer of `check`.
struct DatasetSummary {
  bool ok = false;
  std::uint64_t points = 0;  ///< decoded and kept by the filters
  std::uint64_t vertices = 0;
  std::uint64_t duplicates = 0;  ///< points at a place that another point has
  std::uint64_t triangles = 0;
  int order = 0;
  int max_triangle_order = 0;
  std::uint64_t order_sample = 0;  ///< triangles whose order was recounted (all of them when equal to `triangles`)
  std::uint64_t pits = 0;          ///< in the heights as written, outlets apart
  std::uint64_t river_edges = 0, invalid_river_edges = 0;
  std::vector<std::string> problems;
  std::string fingerprint;  ///< of the set of triangles as coordinates with final heights
};

/// Reads the inputs' headers and cuts the tiles. Writes nothing.
[[nodiscard]] PlanSummary plan_run(const PipelineOptions& options);

struct RunControl {
  Phase until = Phase::report;
  bool overwrite = false;  ///< forget complete units of an earlier run
  std::uint64_t order_sample = 1'000'000;
};

/// All phases up to `until` in this process. Returns the figures of the report (empty when stopped before it).
DatasetSummary run_pipeline(const PipelineOptions& options, const RunControl& control, Progress& progress);

/// Share `task` of `of` of one phase: units task, task + of, ... whose outputs are not complete yet.
void run_phase(const PipelineOptions& options, Phase phase, std::uint64_t task, std::uint64_t of, Progress& progress);

/// How far a run is, from its files alone.
[[nodiscard]] std::vector<PhaseStatus> pipeline_status(const PipelineOptions& options);

/// Verifies a finished data set from its files alone: checksums, topology, order, pits.
/// @param dir           the `output.dir` of a run
/// @param order_sample  at most so many triangles get their order recounted (spread evenly); 0: all
[[nodiscard]] DatasetSummary check_dataset(const std::string& dir, std::uint64_t order_sample = 1'000'000);

/// The plain-text report of a finished run.
[[nodiscard]] std::string report_text(const PipelineOptions& options);

}  // namespace hydrotin
