#pragma once

#include <cstdint>
#include <string>

#include "hydrotin/river_constraints.h"

/// Constraints of rivers as users write them. `option` is the name or place that messages begin with.
/// Fails: Error(config), all of them.

namespace hydrotin::app {

[[noreturn]] void refuse(const std::string& option, const std::string& text, const std::string& wanted);

/// "10%" of the average slope, "1deg", or rise over run.
void set_decline(const std::string& option, const std::string& text, RiverConstraints& constraints);

/// VF, VFR or VFRS. Call it after `set_decline`.
void set_variant(const std::string& option, const std::string& text, RiverConstraints& constraints);

/// "50%" of the old slope, or 0.5.
[[nodiscard]] double parse_slope_limit(const std::string& option, const std::string& text);

/// A number of imaginary points, or "exact"; empty: none.
void set_contiguity(const std::string& option, const std::string& text, RiverConstraints& constraints);

/// So many directions in which the slope of triangles is limited.
void set_directions(const std::string& option, std::uint32_t number, RiverConstraints& constraints);

}  // namespace hydrotin::app
