#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/drainage_problem.h"
#include "hydrotin/pit_components.h"

/// What pit removal did, edit by edit, for people who want to see it.
///
/// A *lifted region* is a connected set of raised vertices that came to one level: a pool. A *breach* is a chain of
/// vertices along which water now flows, from the bottom of a pit (or from the first lowered vertex of a chain that
/// starts at none) over all lowered vertices that follow to the vertex where it drains by itself or joins another
/// breach. Breaches are followed pit by pit, ascending by (height, x, y), so the lowest owns the trunk.
///
/// Source   thesis, Definitions 6.1 and 6.2 (breaching path and graph); regions of Section 6.1.
/// Properties
///   (1) Each raised vertex is in one region, each lowered one is an inner vertex of one breach.
///   (2) Along a breach the new heights never rise.
///   (3) The displacements of regions and breaches sum up to the total displacement.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

struct LiftedRegion {
  std::int32_t level = 0;         ///< final height of all its vertices
  std::uint32_t lowest = 0;       ///< vertex, smallest by (height, x, y) before
  std::int64_t displacement = 0;  ///< sum of level - height
  double volume = 0;  ///< of the space between old and new surface if only this region moved [cubed lattice units]
};

struct Breach {
  std::uint32_t pit = kNoVertexNumber;  ///< smallest vertex of its plateau by (x, y); none: the chain starts at no pit
  std::int64_t displacement = 0;        ///< sum of height - new height over its inner lowered vertices
  std::int32_t max_depth = 0;           ///< the largest of them
  double length = 0;                    ///< [lattice units], horizontally
  double volume = 0;
};

/// Lists as CSR: vertices of region i are region_vertex[region_begin[i] .. region_begin[i + 1]), and so on.
struct PitEdits {
  std::vector<LiftedRegion> region;          ///< [R] component by component, then by smallest vertex
  std::vector<std::uint32_t> region_begin;   ///< [R + 1]
  std::vector<std::uint32_t> region_vertex;  ///< ascending by (x, y)
  std::vector<Breach> breach;                ///< [B]
  std::vector<std::uint32_t> breach_begin;   ///< [B + 1]
  std::vector<std::uint32_t> breach_vertex;  ///< from the pit to where it drains
};

/// The edits of one component. Vertices are members; a breach that leaves the component ends with its last member, and
/// `leaves[i]` is nonzero. Lengths and volumes are left at 0.
struct ProblemEdits {
  PitEdits edits;
  std::vector<std::uint8_t> leaves;  ///< [B]
};

/// @param surface  [k], drains.
/// Complexity: O((k + e) log k).
[[nodiscard]] ProblemEdits find_problem_edits(const DrainageProblem& problem, std::span<const std::int32_t> surface);

/// The edits of a whole terrain, by vertices of the terrain; a breach that leaves its component ends with the neighbour
/// outside that it drains to.
///
/// @param height  [n] new heights, made from these components.
/// @param star    [n] doubled areas of the stars (`star_weights`), or empty: volumes are 0.
/// Complexity: O(n + M log M), M = members.
[[nodiscard]] PitEdits find_edits(const ChangeableTerrain& terrain, const PitComponents& components,
                                  std::span<const std::int32_t> height, std::span<const std::int64_t> star);

}  // namespace hydrotin
