#include "plane_lattice.h"

#include <algorithm>
#include <cmath>

namespace hydrotin::app {
namespace {

constexpr double kMostUnits = 1073741824.0;  // from the west to the east, from the south to the north

bool fits(std::span<const std::array<double, 2>> position, double denominator) {
  return std::all_of(position.begin(), position.end(), [&](const std::array<double, 2>& p) {
    return std::all_of(p.begin(), p.end(), [&](double x) {
      const double scaled = std::round(x * denominator);
      return std::abs(scaled) < 9007199254740992.0 &&
             std::abs(scaled / denominator - x) <= 4e-16 * std::max(std::abs(x), 1.0);
    });
  });
}

}  // namespace

LatticePoint PlaneLattice::nearest(double x, double y) const {
  return {static_cast<std::int32_t>(std::llround(x * denominator) - base_x),
          static_cast<std::int32_t>(std::llround(y * denominator) - base_y)};
}

PlaneLattice find_lattice(std::span<const std::array<double, 2>> position, int refine) {
  PlaneLattice lattice;
  if (position.empty()) return lattice;
  std::array<double, 2> least = position[0], most = position[0];
  for (const auto& p : position)
    for (std::size_t i = 0; i < 2; ++i) {
      least[i] = std::min(least[i], p[i]);
      most[i] = std::max(most[i], p[i]);
    }
  const double extent = std::max({most[0] - least[0], most[1] - least[1], 1e-300});
  lattice.denominator = 0;
  for (double d = 1; d <= 1e12 && extent * d <= kMostUnits; d *= 10)
    if ((d >= 100 || extent * d * 10 > kMostUnits) && fits(position, d)) {
      lattice.denominator = d;
      break;
    }
  for (; refine > 1 && lattice.denominator > 0 && extent * lattice.denominator * 10 <= kMostUnits; refine /= 10)
    lattice.denominator *= 10;
  lattice.is_exact = lattice.denominator > 0;
  if (!lattice.is_exact) {
    const double largest = std::max({std::abs(least[0]), std::abs(least[1]), std::abs(most[0]), std::abs(most[1])});
    const double finest = std::min(kMostUnits / extent, 4503599627370496.0 / std::max(largest, 1e-300));
    lattice.denominator = std::exp2(std::floor(std::log2(finest)));
  }
  lattice.base_x = std::llround((least[0] + (most[0] - least[0]) / 2) * lattice.denominator);
  lattice.base_y = std::llround((least[1] + (most[1] - least[1]) / 2) * lattice.denominator);
  return lattice;
}

std::vector<std::vector<LatticePoint>> on_lattice(const PlaneLattice& lattice,
                                                  std::span<const std::array<double, 3>> chain) {
  const double west = static_cast<double>(lattice.base_x) / lattice.denominator;
  const double south = static_cast<double>(lattice.base_y) / lattice.denominator;
  const double reach = lattice.reach() * (1 - 1e-9);
  std::vector<std::vector<LatticePoint>> parts;
  bool is_open = false;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const std::array<double, 2> from{chain[i - 1][0] - west, chain[i - 1][1] - south};
    const std::array<double, 2> step{chain[i][0] - chain[i - 1][0], chain[i][1] - chain[i - 1][1]};
    double first = 0, last = 1;
    for (std::size_t k = 0; k < 2; ++k)
      for (const double sign : {-1.0, 1.0}) {  // sign * (from + share * step) <= reach
        const double room = reach - sign * from[k], speed = sign * step[k];
        if (speed > 0) last = std::min(last, room / speed);
        if (speed < 0) first = std::max(first, room / speed);
        if (speed == 0 && room < 0) last = -1;
      }
    if (first > last) {
      is_open = false;
      continue;
    }
    const auto at = [&](double share) {
      if (share == 0) return lattice.nearest(chain[i - 1][0], chain[i - 1][1]);
      if (share == 1) return lattice.nearest(chain[i][0], chain[i][1]);
      return lattice.nearest(west + from[0] + share * step[0], south + from[1] + share * step[1]);
    };
    if (!is_open || first > 0) parts.push_back({at(first)});
    parts.back().push_back(at(last));
    is_open = last == 1;
  }
  return parts;
}

}  // namespace hydrotin::app
