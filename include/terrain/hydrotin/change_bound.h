#pragma once

#include <cstdint>
#include <span>

#include "hydrotin/pit_components.h"

/// A lower bound on the cost of removing all pits.
///
/// total, volume
///   Look at one level t. A piece K of {h < t} without outlet must not survive as it is in the new surface x: of K and
///   its neighbours, some vertex of K has x >= t or some neighbour has x < t, else K would still be a piece of {x < t}
///   without outlet and contain a pit. Pieces whose closed neighbourhoods are disjoint need different vertices. So the
///   sum over t of the number of pieces in a packing (times the least weight around each) is a bound. The packing: pits
///   by descending f - h claim their neighbourhoods, level by level, up to the level at which they would overflow or
///   meet another's claim.
/// max
///   x(v) >= f(v) - D if no vertex is lowered by more than D, and x(v) <= h(v) + D: D >= (f(v) - h(v)) / 2.
/// count
///   Each pit with its neighbours (the piece K at the level just above it) needs a moved vertex; a packing.
///
/// On small terrains also by moats as wide as the way out is long (level_moats.h); the better of both counts.
///
/// Source   own; f of thesis, Theorem 6.1. The pieces are the moats of dual ascent for Steiner trees.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

/// @param level      [n] of `lift`.
/// @param may_raise  false: of surfaces that raise nothing.
/// Complexity: for max a flood for each bit of the deepest pit; else O(n + sum over pits of b log b), b <= 4096
/// vertices looked at per pit; up to `kSmallTerrain` vertices about 500 n looked at.
[[nodiscard]] std::int64_t change_bound(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
                                        ChangeMeasure measure, bool may_raise = true);

}  // namespace hydrotin
