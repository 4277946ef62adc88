#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hydrotin/river_embedding.h"
#include "hydrotin/river_matching.h"
#include "phases.h"
#include "store.h"

/// The network of rivers on the terrain: the output of `match`.
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

}  // namespace hydrotin
