#include "hydrotin/objective.h"

#include <algorithm>

namespace hydrotin {

std::string name(const Objectives& objectives) {
  std::string text;
  for (const Objective objective : objectives) {
    if (!text.empty()) text += ',';
    text += name(objective);
  }
  return text;
}

std::optional<std::string> objection_to(const Objectives& objectives) {
  if (objectives.empty()) return "no objective is given";
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    std::string quoted("'");
    quoted.append(name(objectives[i])).append("'");
    if (std::find(objectives.begin(), objectives.begin() + static_cast<std::ptrdiff_t>(i), objectives[i]) !=
        objectives.begin() + static_cast<std::ptrdiff_t>(i))
      return quoted + " is given twice";
    if (objectives.size() == 1) break;
    switch (kind_of(objectives[i])) {
      case ObjectiveKind::none:
      case ObjectiveKind::degree:
      case ObjectiveKind::quadrilateral_sum:
      case ObjectiveKind::quadrilateral_bottleneck:
        return quoted + " must stand alone";
      default:
        break;
    }
  }
  return std::nullopt;
}

}  // namespace hydrotin
