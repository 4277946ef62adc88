#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <limits>

/// The lattice: the integers on which every combinatorial decision is taken.
///
/// A data set has one lattice. Files hold integers times scale plus offset; the program holds the same integers,
/// shifted once per data set (never per tile) so that they fit 32 bits. x and y share one scale, z has its own.
///
/// Units  lattice units in integers; metres (or the unit of the CRS) in doubles.

namespace hydrotin {

/// A planar point in lattice units. Ordered by (x, y): the only order that may break a tie.
struct LatticePoint {
  std::int32_t x = 0;
  std::int32_t y = 0;
  friend constexpr auto operator<=>(const LatticePoint&, const LatticePoint&) = default;
};

/// A closed box in lattice units; empty when min > max.
struct LatticeBox {
  LatticePoint min{std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max()};
  LatticePoint max{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min()};

  [[nodiscard]] constexpr bool is_empty() const { return min.x > max.x || min.y > max.y; }
  [[nodiscard]] constexpr bool contains(LatticePoint p) const {
    return p.x >= min.x && p.x <= max.x && p.y >= min.y && p.y <= max.y;
  }
  [[nodiscard]] constexpr bool intersects(const LatticeBox& other) const {
    return min.x <= other.max.x && other.min.x <= max.x && min.y <= other.max.y && other.min.y <= max.y;
  }
  constexpr void extend(LatticePoint p) {
    min = {std::min(min.x, p.x), std::min(min.y, p.y)};
    max = {std::max(max.x, p.x), std::max(max.y, p.y)};
  }
  constexpr void extend(const LatticeBox& box) {
    if (box.is_empty()) return;
    extend(box.min);
    extend(box.max);
  }
  friend constexpr bool operator==(const LatticeBox&, const LatticeBox&) = default;
};

/// Maps lattice integers to coordinates: x = (base_x + i) * scale_xy + offset_x, exactly as a reader of the files
/// would.
struct Lattice {
  double scale_xy = 1.0, scale_z = 1.0;
  double offset_x = 0.0, offset_y = 0.0, offset_z = 0.0;
  std::int64_t base_x = 0, base_y = 0, base_z = 0;  ///< shift of the data set, in lattice units

  [[nodiscard]] double x(std::int32_t i) const { return static_cast<double>(base_x + i) * scale_xy + offset_x; }
  [[nodiscard]] double y(std::int32_t i) const { return static_cast<double>(base_y + i) * scale_xy + offset_y; }
  [[nodiscard]] double z(std::int32_t i) const { return static_cast<double>(base_z + i) * scale_z + offset_z; }
  friend bool operator==(const Lattice&, const Lattice&) = default;
};

}  // namespace hydrotin
