#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/pits.h"
#include "hydrotin/vertex_graph.h"
#include "hydrotin/wide.h"

/// The pits of a terrain with what it takes to fill them, nested.
///
/// Let the water rise in all pits at once. Two pools meet at a vertex, in the order (z, x, y) of all vertices, which is
/// unique: there the one with the higher bottom has overflowed, its *spill*, into the one with the lower bottom, its
/// *parent*; a pool that meets an outlet, or one that has met an outlet, has overflowed for good. The *basin* of a pit
/// is its pool at that moment without what lies at the level of the spill: the vertices that filling the pit raises. It
/// includes the basins of its children.
///
/// Source   thesis, Section 6.1 (pits and saddles of the join tree; removing a subset, all, or the cheapest m).
/// Symbols  n = vertices, E = edges, T = triangles, p = pits, s = spill level.
/// Properties
///   (1) The pits are those of `find_pits`, in the same order.
///   (2) Basins are nested or disjoint; a basin contains those of its children and no others of its size or larger.
///   (3) The lift of all pits raises the basins of the pits without parent, each vertex to the highest spill level of
///       the basins around it.
///   (4) Nothing depends on the numbering of vertices.
///   (5) For every m, lifting the m pits of the lowest `price` (ties by (height, representative)) and keeping the
///       others costs least total displacement among all choices of m pits.
/// Units    lattice units; areas doubled, so that they are integers.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

inline constexpr std::uint32_t kNoPit = 0xffffffffu;
inline constexpr std::int64_t kNoPrice = 0x7fffffffffffffff;

struct PitBasin {
  Pit pit;
  std::uint32_t parent = kNoPit;        ///< index of the pit it overflows into; kNoPit: it overflows for good
  std::uint32_t spill_vertex = kNoPit;  ///< none if the piece of terrain has no outlet: then the pit never overflows,
                                        ///< its spill level is kNoLevel and all below but the price is 0
  LatticePoint spill_position;
  std::int32_t spill_level = 0;
  std::uint64_t num_vertices = 0;  ///< of the basin
  std::int64_t displacement = 0;   ///< sum of s - h over the basin
  std::int64_t doubled_area = 0;   ///< of the water at the spill level; rounded once per triangle that is partly dry
  double volume = 0;               ///< of that water, in cubed lattice units; rounded to 1/6 once per such triangle
  std::int64_t price = 0;          ///< see property (5); kNoPrice for one pit of each piece without outlet

  [[nodiscard]] std::int64_t depth() const { return std::int64_t{spill_level} - pit.height; }
};

/// All pits, sorted by representative.
///
/// @param triangle_vertex      [3T] the triangles of the graph.
/// @param height, position, is_outlet  [n] each; positions are distinct, heights below kNoLevel.
/// Complexity: O(n log n + E alpha) time plus, for the areas and volumes, the lengths of the shore lines of all basins
/// (sum over pits of triangles that are partly dry); at its peak about 40 bytes per vertex beside the input.
/// Fails: never on data; std::bad_alloc. Preconditions are asserted.
[[nodiscard]] std::vector<PitBasin> pit_hierarchy(const VertexGraph& graph,
                                                  std::span<const std::uint32_t> triangle_vertex,
                                                  std::span<const std::int32_t> height,
                                                  std::span<const LatticePoint> position,
                                                  std::span<const std::uint8_t> is_outlet);

/// The part of a triangle under water that stands at `level`.
struct FloodedPart {
  std::int64_t doubled_area = 0;  ///< to the nearest integer; exact where the triangle is all wet or all dry
  Wide sixfold_volume = 0;        ///< likewise
};

/// @param corner  positions; doubled area below 2^62.
/// Complexity: constant. The same for every order of the corners.
[[nodiscard]] FloodedPart flooded_part(const std::array<LatticePoint, 3>& corner, std::array<std::int32_t, 3> height,
                                       std::int32_t level);

}  // namespace hydrotin
