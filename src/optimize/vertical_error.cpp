#include "hydrotin/vertical_error.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

// Side of p + (e, e^2) against the line from a to b.
int perturbed_side(LatticePoint a, LatticePoint b, LatticePoint p) {
  const int side = orientation(a, b, p);
  if (side != 0) return side;
  if (a.y != b.y) return a.y > b.y ? 1 : -1;
  return a.x < b.x ? 1 : -1;
}

}  // namespace

bool owns(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint p, bool on_rim) {
  if (on_rim) return orientation(a, b, p) >= 0 && orientation(b, c, p) >= 0 && orientation(c, a, p) >= 0;
  return perturbed_side(a, b, p) > 0 && perturbed_side(b, c, p) > 0 && perturbed_side(c, a, p) > 0;
}

VerticalDistance vertical_distance(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c, LatticePoint p,
                                   std::int32_t height) {
  const auto difference = [&](LatticePoint q) {
    return std::pair{Wide{std::int64_t{q.x} - a.position.x}, Wide{std::int64_t{q.y} - a.position.y}};
  };
  const auto [ux, uy] = difference(b.position);
  const auto [vx, vy] = difference(c.position);
  const auto [wx, wy] = difference(p);
  const Wide area = ux * vy - uy * vx, at_b = wx * vy - wy * vx, at_c = ux * wy - uy * wx;
  const std::int64_t zb = std::int64_t{b.height} - a.height, zc = std::int64_t{c.height} - a.height;
  return {(std::int64_t{height} - a.height) * area - zb * at_b - zc * at_c, area};
}

double VerticalDistance::value() const {
  constexpr Wide kExact = Wide{1} << 53;
  Wide n = numerator, d = denominator;
  if (n > kExact || n < -kExact || d > kExact) {  // lowest terms, so that rounding starts from the same numbers
    Wide a = n < 0 ? -n : n, b = d;
    while (b != 0) a = std::exchange(b, a % b);
    n /= a;
    d /= a;
  }
  return static_cast<double>(n) / static_cast<double>(d);
}

bool ErrorLimit::allows(const VerticalDistance& distance) const {
  const auto magnitude = distance.numerator < 0 ? -distance.numerator : distance.numerator;
  // Whole units first, so that the products stay below 2^127: the rest is less than the denominator.
  const auto whole = magnitude / distance.denominator, rest = magnitude % distance.denominator;
  const std::int64_t limit_whole = millionths / 1'000'000, limit_rest = millionths % 1'000'000;
  if (whole != limit_whole) return whole < limit_whole;
  return rest * 1'000'000 <= limit_rest * distance.denominator;
}

void TriangleError::add(const VerticalDistance& distance, const ErrorLimit* limit) {
  const double d = std::abs(distance.value());
  squared.add(d * d);
  absolute.add(d);
  largest = std::max(largest, d);
  if (limit != nullptr) within_limit = within_limit && limit->allows(distance);
}

void TriangleError::add(const TriangleError& other) {
  squared.add(other.squared);
  absolute.add(other.absolute);
  largest = std::max(largest, other.largest);
  within_limit = within_limit && other.within_limit;
}

}  // namespace hydrotin
