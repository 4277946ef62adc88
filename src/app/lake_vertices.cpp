#include "lake_vertices.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "hydrotin/error.h"
#include "hydrotin/river_matching.h"
#include "hydrotin/vector_reader.h"

namespace hydrotin::app {
namespace {

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

std::vector<Lake> read_lakes(const std::string& path, std::span<const std::array<double, 2>> position,
                             const std::string& crs_wkt, const std::string& missing_wkt,
                             const std::string& level_field) {
  VectorReadOptions options{VectorGeometry::polygon, crs_wkt, missing_wkt, {}};
  if (!level_field.empty()) options.fields.push_back(level_field);
  const VectorParts parts = read_vector(path, options);
  CoveredVertices covered = vertices_in({parts.ring_begin, parts.point_begin, parts.point}, position);
  if (covered.overlaps)
    throw Error(ErrorKind::input,
                fmt::format("{}: features {} and {} both cover vertex {} (lakes must not overlap)", path,
                            parts.feature[covered.first], parts.feature[covered.second], covered.overlap));
  std::vector<Lake> lakes;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    Lake lake;
    lake.vertex = std::move(covered.vertex[part]);
    if (!level_field.empty()) set_level(path, level_field, parts, part, lake);
    if (!lake.vertex.empty()) lakes.push_back(std::move(lake));
  }
  return lakes;
}

}  // namespace hydrotin::app
