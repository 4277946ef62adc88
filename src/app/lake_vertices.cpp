#include "lake_vertices.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "hydrotin/error.h"
#include "hydrotin/vector_reader.h"

namespace hydrotin::app {
namespace {

using Plane = std::array<double, 2>;

/// Even-odd rule over all rings; the border belongs to the polygon.
bool is_inside(const VectorParts& parts, std::size_t part, const Plane& p) {
  bool inside = false;
  for (std::size_t r = parts.ring_begin[part]; r < parts.ring_begin[part + 1]; ++r) {
    const auto ring = parts.ring(r);
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const auto &a = ring[j], &b = ring[i];
      const double turn = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
      const auto [west, east] = std::minmax(a[0], b[0]);
      const auto [south, north] = std::minmax(a[1], b[1]);
      if (turn == 0 && p[0] >= west && p[0] <= east && p[1] >= south && p[1] <= north) return true;
      if ((a[1] > p[1]) != (b[1] > p[1]) && (turn > 0) == (b[1] > a[1])) inside = !inside;
    }
  }
  return inside;
}

/// An empty attribute leaves the level open.
void set_level(const std::string& path, const std::string& field, const VectorParts& parts, std::size_t part,
               Lake& lake) {
  const std::string& text = parts.value[part];
  if (text.empty()) return;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), lake.level);
  if (error != std::errc{} || stop != text.data() + text.size() || !std::isfinite(lake.level))
    throw Error(ErrorKind::input, fmt::format("{}: feature {}: {} is '{}', not a height (write a number, or nothing)",
                                              path, parts.feature[part], field, text));
  lake.has_level = true;
}

}  // namespace

std::vector<Lake> read_lakes(const std::string& path, std::span<const Plane> position, const std::string& crs_wkt,
                             const std::string& missing_wkt, const std::string& level_field) {
  VectorReadOptions options{VectorGeometry::polygon, crs_wkt, missing_wkt, {}};
  if (!level_field.empty()) options.fields.push_back(level_field);
  const VectorParts parts = read_vector(path, options);
  std::vector<std::uint32_t> order(position.size()), lake_of(position.size(), 0);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return position[a] < position[b]; });
  std::vector<Lake> lakes;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const std::size_t first = parts.point_begin[parts.ring_begin[part]];
    const std::size_t last = parts.point_begin[parts.ring_begin[part + 1]];
    double west = parts.point[first][0], east = west;
    for (std::size_t i = first; i < last; ++i) {
      west = std::min(west, parts.point[i][0]);
      east = std::max(east, parts.point[i][0]);
    }
    Lake lake;
    auto v = std::lower_bound(order.begin(), order.end(), west,
                              [&](std::uint32_t a, double x) { return position[a][0] < x; });
    for (; v != order.end() && position[*v][0] <= east; ++v) {
      if (!is_inside(parts, part, position[*v])) continue;
      if (lake_of[*v] != 0)
        throw Error(ErrorKind::input,
                    fmt::format("{}: features {} and {} both cover vertex {} (lakes must not overlap)", path,
                                parts.feature[lake_of[*v] - 1], parts.feature[part], *v));
      lake_of[*v] = static_cast<std::uint32_t>(part + 1);
      lake.vertex.push_back(*v);
    }
    if (!level_field.empty()) set_level(path, level_field, parts, part, lake);
    if (!lake.vertex.empty()) lakes.push_back(std::move(lake));
  }
  return lakes;
}

}  // namespace hydrotin::app
