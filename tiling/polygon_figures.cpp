#include "polygon_figures.h"

#include <algorithm>
#include <cmath>

namespace hydrotin {
namespace {

constexpr std::uint8_t kFellBack = 1, kLimitMissed = 2, kNotOptimal = 4;

Error damaged(const std::string& path) {
  return {ErrorKind::storage, path + ": its figures of polygons contradict each other; delete the file and run again"};
}

}  // namespace

bool counts_minima(const Objectives& objectives) {
  return std::find(objectives.begin(), objectives.end(), Objective::local_minima) != objectives.end();
}

PolygonOptions polygon_options(const RunContext& context) {
  const TriangulationOptions& options = context.options.triangulation;
  PolygonOptions out{.objectives = options.objectives, .budget = options.budget};
  if (!options.max_error_m) return out;
  const double millionths = std::round(*options.max_error_m / context.plan.lattice.scale_z * 1e6);
  if (!(millionths < 2e15))
    throw Error(ErrorKind::config, "triangulation.max_error_m: " + std::to_string(*options.max_error_m) +
                                       " is more than any error can be; lower it or leave it out");
  out.max_error = ErrorLimit{static_cast<std::int64_t>(millionths)};
  return out;
}

void write_errors(store::Writer& out, const std::string& prefix, const TriangleError& errors) {
  out.set(prefix + "squared_high", errors.squared.high());
  out.set(prefix + "squared_low", static_cast<std::int64_t>(errors.squared.low()));
  out.set(prefix + "absolute_high", errors.absolute.high());
  out.set(prefix + "absolute_low", static_cast<std::int64_t>(errors.absolute.low()));
  out.set(prefix + "largest", errors.largest);
}

TriangleError read_errors(const store::Reader& in, const std::string& prefix) {
  const auto sum = [&](const std::string& key) {
    return ExactSum(in.integer(prefix + key + "_high"), static_cast<std::uint64_t>(in.integer(prefix + key + "_low")));
  };
  return {sum("squared"), sum("absolute"), in.real(prefix + "largest")};
}

void PolygonFigures::add(std::uint32_t size, std::uint32_t num_components) {
  ++polygons;
  ++sizes[bucket_of(size)];
  components += num_components;
  max_components = std::max<std::uint64_t>(max_components, num_components);
  max_polygon = std::max<std::uint64_t>(max_polygon, size);
}

void PolygonFigures::add(const PolygonResult& result) {
  fallbacks += result.fell_back;
  limit_missed += result.limit_missed;
  not_optimal += !result.optimal;
  max_order = std::max<std::uint64_t>(max_order, result.max_order);
  gap.add(result.gap);
  bound = std::max(bound, result.bound);
  error.add(result.error);
}

void PolygonFigures::add(const PolygonFigures& other) {
  polygons += other.polygons;
  components += other.components;
  max_components = std::max(max_components, other.max_components);
  max_polygon = std::max(max_polygon, other.max_polygon);
  for (std::size_t b = 0; b < kNumSizes; ++b) sizes[b] += other.sizes[b];
  fallbacks += other.fallbacks;
  limit_missed += other.limit_missed;
  not_optimal += other.not_optimal;
  max_order = std::max(max_order, other.max_order);
  gap.add(other.gap);
  bound = std::max(bound, other.bound);
  error.add(other.error);
}

void write_figures(store::Writer& out, const PolygonFigures& figures) {
  for (const auto& [key, value] : {std::pair{"polygons", figures.polygons},
                                   {"components", figures.components},
                                   {"max_components", figures.max_components},
                                   {"max_polygon", figures.max_polygon},
                                   {"fallbacks", figures.fallbacks},
                                   {"limit_missed", figures.limit_missed},
                                   {"not_optimal", figures.not_optimal},
                                   {"max_order", figures.max_order}})
    out.set(key, static_cast<std::int64_t>(value));
  out.set("gap_high", figures.gap.high());
  out.set("gap_low", static_cast<std::int64_t>(figures.gap.low()));
  out.set("bound", figures.bound);
  write_errors(out, "error_", figures.error);
  out.append("polygon_sizes", std::vector<std::uint64_t>(figures.sizes.begin(), figures.sizes.end()),
             "polygons of 1, 2, 3-4, 5-8, ... Delaunay triangles");
}

PolygonFigures read_figures(const store::Reader& in) {
  PolygonFigures figures;
  const auto count = [&](const char* key) { return static_cast<std::uint64_t>(in.integer(key)); };
  figures.polygons = count("polygons");
  figures.components = count("components");
  figures.max_components = count("max_components");
  figures.max_polygon = count("max_polygon");
  figures.fallbacks = count("fallbacks");
  figures.limit_missed = count("limit_missed");
  figures.not_optimal = count("not_optimal");
  figures.max_order = count("max_order");
  figures.gap = ExactSum(in.integer("gap_high"), count("gap_low"));
  figures.bound = in.real("bound");
  figures.error = read_errors(in, "error_");
  const auto sizes = in.read<std::uint64_t>("polygon_sizes");
  if (sizes.size() != PolygonFigures::kNumSizes) throw damaged(in.path());
  std::copy(sizes.begin(), sizes.end(), figures.sizes.begin());
  return figures;
}

ResultTable::ResultTable(const store::Reader& in)
    : max_order_(in.read<std::uint32_t>("result_max_order")),
      flags_(in.read<std::uint8_t>("result_flags")),
      gap_(in.read<double>("result_gap")),
      bound_(in.read<double>("result_bound")) {
  const auto sums = [&](const std::string& key) {
    const auto high = in.read<std::int64_t>(key + "_high");
    const auto low = in.read<std::uint64_t>(key + "_low");
    if (high.size() != size() || low.size() != size()) throw damaged(in.path());
    std::vector<ExactSum> out;
    for (std::size_t i = 0; i < size(); ++i) out.emplace_back(high[i], low[i]);
    return out;
  };
  const auto squared = sums("result_squared"), absolute = sums("result_absolute");
  const auto largest = in.read<double>("result_largest");
  if (flags_.size() != size() || gap_.size() != size() || bound_.size() != size() || largest.size() != size())
    throw damaged(in.path());
  for (std::size_t i = 0; i < size(); ++i)
    error_.push_back({.squared = squared[i], .absolute = absolute[i], .largest = largest[i]});
}

void ResultTable::add(const PolygonResult& result) {
  max_order_.push_back(result.max_order);
  flags_.push_back(static_cast<std::uint8_t>((result.fell_back ? kFellBack : 0) |
                                             (result.limit_missed ? kLimitMissed : 0) |
                                             (result.optimal ? 0 : kNotOptimal)));
  gap_.push_back(result.gap);
  bound_.push_back(result.bound);
  error_.push_back(result.error);
}

void ResultTable::append(const ResultTable& other) {
  max_order_.insert(max_order_.end(), other.max_order_.begin(), other.max_order_.end());
  flags_.insert(flags_.end(), other.flags_.begin(), other.flags_.end());
  gap_.insert(gap_.end(), other.gap_.begin(), other.gap_.end());
  bound_.insert(bound_.end(), other.bound_.begin(), other.bound_.end());
  error_.insert(error_.end(), other.error_.begin(), other.error_.end());
}

void ResultTable::write(store::Writer& out) const {
  out.append("result_max_order", max_order_, "highest order of a triangle of each polygon's answer");
  out.append("result_flags", flags_, "1: fell back, 2: misses the limit on errors, 4: not proven to be optimal");
  out.append("result_gap", gap_, "at most so much above the optimum, if the first objective is a sum");
  out.append("result_bound", bound_, "no answer has a smaller score, if the first objective is a bottleneck");
  const auto write_sums = [&](const std::string& key, ExactSum TriangleError::*sum, const std::string& what) {
    std::vector<std::int64_t> high;
    std::vector<std::uint64_t> low;
    for (const TriangleError& error : error_) {
      high.push_back((error.*sum).high());
      low.push_back((error.*sum).low());
    }
    out.append(key + "_high", high, what + ": high half, in units of 2^-40");
    out.append(key + "_low", low, what + ": low half");
  };
  write_sums("result_squared", &TriangleError::squared, "errors of the reference points, sum of squares");
  write_sums("result_absolute", &TriangleError::absolute, "errors of the reference points, sum of absolute values");
  std::vector<double> largest;
  for (const TriangleError& error : error_) largest.push_back(error.largest);
  out.append("result_largest", largest, "largest absolute value");
}

PolygonResult ResultTable::operator[](std::size_t i) const {
  PolygonResult result;
  result.max_order = max_order_[i];
  result.fell_back = (flags_[i] & kFellBack) != 0;
  result.limit_missed = (flags_[i] & kLimitMissed) != 0;
  result.optimal = (flags_[i] & kNotOptimal) == 0;
  result.gap = gap_[i];
  result.bound = bound_[i];
  result.error = error_[i];
  return result;
}

}  // namespace hydrotin
