#include "river_input.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "hydrotin/crs.h"
#include "hydrotin/error.h"
#include "phases.h"

namespace hydrotin {
namespace {

using Plane = std::array<double, 2>;

VectorParts read_parts(const std::string& path, VectorGeometry kind, const RiverOptions& options, const Plan& plan,
                       std::vector<std::string> fields) {
  VectorReadOptions reading;
  reading.geometry = kind;
  reading.target_wkt = plan.crs_wkt;
  if (!options.crs.empty()) reading.missing_crs_wkt = parse_crs(options.crs, "rivers.crs").wkt;
  reading.fields = std::move(fields);
  VectorParts parts = read_vector(path, reading);
  if (parts.size() == 0)
    throw Error(ErrorKind::input, path + ": has no " + (kind == VectorGeometry::line ? "line" : "polygon") + ": " +
                                      std::to_string(parts.num_features) + " features, " +
                                      std::to_string(parts.num_null) + " without geometry, " +
                                      std::to_string(parts.num_other) + " of other kinds; give another file");
  return parts;
}

void read_lines(const RiverOptions& options, const Plan& plan, RiverInput& out) {
  const bool has_direction = options.matching.direction == LineDirection::attribute;
  std::vector<std::string> fields;
  if (has_direction) fields.push_back(options.direction_field);
  if (!options.name_field.empty()) fields.push_back(options.name_field);
  out.lines_path = options.lines;
  out.lines = read_parts(options.lines, VectorGeometry::line, options, plan, fields);
  out.is_against.assign(out.lines.size(), 0);
  out.name.resize(out.lines.size());
  const auto& values = options.reversed_values;
  for (std::size_t i = 0; i < out.lines.size(); ++i) {
    const std::string* value = out.lines.value.data() + i * fields.size();
    if (has_direction) out.is_against[i] = std::find(values.begin(), values.end(), *value) != values.end() ? 1 : 0;
    if (!options.name_field.empty()) out.name[i] = value[fields.size() - 1];
  }
}

void read_lakes(const RiverOptions& options, const Plan& plan, RiverInput& out) {
  out.lakes_path = options.lakes;
  std::vector<std::string> fields;
  if (!options.lake_level_field.empty()) fields.push_back(options.lake_level_field);
  out.lakes = read_parts(options.lakes, VectorGeometry::polygon, options, plan, fields);
  out.has_level.assign(out.lakes.size(), 0);
  out.level.assign(out.lakes.size(), 0);
  for (std::size_t i = 0; i < out.lakes.size() && !fields.empty(); ++i) {
    const std::string& text = out.lakes.value[i];
    if (text.empty()) continue;
    const auto [stop, problem] = std::from_chars(text.data(), text.data() + text.size(), out.level[i]);
    if (problem != std::errc{} || stop != text.data() + text.size() || !std::isfinite(out.level[i]))
      throw Error(ErrorKind::input, options.lakes + ": feature " + std::to_string(out.lakes.feature[i]) + ": " +
                                        fields[0] + " is '" + text + "', not a height; write a number, or nothing");
    out.has_level[i] = 1;
  }
}

// Lattice units as they come, without rounding.
Plane unrounded(const Lattice& l, const std::array<double, 3>& p) {
  return {(p[0] - l.offset_x) / l.scale_xy - static_cast<double>(l.base_x),
          (p[1] - l.offset_y) / l.scale_xy - static_cast<double>(l.base_y)};
}

LatticePoint rounded(const Plane& p, const LatticeBox& reach) {
  const auto nearest = [](double x, std::int32_t low, std::int32_t high) {
    return static_cast<std::int32_t>(std::clamp(std::round(x), static_cast<double>(low), static_cast<double>(high)));
  };
  return {nearest(p[0], reach.min.x, reach.max.x), nearest(p[1], reach.min.y, reach.max.y)};
}

// The share of the way from a to b that lies in the box.
std::optional<std::pair<double, double>> inside(const Plane& a, const Plane& b, const LatticeBox& box) {
  double first = 0, last = 1;
  const Plane low = {static_cast<double>(box.min.x), static_cast<double>(box.min.y)};
  const Plane high = {static_cast<double>(box.max.x), static_cast<double>(box.max.y)};
  for (std::size_t k = 0; k < 2; ++k) {
    const double step = b[k] - a[k];
    if (step == 0) {
      if (a[k] < low[k] || a[k] > high[k]) return std::nullopt;
      continue;
    }
    const double to_low = (low[k] - a[k]) / step, to_high = (high[k] - a[k]) / step;
    first = std::max(first, std::min(to_low, to_high));
    last = std::min(last, std::max(to_low, to_high));
  }
  if (first > last) return std::nullopt;
  return std::pair(first, last);
}

void add_parts(const VectorParts& parts, RecipeHash& hash) {
  hash.add(static_cast<std::int64_t>(parts.size()));
  for (const std::size_t b : parts.ring_begin) hash.add(static_cast<std::int64_t>(b));
  for (const std::size_t b : parts.point_begin) hash.add(static_cast<std::int64_t>(b));
  for (const auto& p : parts.point) hash.add(p[0]).add(p[1]).add(p[2]);
  for (std::size_t i = 0; i < parts.size(); ++i) hash.add(parts.feature[i]).add(std::int64_t{parts.layer[i]});
}

}  // namespace

std::string hash_of(const RiverInput& input) {
  return input.hash;
}

namespace {

std::string hash_all(const RiverInput& input) {
  RecipeHash hash;
  add_parts(input.lines, hash);
  add_parts(input.lakes, hash);
  add_parts(input.preserved, hash);
  for (const std::uint8_t flag : input.is_against) hash.add(std::int64_t{flag});
  for (const std::string& name : input.name) hash.add(name);
  for (std::size_t i = 0; i < input.level.size(); ++i) hash.add(std::int64_t{input.has_level[i]}).add(input.level[i]);
  return hash.hex();
}

}  // namespace

std::shared_ptr<const RiverInput> load_river_input(const RiverOptions& options, const Plan& plan) {
  if (!options.are_given()) return nullptr;
  auto out = std::make_shared<RiverInput>();
  read_lines(options, plan, *out);
  if (!options.lakes.empty()) read_lakes(options, plan, *out);
  if (!options.preserve_edges.empty()) {
    out->preserved_path = options.preserve_edges;
    out->preserved = read_parts(options.preserve_edges, VectorGeometry::line, options, plan, {});
  }
  out->hash = hash_all(*out);
  return out;
}

RiverLines lines_on_lattice(const RiverInput& input, const Lattice& lattice, const LatticeBox& reach) {
  RiverLines out;
  std::vector<LatticePoint> chain;
  for (std::size_t i = 0; i < input.lines.size(); ++i) {
    const auto close = [&] {
      if (chain.size() > 1) out.add(chain, static_cast<std::uint32_t>(i));
      chain.clear();
    };
    const auto points = input.lines.ring(input.lines.ring_begin[i]);
    for (std::size_t p = 1; p < points.size(); ++p) {
      const Plane a = unrounded(lattice, points[p - 1]), b = unrounded(lattice, points[p]);
      const auto share = inside(a, b, reach);
      if (!share) {
        close();
        continue;
      }
      const auto at = [&](double s) {
        return rounded(s == 0 ? a : s == 1 ? b : Plane{a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])}, reach);
      };
      if (share->first > 0) close();
      if (chain.empty()) chain.push_back(at(share->first));
      chain.push_back(at(share->second));
      if (share->second < 1) close();
    }
    close();
  }
  return out;
}

std::vector<PreservedSegment> preserved_segments(const RiverInput& input, const Lattice& lattice,
                                                 const LatticeBox& box) {
  std::vector<PreservedSegment> out;
  for (std::size_t i = 0; i < input.preserved.size(); ++i) {
    const auto points = input.preserved.ring(input.preserved.ring_begin[i]);
    std::vector<LatticePoint> chain;
    for (const auto& p : points) {
      const Plane at = unrounded(lattice, p);
      // Half a unit more than the box: what rounding brings in.
      if (!(at[0] >= box.min.x - 0.5 && at[0] <= box.max.x + 0.5 && at[1] >= box.min.y - 0.5 &&
            at[1] <= box.max.y + 0.5))
        throw Error(ErrorKind::input, input.preserved_path + ": feature " + std::to_string(input.preserved.feature[i]) +
                                          ": x " + std::to_string(p[0]) + ", y " + std::to_string(p[1]) +
                                          " is outside the terrain; draw lines along its edges, from vertex to vertex");
      chain.push_back(rounded(at, box));
    }
    for (std::size_t p = 1; p < chain.size(); ++p)
      if (chain[p] != chain[p - 1])
        out.push_back({std::min(chain[p - 1], chain[p]), std::max(chain[p - 1], chain[p]), i});
  }
  return out;
}

std::vector<std::pair<LatticePoint, double>> heights_of_lines(const RiverInput& input, const Lattice& lattice,
                                                              const LatticeBox& reach) {
  std::vector<std::pair<LatticePoint, double>> out;
  for (const auto& p : input.lines.point) {
    const Plane at = unrounded(lattice, p);
    if (inside(at, at, reach)) out.emplace_back(rounded(at, reach), p[2]);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.first == b.first; }),
            out.end());
  return out;
}

}  // namespace hydrotin
