#include "hydrotin/evaluate.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include "hydrotin/polygon.h"

namespace hydrotin {
namespace {

// A directed edge of a triangle.
struct Side {
  std::uint32_t low, high;  // ends, smaller first
  std::uint32_t apex;
  bool forward;  // from low to high
  friend auto operator<=>(const Side&, const Side&) = default;
};

std::vector<Side> sorted_sides(const Surface& surface) {
  std::vector<Side> sides;
  sides.reserve(3 * surface.triangles.size());
  for (const auto& t : surface.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), t[(i + 2) % 3], a < b});
    }
  std::sort(sides.begin(), sides.end());
  return sides;
}

// Calls visit(side, partner) per edge; partner is null on the boundary.
template <class Visit>
void for_edges(const Surface& surface, Visit visit) {
  const std::vector<Side> sides = sorted_sides(surface);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const bool paired = i + 1 < sides.size() && sides[i].low == sides[i + 1].low && sides[i].high == sides[i + 1].high;
    visit(sides[i], paired ? &sides[i + 1] : nullptr);
    if (paired) ++i;
  }
}

double total_length(const Surface& surface) {
  double sum = 0;
  for_edges(surface,
            [&](const Side& s, const Side*) { sum += edge_length(surface.position[s.low], surface.position[s.high]); });
  return sum;
}

double most_neighbors(const Surface& surface) {
  std::vector<std::uint32_t> degree(surface.position.size(), 0);
  for_edges(surface, [&](const Side& s, const Side*) {
    ++degree[s.low];
    ++degree[s.high];
  });
  return degree.empty() ? 0 : *std::max_element(degree.begin(), degree.end());
}

double pairs(Objective objective, const Surface& surface) {
  double value = 0;
  const auto point = [&](std::uint32_t v) { return SurfacePoint{surface.position[v], surface.height[v]}; };
  for_edges(surface, [&](const Side& s, const Side* partner) {
    if (partner == nullptr) return;
    const Side& forward = s.forward ? s : *partner;
    const Side& backward = s.forward ? *partner : s;
    const double score = quadrilateral_score(objective, point(s.low), point(s.high), point(forward.apex),
                                             point(backward.apex), surface.z_per_xy);
    value = objective == Objective::max_convex_edges ? value - score : std::max(value, score);
  });
  return value;
}

double minima(const Surface& surface) {
  std::vector<std::uint8_t> has_lower(surface.position.size());
  for (const auto& t : surface.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      has_lower[is_lower(surface.height[a], surface.position[a], surface.height[b], surface.position[b]) ? b : a] = 1;
    }
  return static_cast<double>(std::count(has_lower.begin(), has_lower.end(), std::uint8_t{0}));
}

}  // namespace

double evaluate(Objective objective, const Surface& surface) {
  const auto corners = [&](const std::array<std::uint32_t, 3>& t) {
    return std::array{surface.position[t[0]], surface.position[t[1]], surface.position[t[2]]};
  };
  switch (kind_of(objective)) {
    case ObjectiveKind::none:
      return 0;
    case ObjectiveKind::minima:
      return minima(surface);
    case ObjectiveKind::degree:
      return most_neighbors(surface);
    case ObjectiveKind::quadrilateral_sum:
    case ObjectiveKind::quadrilateral_bottleneck:
      return pairs(objective, surface);
    case ObjectiveKind::sum: {
      if (objective == Objective::min_weight) return total_length(surface);
      assert(!needs_reference(objective));
      double sum = 0;
      for (const auto& t : surface.triangles) {
        const auto [a, b, c] = corners(t);
        sum += inradius(a, b, c);
      }
      return sum;
    }
    case ObjectiveKind::bottleneck: {
      assert(!needs_reference(objective) && objective != Objective::min_max_order);
      if (surface.triangles.empty()) return 0;
      double worst = 0;
      for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto [a, b, c] = corners(surface.triangles[t]);
        const double score = triangle_score(objective, a, b, c);
        worst = t == 0 ? score : std::max(worst, score);
      }
      return measure_of_score(objective, worst);
    }
  }
  return 0;
}

}  // namespace hydrotin
