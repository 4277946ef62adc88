#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/lattice.h"
#include "hydrotin/pit_components.h"
#include "hydrotin/pit_edits.h"

/// The edits of pit removal as features of a map: polygons of lifted regions, lines of breaches, and the triangles
/// between the old and the new surface.
///
/// Source   thesis, Section 6.1 (regions) and Definition 6.1 (breaching path); what they are is in pit_edits.h.
/// Symbols  R = regions, B = breaches, T = triangles.
/// Properties
///   (1) Regions ascend by their smallest vertices in (x, y), breaches by their first vertices.
///   (2) The polygon of a region has the triangles that one of its vertices is a corner of.
///   (3) Nothing depends on the numbering of vertices, but for the heights of `breach_features`' own input.
/// Units    lattice units; volumes in cubed ones.
/// Threads  Pure: safe to call concurrently, no hidden parallelism.

namespace hydrotin {

/// Rings of region i: ring_begin[region_ring_begin[i] .. region_ring_begin[i + 1]], the outer ones first
/// (outline_rings.h); points of ring r: ring_xy[2 * ring_begin[r] .. 2 * ring_begin[r + 1]).
struct RegionFeatures {
  std::vector<std::int32_t> key;           ///< [2R] smallest vertex by (x, y)
  std::vector<std::int32_t> level;         ///< [R] final height
  std::vector<std::int32_t> lowest;        ///< [3R] its lowest vertex before
  std::vector<std::uint64_t> vertices;     ///< [R]
  std::vector<std::int64_t> displacement;  ///< [R]
  std::vector<double> volume;              ///< [R]
  std::vector<std::uint64_t> region_ring_begin{0};
  std::vector<std::uint64_t> ring_begin{0};
  std::vector<std::int32_t> ring_xy;

  [[nodiscard]] std::size_t size() const { return level.size(); }
};

/// Points of breach i: xyz[3 * begin[i] .. 3 * begin[i + 1]), from the pit to where it drains.
struct BreachFeatures {
  std::vector<std::int32_t> key;           ///< [2B] first vertex
  std::vector<std::int32_t> pit;           ///< [3B] smallest vertex of the pit, as measured; height kNoLevel: none
  std::vector<std::int32_t> depth;         ///< [B] the most that a vertex of it was lowered
  std::vector<std::uint64_t> lowered;      ///< [B] vertices lowered, by it or by the one that it joins
  std::vector<std::int64_t> displacement;  ///< [B]
  std::vector<double> length, volume;      ///< [B]
  std::vector<std::uint64_t> begin{0};
  std::vector<std::int32_t> xyz;  ///< new heights

  [[nodiscard]] std::size_t size() const { return depth.size(); }
};

/// @param triangle_vertex  [3T] counter-clockwise; all triangles around the vertices of the regions.
/// Complexity: O(T + n) plus the sorting of the triangles of each region; 8 bytes per vertex, 4 per corner.
[[nodiscard]] RegionFeatures region_features(const ChangeableTerrain& terrain,
                                             std::span<const std::uint32_t> triangle_vertex, const PitEdits& edits);

/// @param height  [n] new heights.
/// Complexity: O(B log B + vertices of all breaches).
[[nodiscard]] BreachFeatures breach_features(const ChangeableTerrain& terrain, const PitEdits& edits,
                                             std::span<const std::int32_t> height);

/// The triangles that pit removal moved.
///
/// @param triangle_vertex  [3T] in: all; out: those with a corner whose change is not 0, in the same order.
void keep_changed_triangles(std::span<const std::int32_t> change, std::vector<std::uint32_t>& triangle_vertex);

}  // namespace hydrotin
