#include "exact_edges.h"

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

namespace hydrotin {
namespace {

// (h_w - h_a) |ab|^2 - (h_b - h_a) (aw . ab): the sign that is asked for.
template <class Number>
Number side(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& w, double h_a,
            double h_b, double h_w) {
  const Number x = Number(b[0]) - Number(a[0]), y = Number(b[1]) - Number(a[1]);
  const Number u = Number(w[0]) - Number(a[0]), v = Number(w[1]) - Number(a[1]);
  return (Number(h_w) - Number(h_a)) * (x * x + y * y) - (Number(h_b) - Number(h_a)) * (u * x + v * y);
}

}  // namespace

int valley_sign(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& w,
                double h_a, double h_b, double h_w) {
  const double value = side<double>(a, b, w, h_a, h_b, h_w);
  // Every difference is rounded once; products and sums add a few more roundings of terms no larger than these.
  const double x = std::abs(b[0] - a[0]), y = std::abs(b[1] - a[1]), u = std::abs(w[0] - a[0]),
               v = std::abs(w[1] - a[1]);
  const double size = std::abs(h_w - h_a) * (x * x + y * y) + std::abs(h_b - h_a) * (u * x + v * y);
  if (std::abs(value) > 1e-14 * size) return value > 0 ? 1 : -1;
  if (size == 0 && h_w == h_a && h_b == h_a) return 0;
  const auto exact = side<boost::multiprecision::cpp_rational>(a, b, w, h_a, h_b, h_w);
  return exact > 0 ? 1 : exact < 0 ? -1 : 0;
}

}  // namespace hydrotin
