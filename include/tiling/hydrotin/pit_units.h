#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/options.h"
#include "hydrotin/pit_choice.h"
#include "hydrotin/pit_removal.h"

/// The options of pit removal in lattice units, for the pipeline and for terrains in memory alike.
///
/// Source   own.
/// Units    options in metres; one unit of x and y of the CRS is `metres_per_unit` long. Results in lattice units.
/// Threads  Pure: safe to call concurrently.

namespace hydrotin {

/// Searches are bounded by `kScalableVisits`. A limit of depth or length that is a multiple of the lattice unit stays
/// one, whatever its text rounds to.
[[nodiscard]] RemovalOptions removal_options(const PitOptions& pits, const Lattice& lattice, double metres_per_unit);

/// @param is_inside, is_listed  [p] or empty, as `KeepConditions` has them.
[[nodiscard]] KeepConditions keep_conditions(const KeepPits& keep, const Lattice& lattice, double metres_per_unit,
                                             std::span<const std::uint8_t> is_inside,
                                             std::span<const std::uint8_t> is_listed);

/// Bounds of heights that may be lowered by `max_depth` at most and raised at will; empty: there is no such limit.
struct HeightBounds {
  std::vector<std::int32_t> lower, upper;  ///< [n]
};
[[nodiscard]] HeightBounds depth_bounds(std::span<const std::int32_t> height, std::int32_t max_depth);

/// Names as in configs and files.
[[nodiscard]] std::string outlet_policy(const PitOptions& options);
[[nodiscard]] std::string pit_method(const PitOptions& options);

}  // namespace hydrotin
