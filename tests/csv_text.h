#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

/// Small point files for the one-shot commands.

namespace hydrotin::testing {

inline std::string csv_of(const std::vector<std::array<double, 3>>& points) {
  std::string text = "x,y,z\n";
  char line[100];
  for (const auto& p : points) {
    std::snprintf(line, sizeof line, "%.2f,%.2f,%.2f\n", p[0], p[1], p[2]);
    text += line;
  }
  return text;
}

inline std::vector<std::array<double, 3>> random_points(std::uint32_t seed, int n) {
  std::mt19937 random(seed);
  std::vector<std::array<double, 3>> points;
  for (int i = 0; i < n; ++i)
    points.push_back({static_cast<double>(random() % 10000) / 100, static_cast<double>(random() % 10000) / 100,
                      static_cast<double>(random() % 1000) / 100});
  return points;
}

}  // namespace hydrotin::testing
