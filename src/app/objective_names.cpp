#include "objective_names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <sstream>

#include "hydrotin/error.h"

namespace hydrotin::app {

std::string all_objective_names() {
  return fmt::format("{}", fmt::join(kObjectiveNames, ", "));
}

Objectives objectives_or_complain(const std::string& key, const std::string& text) {
  Objectives out;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) {
    const auto objective = objective_named(word);
    if (!objective)
      throw Error(ErrorKind::config,
                  fmt::format("{}: '{}' is not possible (allowed: {})", key, word, all_objective_names()));
    out.push_back(*objective);
  }
  if (const auto objection = objection_to(out))
    throw Error(ErrorKind::config, fmt::format("{}: '{}' is not possible: {}", key, text, *objection));
  return out;
}

double unit_of(Objective objective, const Lattice& lattice) {
  switch (objective) {
    case Objective::min_weight:
    case Objective::min_max_edge:
    case Objective::min_max_circumradius:
    case Objective::min_max_enclosing_circle:
    case Objective::max_sum_inradius:
    case Objective::min_sum_inradius:
      return lattice.scale_xy;
    case Objective::min_max_area:
    case Objective::max_min_area:
      return lattice.scale_xy * lattice.scale_xy;
    case Objective::min_squared_error:
      return lattice.scale_z * lattice.scale_z;
    case Objective::min_absolute_error:
    case Objective::min_max_error:
      return lattice.scale_z;
    default:
      return 1;
  }
}

}  // namespace hydrotin::app
