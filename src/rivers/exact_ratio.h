#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <cstdint>

#include "hydrotin/lattice.h"

namespace hydrotin {

__extension__ using Int128 = __int128;

/// Doubled area of the triangle a, b, c: positive if c lies left of the line from a to b. At most 2^66.
[[nodiscard]] inline Int128 doubled_area(LatticePoint a, LatticePoint b, LatticePoint c) {
  const std::int64_t bx = std::int64_t{b.x} - a.x, by = std::int64_t{b.y} - a.y;
  const std::int64_t cx = std::int64_t{c.x} - a.x, cy = std::int64_t{c.y} - a.y;
  return static_cast<Int128>(bx) * cy - static_cast<Int128>(by) * cx;
}

/// (b - a) . (c - a)
[[nodiscard]] inline Int128 dot_from(LatticePoint a, LatticePoint b, LatticePoint c) {
  return static_cast<Int128>(std::int64_t{b.x} - a.x) * (std::int64_t{c.x} - a.x) +
         static_cast<Int128>(std::int64_t{b.y} - a.y) * (std::int64_t{c.y} - a.y);
}

/// A rational number with a positive denominator; both parts below 2^68.
struct Ratio {
  Int128 numerator = 0, denominator = 1;
};

[[nodiscard]] inline int compare(const Ratio& a, const Ratio& b) {
  using Wide = boost::multiprecision::int256_t;
  const Wide left = Wide(a.numerator) * Wide(b.denominator), right = Wide(b.numerator) * Wide(a.denominator);
  return left < right ? -1 : left > right ? 1 : 0;
}

/// floor(numerator / denominator + 1/2); denominator > 0.
[[nodiscard]] inline Int128 rounded(Int128 numerator, Int128 denominator) {
  const Int128 a = 2 * numerator + denominator, b = 2 * denominator;
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

/// Where the line through p and q meets the segment ab, which it crosses or touches in one point: a + share (b - a).
[[nodiscard]] inline Ratio crossing_share(LatticePoint p, LatticePoint q, LatticePoint a, LatticePoint b) {
  const Int128 at_a = doubled_area(p, q, a), at_b = doubled_area(p, q, b);
  return at_a > at_b ? Ratio{at_a, at_a - at_b} : Ratio{-at_a, at_b - at_a};
}

/// The lattice point nearest to a + share (b - a).
[[nodiscard]] inline LatticePoint point_at(LatticePoint a, LatticePoint b, const Ratio& share) {
  const auto along = [&](std::int32_t from, std::int32_t to) {
    return static_cast<std::int32_t>(from + rounded((std::int64_t{to} - from) * share.numerator, share.denominator));
  };
  return {along(a.x, b.x), along(a.y, b.y)};
}

}  // namespace hydrotin
