#pragma once

#include <array>

namespace hydrotin {

/// Sign of h_w - ((1 - t) h_a + t h_b), t the foot of w on the line ab: -1 = w lies below the plane H of the edge.
/// Exact for all finite doubles: the difference is a polynomial, evaluated in rationals where rounding could matter.
[[nodiscard]] int valley_sign(const std::array<double, 2>& a, const std::array<double, 2>& b,
                              const std::array<double, 2>& w, double h_a, double h_b, double h_w);

}  // namespace hydrotin
