#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "hydrotin/progress.h"
#include "phases.h"

/// Who does which unit when, and how many at once.

namespace hydrotin {

/// Memory that a tile of so many points needs while it is worked on, measured on scan lines at order 6, rounded up.
[[nodiscard]] std::uint64_t tile_need_bytes(std::uint64_t points);

/// Tiles that may be in flight: as many as workers, or as the budget holds.
/// Fails: Error(resource) if not even the largest tile fits.
[[nodiscard]] std::uint32_t tiles_in_flight(const ExecutionOptions& run, std::uint64_t largest_tile,
                                            std::uint64_t tile);

[[nodiscard]] std::uint32_t worker_count(const ExecutionOptions& run);

/// Number of units of a phase.
[[nodiscard]] std::uint64_t num_units(const RunContext& context, Phase phase);

/// Share `task` of `of` of the units of one phase. Units whose output has the right recipe are skipped unless `force`.
/// A unit that fails leaves a note beside its output, stops the phase and is thrown on.
void run_units(const RunContext& context, Phase phase, std::uint64_t task, std::uint64_t of, bool force,
               Progress& progress);

}  // namespace hydrotin
