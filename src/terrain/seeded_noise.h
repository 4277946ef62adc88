#pragma once

#include <cmath>
#include <cstdint>

/// Random numbers as pure functions of a seed and a place.

namespace hydrotin {

/// Scrambles 64 bits (the finaliser of SplitMix64: Steele, Lea and Flood, 2014).
[[nodiscard]] constexpr std::uint64_t scramble(std::uint64_t bits) {
  bits += 0x9E3779B97F4A7C15ULL;
  bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9ULL;
  bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBULL;
  return bits ^ (bits >> 31);
}

/// 64 random bits of the integer place (i, j).
[[nodiscard]] constexpr std::uint64_t random_bits(std::uint64_t seed, std::int64_t i, std::int64_t j) {
  return scramble(scramble(seed ^ (static_cast<std::uint64_t>(i) * 0xD6E8FEB86659FD93ULL)) +
                  static_cast<std::uint64_t>(j) * 0xA0761D6478BD642FULL);
}

/// The lower, second, third ... 16 bits as a number in [0, 1).
[[nodiscard]] constexpr double fraction16(std::uint64_t bits, int part) {
  return static_cast<double>((bits >> (16 * part)) & 0xFFFFU) * (1.0 / 65536);
}

/// A number in [0, 1) with 53 random bits.
[[nodiscard]] constexpr double fraction(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// Mean 0, standard deviation 1, nearly normal: the sum of four uniform numbers.
[[nodiscard]] inline double nearly_normal(std::uint64_t bits) {
  return (fraction16(bits, 0) + fraction16(bits, 1) + fraction16(bits, 2) + fraction16(bits, 3) - 2.0) * std::sqrt(3.0);
}

/// Smooth noise in [-1, 1] with features of size 1.
[[nodiscard]] inline double value_noise(std::uint64_t seed, double x, double y) {
  const double floor_x = std::floor(x), floor_y = std::floor(y);
  const auto i = static_cast<std::int64_t>(floor_x), j = static_cast<std::int64_t>(floor_y);
  const double u = x - floor_x, v = y - floor_y;
  const double s = u * u * (3 - 2 * u), t = v * v * (3 - 2 * v);
  const auto at = [&](std::int64_t a, std::int64_t b) { return fraction(random_bits(seed, a, b)); };
  const double south = at(i, j) + s * (at(i + 1, j) - at(i, j));
  const double north = at(i, j + 1) + s * (at(i + 1, j + 1) - at(i, j + 1));
  return 2 * (south + t * (north - south)) - 1;
}

/// Octaves of value noise: the largest features have size `wavelength`, each octave is half as large and as high.
[[nodiscard]] inline double fractal_noise(std::uint64_t seed, double x, double y, double wavelength, int octaves) {
  double sum = 0, amplitude = 1;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += amplitude * value_noise(seed + static_cast<std::uint64_t>(octave), x / wavelength, y / wavelength);
    amplitude *= 0.5;
    wavelength *= 0.5;
  }
  return sum;
}

}  // namespace hydrotin
