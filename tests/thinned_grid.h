#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "hydrotin/hilbert.h"
#include "hydrotin/triangulation.h"

/// A grid of heights as a TIN within a vertical error: rounds in which each triangle asks for its worst cell, granted
/// where no neighbour asks for a worse one.
namespace hydrotin::testing {

struct HeightGrid {
  std::uint32_t side = 0;
  std::vector<float> height;  ///< [side x side] row by row
  [[nodiscard]] float at(std::int32_t x, std::int32_t y) const {
    return height[static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x)];
  }
};

struct WorstCell {
  double error = 0;
  LatticePoint at;
};

inline WorstCell worst_cell(const HeightGrid& grid, LatticePoint a, LatticePoint b, LatticePoint c) {
  WorstCell worst;
  const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y, area = bx * cy - by * cx;
  const double ha = grid.at(a.x, a.y), hb = grid.at(b.x, b.y) - ha, hc = grid.at(c.x, c.y) - ha;
  const double east = (hb * cy - hc * by) / area, north = (hc * bx - hb * cx) / area;
  const auto [south, top] = std::minmax({a.y, b.y, c.y});
  for (std::int32_t y = south; y <= top; ++y) {
    double first = -1e18, last = 1e18;  // where row y is left of all three sides
    for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      const double dy = q.y - p.y, x = p.x + (y - p.y) * (q.x - p.x) / (dy == 0 ? 1 : dy);
      if (dy > 0) last = std::min(last, x);
      if (dy < 0) first = std::max(first, x);
    }
    for (auto x = static_cast<std::int32_t>(std::ceil(first - 1e-9)); x <= last + 1e-9; ++x) {
      const double error = std::abs(ha + east * (x - a.x) + north * (y - a.y) - grid.at(x, y));
      if (error > worst.error || (error == worst.error && LatticePoint{x, y} < worst.at)) worst = {error, {x, y}};
    }
  }
  return worst;
}

inline Triangulation thin_grid(const HeightGrid& grid, double max_error) {
  const auto side = static_cast<std::int32_t>(grid.side);
  std::vector<LatticePoint> wanted;
  for (std::int32_t y = 0; y < side; ++y)
    for (std::int32_t x = 0; x < side; ++x)
      if ((x % 32 == 0 || x + 1 == side) && (y % 32 == 0 || y + 1 == side)) wanted.push_back({x, y});
  DelaunayBuilder builder;
  Triangulation t;
  while (!wanted.empty()) {
    std::sort(wanted.begin(), wanted.end(),
              [](LatticePoint a, LatticePoint b) { return hilbert_key(a) < hilbert_key(b); });
    builder.insert(wanted);
    wanted.clear();
    t = builder.extract();
    std::vector<WorstCell> worst(t.origin.size() / 3);
    const auto corner = [&](std::size_t h) { return t.position[t.origin[h].value]; };
    for (std::size_t i = 0; i < worst.size(); ++i)
      worst[i] = worst_cell(grid, corner(3 * i), corner(3 * i + 1), corner(3 * i + 2));
    for (std::size_t i = 0; i < worst.size(); ++i) {
      if (!(worst[i].error > max_error)) continue;
      bool is_worst = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const HalfedgeId twin = t.twin[3 * i + k];
        if (twin == HalfedgeId{}) continue;
        const WorstCell& other = worst[twin.value / 3];
        is_worst =
            is_worst && (other.error < worst[i].error || (other.error == worst[i].error && !(other.at < worst[i].at)));
      }
      if (is_worst) wanted.push_back(worst[i].at);
    }
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  }
  return t;
}

}  // namespace hydrotin::testing
