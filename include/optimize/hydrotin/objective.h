#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What is optimised over the order-k triangulations, and how several objectives compose.
///
/// A list of objectives is a priority: the second decides among the triangulations that are best for the first, and so
/// on, polygon by polygon; among those left, the one with the most Delaunay edges is taken, then the one whose apexes
/// come first in (x, y).
///
/// Source   thesis, Sections 3.1 (decomposable), 3.2 (not decomposable), 3.4 (point sets).
/// Threads  Pure functions.

namespace hydrotin {

enum class Objective : std::uint8_t {
  delaunay,                  ///< keep the Delaunay triangulation
  min_weight,                ///< least total edge length
  local_minima,              ///< fewest vertices without a lower neighbour, heights compared by (z, x, y)
  min_max_edge,              ///< shortest longest edge
  max_min_angle,             ///< largest smallest angle
  min_max_angle,             ///< smallest largest angle
  min_max_circumradius,      ///< smallest largest circumcircle
  min_max_enclosing_circle,  ///< smallest largest least circle around a triangle
  min_max_area,              ///< smallest largest triangle
  max_min_area,              ///< largest smallest triangle
  max_sum_inradius,          ///< largest total of the radii of inscribed circles
  min_sum_inradius,          ///< its least
  min_squared_error,         ///< least sum of squared vertical distances of reference points
  min_absolute_error,        ///< least sum of vertical distances of reference points
  min_max_error,             ///< smallest largest vertical distance of a reference point
  min_max_degree,            ///< smallest largest number of neighbours of a vertex
  min_max_area_ratio,        ///< smallest largest ratio of areas across an edge
  min_max_normal_angle,      ///< smallest largest angle between normals across an edge
  max_convex_edges,          ///< most edges at which the surface bends down on both sides
  min_max_order              ///< smallest largest order of a triangle: the lowest-order completion
};

inline constexpr std::array<std::string_view, 20> kObjectiveNames = {
    "delaunay",           "min-weight",           "local-minima",         "min-max-edge",
    "max-min-angle",      "min-max-angle",        "min-max-circumradius", "min-max-enclosing-circle",
    "min-max-area",       "max-min-area",         "max-sum-inradius",     "min-sum-inradius",
    "min-squared-error",  "min-absolute-error",   "min-max-error",        "min-max-degree",
    "min-max-area-ratio", "min-max-normal-angle", "max-convex-edges",     "min-max-order"};

/// How the values of triangles make the value of a triangulation.
enum class ObjectiveKind : std::uint8_t {
  none,                      ///< nothing is optimised
  sum,                       ///< added over triangles
  bottleneck,                ///< the worst triangle counts
  minima,                    ///< vertices without a lower neighbour
  degree,                    ///< the worst vertex counts
  quadrilateral_sum,         ///< added over pairs of triangles with a common edge
  quadrilateral_bottleneck,  ///< the worst such pair counts
};

[[nodiscard]] constexpr ObjectiveKind kind_of(Objective objective) {
  switch (objective) {
    case Objective::delaunay:
      return ObjectiveKind::none;
    case Objective::local_minima:
      return ObjectiveKind::minima;
    case Objective::min_weight:
    case Objective::max_sum_inradius:
    case Objective::min_sum_inradius:
    case Objective::min_squared_error:
    case Objective::min_absolute_error:
      return ObjectiveKind::sum;
    case Objective::min_max_degree:
      return ObjectiveKind::degree;
    case Objective::max_convex_edges:
      return ObjectiveKind::quadrilateral_sum;
    case Objective::min_max_area_ratio:
    case Objective::min_max_normal_angle:
      return ObjectiveKind::quadrilateral_bottleneck;
    default:
      return ObjectiveKind::bottleneck;
  }
}

/// Whether the value grows with quality, so that bounds are from above.
[[nodiscard]] constexpr bool is_maximised(Objective objective) {
  return objective == Objective::max_min_angle || objective == Objective::max_min_area ||
         objective == Objective::max_sum_inradius || objective == Objective::max_convex_edges;
}

/// Whether reference points decide.
[[nodiscard]] constexpr bool needs_reference(Objective objective) {
  return objective == Objective::min_squared_error || objective == Objective::min_absolute_error ||
         objective == Objective::min_max_error;
}

[[nodiscard]] constexpr std::string_view name(Objective objective) {
  return kObjectiveNames[static_cast<std::size_t>(objective)];
}

[[nodiscard]] constexpr std::optional<Objective> objective_named(std::string_view text) {
  for (std::size_t i = 0; i < kObjectiveNames.size(); ++i)
    if (kObjectiveNames[i] == text) return static_cast<Objective>(i);
  return std::nullopt;
}

/// Objectives by priority, the first before all.
using Objectives = std::vector<Objective>;

/// The names, separated by commas.
[[nodiscard]] std::string name(const Objectives& objectives);

/// Why a list cannot be optimised (empty, repeated, or an objective that must stand alone), or nothing if it can.
[[nodiscard]] std::optional<std::string> objection_to(const Objectives& objectives);

}  // namespace hydrotin
