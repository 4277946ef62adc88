#include "disc.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hydrotin/predicates.h"
#include "hydrotin/wide.h"

namespace hydrotin {

bool Region::meets(const LatticeBox& box) const {
  if (box.is_empty()) return false;
  if (is_half_plane) {
    const std::array<LatticePoint, 4> corners{{box.min, {box.max.x, box.min.y}, box.max, {box.min.x, box.max.y}}};
    return std::any_of(corners.begin(), corners.end(), [&](LatticePoint c) { return orientation(from, to, c) < 0; });
  }
  const double dx = std::max({static_cast<double>(box.min.x) - x, 0.0, x - box.max.x});
  const double dy = std::max({static_cast<double>(box.min.y) - y, 0.0, y - box.max.y});
  return dx * dx + dy * dy <= radius * radius;
}

Region disc_through(LatticePoint a, LatticePoint b, LatticePoint c) {
  // Relative to a; the differences are exact, the rest carries its error along.
  const double bx = static_cast<double>(b.x) - a.x, by = static_cast<double>(b.y) - a.y;
  const double cx = static_cast<double>(c.x) - a.x, cy = static_cast<double>(c.y) - a.y;
  const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  const std::int64_t ibx = std::int64_t{b.x} - a.x, iby = std::int64_t{b.y} - a.y;
  const std::int64_t icx = std::int64_t{c.x} - a.x, icy = std::int64_t{c.y} - a.y;
  const double d = 2 * static_cast<double>(static_cast<Wide>(ibx) * icy - static_cast<Wide>(iby) * icx);
  const double ux = (cy * b2 - by * c2) / d, uy = (bx * c2 - cx * b2) / d;
  const double size =
      (std::fabs(cy * b2) + std::fabs(by * c2) + std::fabs(bx * c2) + std::fabs(cx * b2)) / std::fabs(d);
  const double error =
      4e-15 * size + 1e-15 * (std::fabs(static_cast<double>(a.x)) + std::fabs(static_cast<double>(a.y)));
  Region out;
  out.x = a.x + ux;
  out.y = a.y + uy;
  out.radius = std::sqrt(ux * ux + uy * uy) * (1 + 1e-14) + 4 * error + 1e-3;
  return out;
}

Region half_plane_right_of(LatticePoint from, LatticePoint to) {
  Region out;
  out.is_half_plane = true;
  out.from = from;
  out.to = to;
  return out;
}

double distance2(LatticePoint p, const LatticeBox& box) {
  const double dx =
      static_cast<double>(std::max({std::int64_t{box.min.x} - p.x, std::int64_t{0}, std::int64_t{p.x} - box.max.x}));
  const double dy =
      static_cast<double>(std::max({std::int64_t{box.min.y} - p.y, std::int64_t{0}, std::int64_t{p.y} - box.max.y}));
  return dx * dx + dy * dy;
}

}  // namespace hydrotin
