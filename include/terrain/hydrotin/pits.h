#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/vertex_graph.h"

/// Pits: local minima of a terrain that are no outlets, a plateau counting as one.
///
/// A plateau is a maximal connected set of vertices of one height. It is a pit if none of its vertices is an outlet or
/// has a lower neighbour. (So a vertex of no triangle is a pit: do not hand in vertices that the terrain does not use.)
///
/// Source   thesis, Section 6.1, definition of (local) minimum; outlets instead of its single global minimum.
/// Properties
///   (1) Two vertices of one plateau are joined by edges of the plateau; a pit is named by its vertex smallest by (x,
///   y). (2) Lists are sorted by that position: they do not depend on any numbering. (3) Cut into parts that share
///   their rim vertices, each edge in some part: the pits decided in the parts
///       (`PlateauSummary::pit`) and those of `resolve_plateaus` together are the pits of the whole, each once.
/// Units    lattice units.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

struct Pit {
  LatticePoint representative;     ///< smallest by (x, y) of its vertices
  std::uint64_t vertex = 0;        ///< its id: local from `find_pits`, global from the others
  std::int32_t height = 0;         ///< of all its vertices
  std::uint64_t num_vertices = 0;  ///< of the whole plateau
  friend constexpr auto operator<=>(const Pit&, const Pit&) = default;
};

/// The pits of a whole terrain, sorted by representative.
///
/// @param height, position, is_outlet  [n] each; positions are distinct.
/// Complexity: O(n + E + p log p), p = pits.
/// Fails: never on data; std::bad_alloc. Preconditions are asserted.
[[nodiscard]] std::vector<Pit> find_pits(const VertexGraph& graph, std::span<const std::int32_t> height,
                                         std::span<const LatticePoint> position,
                                         std::span<const std::uint8_t> is_outlet);

/// Only their number: no list is made, positions are not needed.
[[nodiscard]] std::uint64_t count_pits(const VertexGraph& graph, std::span<const std::int32_t> height,
                                       std::span<const std::uint8_t> is_outlet);

/// What one part of a terrain knows about plateaus. Those without a rim vertex are decided; those with one stay open:
/// open plateau i has the rim vertices rim_vertex[rim_begin[i] .. rim_begin[i + 1]). P = open plateaus.
struct PlateauSummary {
  std::vector<Pit> pit;                      ///< decided pits, sorted by representative
  std::vector<LatticePoint> representative;  ///< [P] smallest by (x, y) of the plateau's vertices in this part
  std::vector<std::uint64_t> vertex;         ///< [P] its global id
  std::vector<std::int32_t> height;          ///< [P]
  std::vector<std::uint32_t> num_inner;      ///< [P] vertices of this part that are not on the rim
  std::vector<std::uint8_t> drains;          ///< [P] nonzero: has an outlet or a lower neighbour in this part
  std::vector<std::uint32_t> rim_begin;      ///< [P + 1]
  std::vector<std::uint64_t> rim_vertex;     ///< global ids; every rim vertex of the part once

  [[nodiscard]] std::size_t num_open() const { return height.size(); }
};

/// Plateaus of one part of a terrain.
///
/// @param global_id  [n] ids by which parts recognise each other's vertices.
/// @param is_rim     [n] nonzero where another part may have the vertex as well. Too many flags cost memory only.
/// Complexity: O(n + E + p log p).
/// Fails: never on data; std::bad_alloc. Preconditions are asserted.
[[nodiscard]] PlateauSummary summarize_plateaus(const VertexGraph& graph, std::span<const std::int32_t> height,
                                                std::span<const LatticePoint> position,
                                                std::span<const std::uint8_t> is_outlet,
                                                std::span<const std::uint64_t> global_id,
                                                std::span<const std::uint8_t> is_rim);

/// The pits among the open plateaus of all parts, sorted by representative.
///
/// Plateaus that share a rim vertex are one plateau of the whole; it is a pit if no part saw it drain.
/// Complexity: O(R) with a radix sort, R = rim vertices of all parts together; 30 bytes each.
/// Fails: never on data; std::bad_alloc.
[[nodiscard]] std::vector<Pit> resolve_plateaus(std::span<const PlateauSummary> parts);

}  // namespace hydrotin
