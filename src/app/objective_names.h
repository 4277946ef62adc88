#pragma once

#include <string>

#include "hydrotin/lattice.h"
#include "hydrotin/objective.h"

namespace hydrotin::app {

/// Objectives from names separated by commas. Fails: Error(config) that begins with `key` and says what is allowed.
[[nodiscard]] Objectives objectives_or_complain(const std::string& key, const std::string& text);

[[nodiscard]] std::string all_objective_names();

/// What one unit of an objective's value is in the unit of the coordinates: a length, an area, a height or 1.
[[nodiscard]] double unit_of(Objective objective, const Lattice& lattice);

}  // namespace hydrotin::app
