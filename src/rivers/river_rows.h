#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "hydrotin/river_embedding.h"
#include "terrain_links.h"

namespace hydrotin {

/// lower <= sum coefficient * d <= upper over displacements d.
struct Row {
  std::array<std::uint32_t, 4> vertex{};
  std::array<double, 4> coefficient{};
  std::uint32_t size = 0;
  RowKind kind = RowKind::flow;
  std::uint64_t key = 0;        ///< the same row has the same key; 0 = a cut, which needs none
  double lower = 0, upper = 0;  ///< without margin
  double strict = 0;            ///< how much of `lower` goes beyond the weak row
  double margin = 0;            ///< what storing the heights may cost

  [[nodiscard]] double activity(std::span<const double> d) const {
    double sum = 0;
    for (std::uint32_t i = 0; i < size; ++i) sum += coefficient[i] * d[vertex[i]];
    return sum;
  }
  /// How far d is outside, with the margin; not positive inside.
  [[nodiscard]] double violation(std::span<const double> d) const {
    const double a = activity(d);
    return std::max(lower + margin - a, a - upper + margin);
  }
};

/// All rows of the program; those of the whole terrain are made when asked for.
class RowCatalog {
 public:
  using Sink = std::function<void(const Row&)>;

  RowCatalog(const RiverTerrain& terrain, std::span<const RiverEdge> rivers, const RiverConstraints& constraints,
             double quantum);

  /// The rows of rivers, lakes and preserved edges.
  [[nodiscard]] std::span<const Row> listed() const { return listed_; }
  /// Rows that contain v; some may come several times.
  void visit(std::uint32_t v, std::span<const double> d, const Sink& sink) const;
  /// Every row of the program, save limits of slopes where nothing moved, which hold there.
  void visit_all(std::span<const double> d, const Sink& sink) const;
  /// A vertex of a river or an outlet chain.
  [[nodiscard]] bool is_river(std::uint32_t v) const { return is_river_[v] != 0; }
  [[nodiscard]] const std::vector<std::uint32_t>& clamped_networks() const { return clamped_; }
  /// Least height of each edge's drop; [R].
  [[nodiscard]] std::span<const double> decline() const { return decline_; }

 private:
  void take_declines(std::span<const RiverEdge> rivers);
  void mark_lakes();
  void add_flow_and_valley(std::span<const RiverEdge> rivers);
  void add_contiguous(std::span<const RiverEdge> rivers);
  void add_chains();
  void add_lakes();
  void add_preserved();
  void index_rows();
  void list(Row row);
  void close(Row& row, double lower, double upper) const;
  [[nodiscard]] Row valley_row(std::uint32_t a, std::uint32_t b, std::uint32_t w, double& distance) const;
  [[nodiscard]] Row way_row(std::uint32_t corner, std::uint32_t down, double share, double factor) const;
  void visit_edge(std::uint32_t a, std::uint32_t b, const Sink& sink) const;
  void visit_triangle(std::uint32_t t, const Sink& sink) const;
  void visit_cut(std::uint32_t v, std::span<const double> d, const Sink& sink) const;

  RiverTerrain terrain_;
  const RiverConstraints& constraints_;
  double quantum_;
  TerrainLinks links_;
  std::vector<std::uint8_t> is_river_;
  std::vector<std::uint32_t> lake_of_;  ///< [n] 0 = none
  std::vector<std::uint32_t> down_of_;  ///< [n] where contiguous flow is asked for; none elsewhere
  std::vector<double> decline_;
  std::vector<std::uint32_t> clamped_;
  std::vector<Row> listed_;
  std::vector<std::uint32_t> begin_, row_;  ///< listed rows of each vertex (CSR)
};

}  // namespace hydrotin
