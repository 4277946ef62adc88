#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/river_layers.h"
#include "hydrotin/river_profiles.h"
#include "store.h"

/// Heights for groups of rivers: the outputs of `embed` and `unite`.
///
/// Memory  Grows with the rivers only. Errors  Error(storage) naming the file.

namespace hydrotin {

/// A row that does not hold, in points.
struct BrokenPlace {
  RowKind kind = RowKind::flow;
  bool is_strict_part = false;
  double missing = 0;  ///< in the unit of heights
  std::vector<std::uint64_t> point;
  LatticePoint at;  ///< of its first point
  std::int32_t height = 0;
};

/// A row that leaves no room, or a vertex that moved as far as it may. Lattice units, heights as embedded.
struct LimitPlace {
  RowKind kind = RowKind::slope_limit;
  bool is_largest_change = false;
  std::int32_t change = 0;                          ///< of a largest change
  std::vector<std::array<std::int32_t, 3>> corner;  ///< x, y, z
};

/// A river edge before and after the embedding.
struct EmbeddedEdge {
  std::uint32_t edge = 0;  ///< of the network
  RiverEdgeState before{}, after{};
};

/// A vertex that the rivers move. Lattice units.
struct MovedVertex {
  std::uint64_t point = 0;
  LatticePoint position;
  std::int32_t before = 0, after = 0;
};

/// A river in the tables of Section 7.2, as far as one solution has a share in it.
struct RiverShare {
  std::uint32_t river = 0;  ///< of `name_rivers`
  RiverRow row;
};

/// Heights for some groups, solved together.
struct GroupSolution {
  std::vector<std::uint32_t> group;                           ///< ascending
  std::vector<MovedVertex> moved;                             ///< ascending by point
  std::vector<RiverShare> table;                              ///< ascending by river
  std::vector<EmbeddedEdge> edge;                             ///< ascending by (x, y)
  std::vector<LimitPlace> limit;                              ///< in (x, y) order
  std::vector<std::uint64_t> near;                            ///< points that no other solution may come near
  std::vector<std::pair<std::uint64_t, std::int32_t>> floor;  ///< least heights that valleys leave wingtips
  std::vector<BrokenPlace> broken;
  double objective = 0, bound = 0;  ///< in the unit of heights
  std::uint64_t rows = 0, columns = 0, rounds = 0, iterations = 0, clamped = 0;
  bool optimal = true;
};

void write_solutions(store::Writer& out, std::span<const GroupSolution> solutions);
[[nodiscard]] std::vector<GroupSolution> read_solutions(const store::Reader& in);

}  // namespace hydrotin
