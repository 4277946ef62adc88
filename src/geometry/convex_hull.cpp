#include "hydrotin/convex_hull.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

// The extreme points in eight directions; what lies strictly inside their polygon is no hull vertex.
std::vector<LatticePoint> extremes(std::span<const LatticePoint> position) {
  constexpr std::array<std::array<std::int64_t, 2>, 8> kDirections{
      {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
  std::array<LatticePoint, 8> best;
  best.fill(position.front());
  for (const LatticePoint p : position)
    for (std::size_t i = 0; i < 8; ++i) {
      const auto value = [&](LatticePoint q) { return kDirections[i][0] * q.x + kDirections[i][1] * q.y; };
      if (value(p) > value(best[i])) best[i] = p;
    }
  std::vector<LatticePoint> out;
  for (const LatticePoint p : best)
    if (out.empty() || (p != out.back() && p != out.front())) out.push_back(p);
  return out;
}

}  // namespace

std::vector<std::uint32_t> convex_hull(std::span<const LatticePoint> position) {
  std::vector<std::uint32_t> order;
  if (position.empty()) return order;
  const auto frame = extremes(position);
  for (std::uint32_t i = 0; i < position.size(); ++i) {
    bool inside = frame.size() > 2;
    for (std::size_t j = 0; inside && j < frame.size(); ++j)
      inside = orientation(frame[j], frame[(j + 1) % frame.size()], position[i]) > 0;
    if (!inside) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return position[a] < position[b]; });
  // Andrew's monotone chain: lower side, then upper side.
  std::vector<std::uint32_t> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t base = hull.size();
    for (const std::uint32_t i : order) {
      while (hull.size() >= base + 2 &&
             orientation(position[hull[hull.size() - 2]], position[hull.back()], position[i]) <= 0)
        hull.pop_back();
      hull.push_back(i);
    }
    hull.pop_back();
    std::reverse(order.begin(), order.end());
  }
  if (hull.empty()) hull = order;  // one point
  return hull;
}

}  // namespace hydrotin
