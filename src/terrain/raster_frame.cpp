#include "hydrotin/raster_frame.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hydrotin {
namespace {

constexpr double kSubUnits = static_cast<double>(std::int64_t{1} << kSubLatticeBits);
constexpr double kFar = static_cast<double>(std::int64_t{1} << 50);

std::int64_t to_sub_lattice(double world, double offset, double scale, std::int64_t base) {
  const double units = (world - offset) / scale - static_cast<double>(base);
  return std::llround(std::clamp(units * kSubUnits, -kFar, kFar));
}

/// The first index in [0, n) for which `is_past` holds, n if none; it holds for all after the first.
template <class Predicate>
std::int64_t first_index(std::int64_t n, Predicate is_past) {
  std::int64_t low = 0, high = n;
  while (low < high) {
    const std::int64_t middle = low + (high - low) / 2;
    if (is_past(middle))
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

}  // namespace

std::int64_t center_x(const RasterFrame& frame, const Lattice& lattice, std::int64_t column) {
  const double world = frame.origin_x + (static_cast<double>(column) + 0.5) * frame.cell;
  return to_sub_lattice(world, lattice.offset_x, lattice.scale_xy, lattice.base_x);
}

std::int64_t center_y(const RasterFrame& frame, const Lattice& lattice, std::int64_t row) {
  const double world = frame.origin_y - (static_cast<double>(row) + 0.5) * frame.cell;
  return to_sub_lattice(world, lattice.offset_y, lattice.scale_xy, lattice.base_y);
}

CellRange cells_in(const RasterFrame& frame, const Lattice& lattice, const LatticeBox& box) {
  if (box.is_empty()) return {};
  constexpr std::int64_t kUnit = std::int64_t{1} << kSubLatticeBits;
  const std::int64_t left = box.min.x * kUnit, right = (std::int64_t{box.max.x} + 1) * kUnit;
  const std::int64_t bottom = box.min.y * kUnit, top = (std::int64_t{box.max.y} + 1) * kUnit;
  const auto column_at = [&](std::int64_t x) {
    return first_index(frame.columns, [&](std::int64_t column) { return center_x(frame, lattice, column) >= x; });
  };
  const auto row_below = [&](std::int64_t y) {
    return first_index(frame.rows, [&](std::int64_t row) { return center_y(frame, lattice, row) < y; });
  };
  return {column_at(left), column_at(right), row_below(top), row_below(bottom)};
}

RasterFrame frame_around(const Lattice& lattice, const LatticeBox& box, double cell) {
  assert(!box.is_empty() && cell > 0 && "a frame needs a box and a cell");
  const double left = std::floor(lattice.x(box.min.x) / cell), right = std::floor(lattice.x(box.max.x) / cell) + 1;
  const double bottom = std::floor(lattice.y(box.min.y) / cell), top = std::floor(lattice.y(box.max.y) / cell) + 1;
  return {left * cell, top * cell, cell, std::llround(right - left), std::llround(top - bottom)};
}

}  // namespace hydrotin
