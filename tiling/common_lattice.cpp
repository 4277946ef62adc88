#include "common_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "hydrotin/error.h"

namespace hydrotin {
namespace {

constexpr double kDecimals = 1e10;  // scales and offsets are whole numbers of 1e-10 units

// The shortest decimal fraction that names this double, in units of 1e-10. A product with 1e10 would be off by its
// last bits for one offset in ten, and the common unit with it.
std::optional<std::int64_t> as_decimal(double value) {
  constexpr double kExact = 0x1p53;
  std::int64_t rest = static_cast<std::int64_t>(kDecimals);
  for (double power = 1; rest > 0; power *= 10, rest /= 10) {
    const double digits = std::round(value * power);
    if (!(std::fabs(digits) < kExact)) return std::nullopt;
    if (digits / power != value) continue;
    if (!(std::fabs(digits) * static_cast<double>(rest) < 9e18)) return std::nullopt;
    return static_cast<std::int64_t>(digits) * rest;
  }
  return std::nullopt;
}

// Unit and per-file maps of one axis group (x and y together, or z alone).
struct AxisGroup {
  std::vector<int> axes;
  std::int64_t unit = 0;  // in 1e-10; 0: all files agree to the bit, no decimals needed
};

bool all_equal(std::span<const FileLattice> files, const std::vector<int>& axes) {
  const FileLattice& first = files.front();
  for (const FileLattice& file : files)
    for (const int axis : axes) {
      const auto a = static_cast<std::size_t>(axis);
      if (file.scale[a] != first.scale[static_cast<std::size_t>(axes.front())] || file.offset[a] != first.offset[a])
        return false;
    }
  return true;
}

std::int64_t decimal_or_throw(const FileLattice& file, double value, const char* what) {
  if (const auto decimal = as_decimal(value)) return *decimal;
  throw Error(ErrorKind::input, file.path + ": the " + what + " " + std::to_string(value) +
                                    " in the header is no decimal fraction that can be brought onto one lattice with "
                                    "the other inputs; rewrite the files with one scale and offset");
}

std::int64_t common_unit(std::span<const FileLattice> files, const std::vector<int>& axes) {
  std::int64_t unit = 0;
  for (const int axis : axes) {
    const auto a = static_cast<std::size_t>(axis);
    const std::int64_t first = decimal_or_throw(files.front(), files.front().offset[a], "offset");
    for (const FileLattice& file : files) {
      unit = std::gcd(unit, decimal_or_throw(file, file.scale[a], "scale"));
      unit = std::gcd(unit, decimal_or_throw(file, file.offset[a], "offset") - first);
    }
  }
  return unit;
}

void place(std::span<const FileLattice> files, const AxisGroup& group, CommonLattice& out) {
  double& scale = group.axes.front() == 2 ? out.lattice.scale_z : out.lattice.scale_xy;
  const auto first_axis = static_cast<std::size_t>(group.axes.front());
  scale = group.unit == 0 ? files.front().scale[first_axis] : static_cast<double>(group.unit) / kDecimals;
  const std::array<double*, 3> offset{&out.lattice.offset_x, &out.lattice.offset_y, &out.lattice.offset_z};
  const std::array<std::int64_t*, 3> base{&out.lattice.base_x, &out.lattice.base_y, &out.lattice.base_z};
  for (const int axis : group.axes) {
    const auto a = static_cast<std::size_t>(axis);
    double origin = files.front().offset[a], low = files.front().min[a], high = files.front().max[a];
    for (const FileLattice& file : files) {
      origin = std::min(origin, file.offset[a]);
      low = std::min(low, file.min[a]);
      high = std::max(high, file.max[a]);
    }
    *offset[a] = origin;
    const double middle = std::round(((low + high) / 2 - origin) / scale);
    const double extent = (high - low) / scale;
    if (!(extent < 4.2e9) || !(std::fabs(middle) < 9e15))
      throw Error(ErrorKind::input,
                  files.front().path + " and the other inputs: " + "xyz"[a] + " spans " + std::to_string(high - low) +
                      " at a common unit of " + std::to_string(scale) +
                      ", more than 32 bits hold; rewrite the files with a coarser scale or fewer of them");
    *base[a] = static_cast<std::int64_t>(middle);
    for (std::size_t f = 0; f < files.size(); ++f) {
      if (group.unit == 0) {
        out.map[f].shift[a] = -*base[a];
        continue;
      }
      out.map[f].factor[a] = *as_decimal(files[f].scale[a]) / group.unit;
      out.map[f].shift[a] = (*as_decimal(files[f].offset[a]) - *as_decimal(origin)) / group.unit - *base[a];
    }
  }
}

}  // namespace

CommonLattice common_lattice(std::span<const FileLattice> files) {
  CommonLattice out;
  out.map.resize(files.size());
  for (AxisGroup group : {AxisGroup{{0, 1}}, AxisGroup{{2}}}) {
    if (!all_equal(files, group.axes)) group.unit = common_unit(files, group.axes);
    place(files, group, out);
  }
  return out;
}

}  // namespace hydrotin
