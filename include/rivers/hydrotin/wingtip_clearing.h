#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice_terrain.h"
#include "hydrotin/network_cleaning.h"

/// Makes a river network one that can be embedded: no wingtip of a river edge is a river vertex.
///
/// Where it is one, the rows of the linear program may contradict each other (Table 7.1). A triangle with two
/// consecutive river edges, and no other one at the vertex between them, gives its third edge to the river instead.
/// What is left is resolved by a Steiner point: the middle of one edge of the triangle that is no river edge (the
/// longest), which cuts the two triangles at it, without a change of the surface. Afterwards all wingtips may be raised
/// as far as need be, and strict declines and valleys are possible for every network without directed cycles.
///
/// Source   thesis, Section 7.1.2 (strict decline: Steiner point) and 7.2 (third edge); FINDINGS D6.
/// Properties
///   (1) After `clear_wingtips` no triangle at a river edge has a third vertex on a river, an outlet chain or in a
///       lake, unless it lies in one lake; but for `num_left`.
///   (2) Neither depends on any numbering: triangles come in (x, y) order.
///   (3) A third edge leaves the network without directed cycles and repeated edges.
///   (4) Steiner points lie on the lattice, at most a unit from the middle of their edge.
/// Threads  Pure.

namespace hydrotin {

/// Takes third edges until no triangle calls for one. Returns how often.
/// Complexity: O(R log R).
std::uint64_t take_third_edges(const LatticeTerrain& terrain, CleanNetwork& network);

struct ClearedWingtips {
  std::uint64_t num_points = 0;  ///< Steiner points: vertices added at the end
  std::uint64_t num_left = 0;    ///< triangles too small for one
};

/// Adds vertices and triangles to the terrain; river edges and chains stay.
/// @param chain   edges of outlet chains: their vertices may not be wingtips either.
/// @param lake    [n] or empty: 0 = in no lake, otherwise a number of the lake. A triangle in one lake is level: it
/// stays. Complexity: O(T + R log R).
ClearedWingtips clear_wingtips(LatticeTerrain& terrain, std::span<const RiverEdge> rivers,
                               std::span<const RiverEdge> chain, std::span<const std::uint32_t> lake);

}  // namespace hydrotin
