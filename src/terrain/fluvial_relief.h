#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "hydrotin/synthetic.h"

namespace hydrotin {

/// Mountains carved by a drainage network: a coarse grid of nodes with a drainage tree, valleys along the tree's
/// rivers. Coordinates are metres from the domain's south-west corner.
class FluvialRelief {
 public:
  FluvialRelief(double side, std::uint64_t seed);

  [[nodiscard]] double height(double x, double y) const;
  /// Lines in metres from the domain's corner.
  [[nodiscard]] std::vector<SyntheticRiver> rivers() const;

 private:
  struct Position {
    double x, y;
  };
  void place_nodes();
  void drain();
  void accumulate();
  double rebuild();
  void creep();
  template <class Visit>
  void each_neighbour(std::uint32_t node, Visit&& visit) const {
    const std::uint32_t column = node % num_, row = node / num_;
    for (std::uint32_t r = row == 0 ? 0 : row - 1; r <= std::min(row + 1, num_ - 1); ++r)
      for (std::uint32_t c = column == 0 ? 0 : column - 1; c <= std::min(column + 1, num_ - 1); ++c)
        if (const std::uint32_t neighbour = r * num_ + c; neighbour != node) visit(neighbour);
  }
  void find_rivers();
  void index_rivers();
  [[nodiscard]] double bed(std::uint32_t node) const;
  [[nodiscard]] double distance(std::uint32_t a, std::uint32_t b) const;
  [[nodiscard]] double grid_height(double x, double y) const;

  double side_, spacing_, relief_, river_area_;
  std::uint64_t seed_;
  std::uint32_t num_;                       ///< nodes along one side
  std::vector<Position> position_;          ///< [num^2]
  std::vector<double> hardness_;            ///< [num^2] of the rock: factor on slopes
  std::vector<double> height_;              ///< [num^2] row by row from the south
  std::vector<std::uint32_t> receiver_;     ///< [num^2] the node it drains to; itself = outlet
  std::vector<std::uint32_t> order_;        ///< [num^2] receivers before those who drain to them
  std::vector<double> area_;                ///< [num^2] catchment [m2]
  std::vector<std::uint8_t> is_river_;      ///< [num^2]
  std::vector<std::uint32_t> reach_begin_;  ///< [cells + 1] CSR by coarse cell: river nodes whose reach passes near it
  std::vector<std::uint32_t> reach_;
};

}  // namespace hydrotin
