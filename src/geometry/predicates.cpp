#include "hydrotin/predicates.h"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

namespace hydrotin {
namespace {

__extension__ using Int128 = __int128;

struct Offset {
  std::int64_t x, y;
};

template <class Int>
int determinant_sign(Offset a, Offset b, Offset c) {
  const Int ax = a.x, ay = a.y, bx = b.x, by = b.y, cx = c.x, cy = c.y;
  const Int det = (ax * ax + ay * ay) * (bx * cy - by * cx) + (bx * bx + by * by) * (cx * ay - cy * ax) +
                  (cx * cx + cy * cy) * (ax * by - ay * bx);
  return det > 0 ? 1 : det < 0 ? -1 : 0;
}

// The leading monomial of the perturbed determinant that does not vanish belongs to the largest point whose removal
// leaves the others not collinear; two steps are always enough because a, b, c are not collinear.
bool inside_by_perturbation(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d) {
  std::array<LatticePoint, 4> by_order{a, b, c, d};
  std::sort(by_order.begin(), by_order.end());
  for (int i = 3; i > 0; --i) {
    const LatticePoint p = by_order[static_cast<std::size_t>(i)];
    if (p == d) return false;
    const int o = p == c ? orientation(a, b, d) : p == b ? orientation(a, d, c) : orientation(d, b, c);
    if (o != 0) return o > 0;
  }
  return false;
}

}  // namespace

int in_circle_sign(LatticePoint pa, LatticePoint pb, LatticePoint pc, LatticePoint pd) {
  const Offset a{std::int64_t{pa.x} - pd.x, std::int64_t{pa.y} - pd.y};
  const Offset b{std::int64_t{pb.x} - pd.x, std::int64_t{pb.y} - pd.y};
  const Offset c{std::int64_t{pc.x} - pd.x, std::int64_t{pc.y} - pd.y};

  // Offsets are exact in double; the bound is Shewchuk's for the determinant evaluated in this order, rounded up.
  const double ax = static_cast<double>(a.x), ay = static_cast<double>(a.y);
  const double bx = static_cast<double>(b.x), by = static_cast<double>(b.y);
  const double cx = static_cast<double>(c.x), cy = static_cast<double>(c.y);
  const double bc1 = bx * cy, bc2 = by * cx, ca1 = cx * ay, ca2 = cy * ax, ab1 = ax * by, ab2 = ay * bx;
  const double a2 = ax * ax + ay * ay, b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  const double det = a2 * (bc1 - bc2) + b2 * (ca1 - ca2) + c2 * (ab1 - ab2);
  const double permanent = a2 * (std::fabs(bc1) + std::fabs(bc2)) + b2 * (std::fabs(ca1) + std::fabs(ca2)) +
                           c2 * (std::fabs(ab1) + std::fabs(ab2));
  constexpr double kBound = 1.2e-15;
  if (det > kBound * permanent) return 1;
  if (-det > kBound * permanent) return -1;

  const std::int64_t extent =
      std::max({std::abs(a.x), std::abs(a.y), std::abs(b.x), std::abs(b.y), std::abs(c.x), std::abs(c.y)});
  // |det| <= 12 extent^4 must stay under 2^127.
  if (extent <= (std::int64_t{1} << 30)) return determinant_sign<Int128>(a, b, c);
  return determinant_sign<boost::multiprecision::int256_t>(a, b, c);
}

bool in_circle(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d) {
  const int sign = in_circle_sign(a, b, c, d);
  return sign != 0 ? sign > 0 : inside_by_perturbation(a, b, c, d);
}

}  // namespace hydrotin
