#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "clouds.h"
#include "hydrotin/lattice.h"

/// Fractal mountains: octaves of gradient noise whose heights fall by a constant factor from each to the next finer
/// one, so that pits have all sizes, from single vertices to lakes as wide as the mountains.
namespace hydrotin::testing {

/// One octave: smooth, 0 at the nodes of a lattice of size 1, with a random slope at each.
inline double gradient_noise(std::uint64_t seed, double x, double y) {
  const double i = std::floor(x), j = std::floor(y), u = x - i, v = y - j;
  const auto slope = [&](double di, double dj) {
    const auto a = static_cast<std::uint64_t>(static_cast<std::int64_t>(i + di));
    const auto b = static_cast<std::uint64_t>(static_cast<std::int64_t>(j + dj));
    Random random(seed * 0x9e3779b97f4a7c15u ^ (a * 0xd6e8feb86659fd93u + b * 0xa0761d6478bd642fu));
    const double east = 2 * random.unit() - 1, north = 2 * random.unit() - 1;
    return east * (u - di) + north * (v - dj);
  };
  const auto fade = [](double t) { return t * t * t * (t * (6 * t - 15) + 10); };
  const double s = fade(u), t = fade(v);
  const double low = slope(0, 0) * (1 - s) + slope(1, 0) * s, high = slope(0, 1) * (1 - s) + slope(1, 1) * s;
  return low * (1 - t) + high * t;
}

struct FractalMountains {
  double wavelength = 0;    ///< of the coarsest octave
  double finest = 0;        ///< no octave has a shorter one
  double relief = 160'000;  ///< from the lowest to the highest point, lattice units
  double persistence = 0;   ///< height of an octave by that of the next coarser one; 0.5: alike at all scales, more:
                            ///< rougher and with more pits the closer one looks
};

/// Heights between 0 and the relief.
inline std::vector<std::int32_t> fractal_heights(std::uint64_t seed, const std::vector<LatticePoint>& points,
                                                 const FractalMountains& mountains) {
  std::vector<double> sum(points.size(), 0.0);
  double amplitude = 1, wavelength = mountains.wavelength;
  for (std::uint64_t octave = 1; wavelength >= mountains.finest; ++octave) {
    const double shift = 0.37 * static_cast<double>(octave);  // or the nodes of all octaves would lie on each other
    for (std::size_t i = 0; i < points.size(); ++i)
      sum[i] +=
          amplitude * gradient_noise(seed + octave, points[i].x / wavelength + shift, points[i].y / wavelength + shift);
    amplitude *= mountains.persistence;
    wavelength /= 2;
  }
  const auto [lowest, highest] = std::minmax_element(sum.begin(), sum.end());
  const double base = *lowest, scale = mountains.relief / (*highest - *lowest);
  std::vector<std::int32_t> height(points.size());
  std::transform(sum.begin(), sum.end(), height.begin(),
                 [&](double z) { return static_cast<std::int32_t>((z - base) * scale); });
  return height;
}

}  // namespace hydrotin::testing
