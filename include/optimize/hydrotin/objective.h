#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

/// What is optimised over the order-k triangulations.

namespace hydrotin {

enum class Objective : std::uint8_t {
  delaunay,     ///< keep the Delaunay triangulation
  min_weight,   ///< least total edge length
  local_minima  ///< fewest vertices without a lower neighbour, heights compared by (z, x, y)
};

inline constexpr std::array<std::string_view, 3> kObjectiveNames = {"delaunay", "min-weight", "local-minima"};

[[nodiscard]] constexpr std::string_view name(Objective objective) {
  return kObjectiveNames[static_cast<std::size_t>(objective)];
}

[[nodiscard]] constexpr std::optional<Objective> objective_named(std::string_view text) {
  for (std::size_t i = 0; i < kObjectiveNames.size(); ++i)
    if (kObjectiveNames[i] == text) return static_cast<Objective>(i);
  return std::nullopt;
}

}  // namespace hydrotin
