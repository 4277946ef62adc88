#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "hydrotin/river_embedding.h"
#include "hydrotin/river_layers.h"
#include "hydrotin/river_matching.h"
#include "hydrotin/river_profiles.h"
#include "phases.h"
#include "store.h"

/// What rivers make of the terrain: the outputs of `match`, `embed` and `unite`.
///
/// Memory  Grows with the rivers only. Errors  Error(storage) naming the file.
/// Symbols  V = vertices listed, M = new vertices, R = river edges, C = edges of outlet chains, G = groups.

namespace hydrotin {

/// A triangle or hull edge that comes or goes, and whose part it is in.
template <std::size_t N>
struct PatchItem {
  std::uint32_t tile = 0;
  std::array<std::uint32_t, N> vertex{};  ///< listed vertices, counter-clockwise, the smallest first (triangles)
  friend auto operator<=>(const PatchItem&, const PatchItem&) = default;
};

/// The items of a tile.
template <std::size_t N>
[[nodiscard]] auto items_of(const std::vector<PatchItem<N>>& items, std::uint32_t tile) {
  return std::equal_range(items.begin(), items.end(), PatchItem<N>{tile, {}},
                          [](const auto& a, const auto& b) { return a.tile < b.tile; });
}

/// The network on the terrain, and the triangles that change for it.
struct RiverNetwork {
  std::vector<LatticeBox> bounds;        ///< [tiles] of the parts before the rivers
  std::vector<std::uint64_t> point;      ///< [V] ascending; new vertices are points of the tile number num_tiles
  std::vector<LatticePoint> position;    ///< [V]
  std::vector<std::int32_t> height;      ///< [V] as measured; of new vertices as interpolated
  std::uint32_t num_new = 0;             ///< M: the last vertices listed
  std::vector<PatchItem<3>> gone, come;  ///< triangles, ascending
  std::vector<PatchItem<2>> hull_gone, hull_come;
  std::vector<RiverEdge> river;            ///< [R] listed vertices
  std::vector<std::uint32_t> line;         ///< [R] of the lines of the file
  std::vector<std::uint32_t> river_group;  ///< [R]
  std::vector<RiverEdge> chain;            ///< [C]
  std::vector<std::uint32_t> chain_group;  ///< [C]
  std::vector<Lake> lake;                  ///< of listed vertices; levels in z lattice units
  std::vector<std::uint32_t> lake_group;
  std::vector<std::uint32_t> group_tile;  ///< [G] who solves the group
  StepCounts counts;
  std::vector<std::uint8_t> is_turned;                       ///< [lines of the file]
  std::vector<double> drop;                                  ///< [lines of the file] downstream, z lattice units
  std::vector<std::uint32_t> disagrees, cycle_begin, cycle;  ///< lines; cycles as CSR
  std::vector<std::uint32_t> mouth;                          ///< listed vertices
  std::vector<std::uint8_t> mouth_kind;                      ///< MouthKind
  std::vector<std::uint32_t> mouth_length;                   ///< edges of its chain
  std::vector<double> mouth_climb;                           ///< z lattice units
  std::vector<RiverEdge> preserved;   ///< listed vertices: edges whose type must not change; ascending
  std::vector<std::uint32_t> outlet;  ///< listed vertices: closed mouths, and lakes that no river leaves

  [[nodiscard]] std::uint32_t num_vertices() const { return static_cast<std::uint32_t>(point.size()); }
  [[nodiscard]] std::uint32_t num_groups() const { return static_cast<std::uint32_t>(group_tile.size()); }
};

/// River edges as rivers: by the name of their line, or by their network where there is none.
struct RiverNames {
  std::vector<std::uint32_t> river;  ///< [R]
  std::vector<std::string> name;     ///< [rivers] names first, ascending; then networks by their smallest vertex
};
[[nodiscard]] RiverNames name_rivers(const RunContext& context, const RiverNetwork& network);

void write_network(store::Writer& out, const RiverNetwork& network);
[[nodiscard]] RiverNetwork read_network(const RunContext& context);

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

/// What the step against pits has to leave alone.
struct RiverBound {
  bool is_way = false;  ///< of a river, a chain or a lake: it may rise with the water only
  std::int32_t lower = std::numeric_limits<std::int32_t>::min();  ///< a valley needs it at least so high
};

/// All that later phases need.
struct EmbeddedRivers {
  std::unordered_map<std::uint64_t, RiverBound> bound;  ///< by point
  RiverNetwork network;
  std::vector<GroupSolution> solution;                                ///< without `near`
  std::vector<std::pair<std::uint64_t, std::int32_t>> moved;          ///< ascending by point, heights that differ
  std::vector<std::uint64_t> outlet;                                  ///< ascending, besides those of the policy
  std::vector<std::pair<std::uint64_t, std::uint64_t>> edge;          ///< river edges, ascending: from, to
  std::vector<std::pair<std::uint64_t, std::uint64_t>> contradicted;  ///< of them: no heights make them valid
};

[[nodiscard]] std::shared_ptr<const EmbeddedRivers> load_embedded_rivers(const RunContext& context);

}  // namespace hydrotin
