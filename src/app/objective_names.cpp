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

}  // namespace hydrotin::app
