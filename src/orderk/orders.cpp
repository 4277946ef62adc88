#include "hydrotin/orders.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <vector>

#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

bool is_between(LatticePoint a, LatticePoint b, LatticePoint p) {
  return std::min(a, b) < p && p < std::max(a, b);
}

// The points left and right of ab, and how many lie on the segment.
struct Sides {
  std::vector<std::uint32_t> left, right;
  std::uint32_t between = 0;
};

Sides split(std::span<const LatticePoint> points, std::uint32_t a, std::uint32_t b) {
  Sides out;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (i == a || i == b) continue;
    const int side = orientation(points[a], points[b], points[i]);
    if (side > 0)
      out.left.push_back(i);
    else if (side < 0)
      out.right.push_back(i);
    else
      out.between += is_between(points[a], points[b], points[i]);
  }
  return out;
}

// Circles through a and b that slide to the left: whether p is hit before q, both left of ab.
class HitBefore {
 public:
  HitBefore(std::span<const LatticePoint> points, std::uint32_t a, std::uint32_t b)
      : points_(points), a_(points[a]), b_(points[b]) {}
  bool operator()(std::uint32_t p, std::uint32_t q) const {
    return p != q && in_circle(a_, b_, points_[q], points_[p]);
  }

 private:
  std::span<const LatticePoint> points_;
  LatticePoint a_, b_;
};

}  // namespace

std::optional<std::uint32_t> triangle_order(std::span<const LatticePoint> points, std::uint32_t a, std::uint32_t b,
                                            std::uint32_t c) {
  assert(a != b && b != c && c != a);
  const int turn = orientation(points[a], points[b], points[c]);
  if (turn == 0) return std::nullopt;
  if (turn < 0) std::swap(b, c);
  std::uint32_t order = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (i != a && i != b && i != c) order += in_circle(points[a], points[b], points[c], points[i]);
  return order;
}

std::uint32_t edge_order(std::span<const LatticePoint> points, std::uint32_t a, std::uint32_t b) {
  Sides sides = split(points, a, b);
  std::sort(sides.left.begin(), sides.left.end(), HitBefore(points, a, b));
  // Sliding to the left a circle leaves the points on its right, those hit last by circles sliding to the right first.
  std::sort(sides.right.begin(), sides.right.end(), HitBefore(points, b, a));
  std::size_t inside_right = sides.right.size(), best = inside_right;
  for (std::size_t l = 0; l < sides.left.size(); ++l) {
    while (inside_right > 0 &&
           !in_circle(points[a], points[b], points[sides.left[l]], points[sides.right[inside_right - 1]]))
      --inside_right;
    best = std::min(best, l + inside_right);
  }
  best = std::min(best, sides.left.size());
  return sides.between + static_cast<std::uint32_t>(best);
}

std::optional<std::uint32_t> useful_edge_order(std::span<const LatticePoint> points, std::uint32_t a, std::uint32_t b) {
  const Sides sides = split(points, a, b);
  if (sides.between > 0 || (sides.left.empty() && sides.right.empty())) return std::nullopt;
  std::uint32_t order = 0;
  if (!sides.left.empty()) {
    const auto s1 = std::min_element(sides.left.begin(), sides.left.end(), HitBefore(points, a, b));
    order = std::max(order, *triangle_order(points, a, b, *s1));
  }
  if (!sides.right.empty()) {
    const auto s2 = std::min_element(sides.right.begin(), sides.right.end(), HitBefore(points, b, a));
    order = std::max(order, *triangle_order(points, a, b, *s2));
  }
  return order;
}

}  // namespace hydrotin
