#pragma once

#include <string>

#include "hydrotin/measure.h"
#include "hydrotin/objective.h"

namespace hydrotin::app {

/// Objectives from names separated by commas. Fails: Error(config) that begins with `key` and says what is allowed.
[[nodiscard]] Objectives objectives_or_complain(const std::string& key, const std::string& text);

[[nodiscard]] std::string all_objective_names();

}  // namespace hydrotin::app
