#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "polygon_program.h"

/// Dynamic programming for functions of two triangles at an edge (T, Theorem 3.4): the state of a directed edge is the
/// triangle on its left.

namespace hydrotin {

/// The vertex beyond each side of the polygon, if known: by the directed edge that has the outside on its left.
using BeyondSides = std::vector<std::optional<SurfacePoint>>;
[[nodiscard]] BeyondSides sides_beyond(const PolygonGraph& graph);

/// The score of the pair of triangles at the directed edge e whose third vertices are `left` and `right`.
[[nodiscard]] double pair_score(const PolygonGraph& graph, const PolygonOptions& options, std::uint32_t e,
                                const SurfacePoint& left, std::uint32_t right);

/// The value of a triangulation: the worst pair, or the sum over pairs. Sides count where what lies beyond is known.
[[nodiscard]] double quadrilateral_value(const PolygonGraph& graph, const PolygonOptions& options,
                                         const BeyondSides& beyond, const std::vector<std::uint32_t>& triangles);

class QuadrilateralProgram {
 public:
  /// Triangles of the best answer; false if there is none without blocked triangles.
  /// O(options per edge) for each of the T + C triangles, twice for a bottleneck.
  bool run(const PolygonGraph& graph, const PolygonOptions& options, const BeyondSides& beyond,
           const std::vector<std::uint8_t>& blocked, const std::vector<std::uint8_t>& closed,
           std::vector<std::uint32_t>& triangles);

  /// Of the last answer, as the program counts it: pairs across closed edges and slits are left out.
  [[nodiscard]] double value() const { return value_; }

 private:
  struct Rule;
  struct Value {
    double major = 0;        ///< worst pair, or sum of pairs
    std::int64_t minor = 0;  ///< edges that are not Delaunay, twice
    friend auto operator<=>(const Value&, const Value&) = default;
  };
  struct State {
    Value value;
    std::uint32_t left = kNoEdge, right = kNoEdge;  ///< options of the children
    bool possible = false;
  };
  struct Cell {
    std::uint32_t unused = 0;
  };

  bool pass(Rule& rule, const PolygonGraph& graph, const std::vector<std::uint8_t>& blocked,
            const std::vector<std::uint8_t>& closed);
  void read_back(std::uint32_t root_option, std::vector<std::uint32_t>& triangles) const;

  std::vector<State> state_;  // by option
  std::uint32_t best_ = kNoEdge;
  double value_ = 0;
};

}  // namespace hydrotin
