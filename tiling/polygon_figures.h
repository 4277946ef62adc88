#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "hydrotin/exact_sum.h"
#include "hydrotin/options.h"
#include "hydrotin/polygon.h"
#include "phases.h"
#include "store.h"

/// What units say of the polygons that they solved, so that it can be added up in any order.
///
/// Properties
///   (1) The sum over all units does not depend on the tiling: counts, maxima and exact sums only.

namespace hydrotin {

[[nodiscard]] bool counts_minima(const Objectives& objectives);

/// What every solver of a run is asked. Fails: Error(config) if the limit on errors is too large for the lattice.
[[nodiscard]] PolygonOptions polygon_options(const RunContext& context);

/// Vertical errors of reference points, as figures of a file; `within_limit` is not among them.
void write_errors(store::Writer& out, const std::string& prefix, const TriangleError& errors);
[[nodiscard]] TriangleError read_errors(const store::Reader& in, const std::string& prefix);

struct PolygonFigures {
  /// Bucket of a polygon of so many Delaunay triangles: 1, 2, 3-4, 5-8, 9-16, ...
  static constexpr std::size_t kNumSizes = 33;
  [[nodiscard]] static std::size_t bucket_of(std::uint32_t size) {
    return static_cast<std::size_t>(std::bit_width(size - 1));
  }

  std::uint64_t polygons = 0, components = 0, max_components = 0, max_polygon = 0;
  std::array<std::uint64_t, kNumSizes> sizes{};  ///< polygons by bucket
  std::uint64_t fallbacks = 0, limit_missed = 0, not_optimal = 0, max_order = 0;
  ExactSum gap;                                             ///< first objective a sum
  double bound = -std::numeric_limits<double>::infinity();  ///< first objective a bottleneck: of its score
  TriangleError error;                                      ///< of the reference points under the answers

  /// A polygon's form.
  void add(std::uint32_t size, std::uint32_t num_components);
  /// A polygon's answer.
  void add(const PolygonResult& result);
  void add(const PolygonFigures& other);
  friend bool operator==(const PolygonFigures&, const PolygonFigures&) = default;
};

void write_figures(store::Writer& out, const PolygonFigures& figures);
[[nodiscard]] PolygonFigures read_figures(const store::Reader& in);

/// Judgements of single polygons, as flat arrays `result_*`.
class ResultTable {
 public:
  ResultTable() = default;
  explicit ResultTable(const store::Reader& in);  ///< Fails: Error(storage) if the arrays differ in length

  void add(const PolygonResult& result);
  void append(const ResultTable& other);
  void write(store::Writer& out) const;
  [[nodiscard]] std::size_t size() const { return max_order_.size(); }
  /// What `PolygonFigures` needs of the result; the rest is as by default.
  [[nodiscard]] PolygonResult operator[](std::size_t i) const;

 private:
  std::vector<std::uint32_t> max_order_;
  std::vector<std::uint8_t> flags_;
  std::vector<double> gap_, bound_;
  std::vector<TriangleError> error_;
};

}  // namespace hydrotin
