#include "hydrotin/measure.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "hydrotin/exact_sum.h"

namespace hydrotin {
namespace {

struct Difference {
  std::int64_t x, y;
};

Difference from(LatticePoint a, LatticePoint b) {
  return {std::int64_t{b.x} - a.x, std::int64_t{b.y} - a.y};
}

Wide dot(Difference u, Difference v) {
  return Wide{u.x} * v.x + Wide{u.y} * v.y;
}
Wide cross(Difference u, Difference v) {
  return Wide{u.x} * v.y - Wide{u.y} * v.x;
}

Wide squared_length(LatticePoint a, LatticePoint b) {
  return dot(from(a, b), from(a, b));
}

// Squared lengths of the sides, ascending.
std::array<Wide, 3> squared_sides(LatticePoint a, LatticePoint b, LatticePoint c) {
  std::array<Wide, 3> sides{squared_length(a, b), squared_length(b, c), squared_length(c, a)};
  std::sort(sides.begin(), sides.end());
  return sides;
}

double squared_circumradius(LatticePoint a, LatticePoint b, LatticePoint c) {
  const auto sides = squared_sides(a, b, c);
  const double area = 2 * twice_area(a, b, c);
  return static_cast<double>(sides[0]) * static_cast<double>(sides[1]) * static_cast<double>(sides[2]) / (area * area);
}

double squared_enclosing_radius(LatticePoint a, LatticePoint b, LatticePoint c) {
  const auto sides = squared_sides(a, b, c);
  if (sides[0] + sides[1] <= sides[2]) return static_cast<double>(sides[2]) / 4;
  return squared_circumradius(a, b, c);
}

// Cotangent of the angle at a: a quotient of integers, so that equal angles of equal triangles compare equal.
double cotangent(LatticePoint a, LatticePoint b, LatticePoint c) {
  return static_cast<double>(dot(from(a, b), from(a, c))) / static_cast<double>(cross(from(a, b), from(a, c)));
}

std::array<double, 3> cotangents(LatticePoint a, LatticePoint b, LatticePoint c) {
  return {cotangent(a, b, c), cotangent(b, c, a), cotangent(c, a, b)};
}

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

using Normal = std::array<double, 3>;

// Of a counter-clockwise triangle; the components are exact integers before they are rounded and scaled.
Normal normal(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c, double z_per_xy) {
  const Difference u = from(a.position, b.position), v = from(a.position, c.position);
  const std::int64_t uz = std::int64_t{b.height} - a.height, vz = std::int64_t{c.height} - a.height;
  return {static_cast<double>(Wide{u.y} * vz - Wide{uz} * v.y) * z_per_xy,
          static_cast<double>(Wide{uz} * v.x - Wide{u.x} * vz) * z_per_xy, static_cast<double>(cross(u, v))};
}

double angle_between(const Normal& m, const Normal& n) {
  const double x = m[1] * n[2] - m[2] * n[1], y = m[2] * n[0] - m[0] * n[2], z = m[0] * n[1] - m[1] * n[0];
  return degrees(std::atan2(std::sqrt(x * x + y * y + z * z), m[0] * n[0] + m[1] * n[1] + m[2] * n[2]));
}

// Whether d lies below the plane through a, b, c, which are counter-clockwise.
bool is_below(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c, const SurfacePoint& d) {
  const Difference u = from(a.position, b.position), v = from(a.position, c.position), w = from(a.position, d.position);
  const Wide uz = std::int64_t{b.height} - a.height, vz = std::int64_t{c.height} - a.height,
             wz = std::int64_t{d.height} - a.height;
  return uz * cross(v, w) - vz * cross(u, w) + wz * cross(u, v) < 0;
}

}  // namespace

double edge_length(LatticePoint a, LatticePoint b) {
  return std::sqrt(static_cast<double>(squared_length(a, b)));
}

double twice_area(LatticePoint a, LatticePoint b, LatticePoint c) {
  return static_cast<double>(cross(from(a, b), from(a, c)));
}

double inradius(LatticePoint a, LatticePoint b, LatticePoint c) {
  const auto sides = squared_sides(a, b, c);
  double perimeter = 0;
  for (const Wide side : sides) perimeter += std::sqrt(static_cast<double>(side));
  return twice_area(a, b, c) / perimeter;
}

double triangle_score(Objective objective, LatticePoint a, LatticePoint b, LatticePoint c) {
  switch (objective) {
    case Objective::min_max_edge:
      return static_cast<double>(squared_sides(a, b, c)[2]);
    case Objective::max_min_angle: {
      const auto cot = cotangents(a, b, c);
      return *std::max_element(cot.begin(), cot.end());
    }
    case Objective::min_max_angle: {
      const auto cot = cotangents(a, b, c);
      return -*std::min_element(cot.begin(), cot.end());
    }
    case Objective::min_max_circumradius:
      return squared_circumradius(a, b, c);
    case Objective::min_max_enclosing_circle:
      return squared_enclosing_radius(a, b, c);
    case Objective::min_max_area:
      return twice_area(a, b, c);
    case Objective::max_min_area:
      return -twice_area(a, b, c);
    default:
      assert(false && "not a measure of the shape of one triangle");
      return 0;
  }
}

double measure_of_score(Objective objective, double score) {
  switch (objective) {
    case Objective::min_max_edge:
    case Objective::min_max_circumradius:
    case Objective::min_max_enclosing_circle:
      return std::sqrt(score);
    case Objective::max_min_angle:
      return degrees(std::atan2(1, score));
    case Objective::min_max_angle:
      return degrees(std::atan2(1, -score));
    case Objective::min_max_area:
      return score / 2;
    case Objective::max_min_area:
      return -score / 2;
    default:
      return score;
  }
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

double quadrilateral_score(Objective objective, const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c,
                           const SurfacePoint& d, double z_per_xy) {
  switch (objective) {
    case Objective::min_max_area_ratio: {
      const double left = twice_area(a.position, b.position, c.position);
      const double right = twice_area(b.position, a.position, d.position);
      return std::max(left, right) / std::min(left, right);
    }
    case Objective::min_max_normal_angle:
      return angle_between(normal(a, b, c, z_per_xy), normal(b, a, d, z_per_xy));
    default:
      assert(objective == Objective::max_convex_edges);
      return is_below(a, b, c, d) ? -1 : 0;
  }
}

}  // namespace hydrotin
