#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "hydrotin/lattice_terrain.h"
#include "hydrotin/line_walk.h"

namespace hydrotin {

/// A triangulation that takes new vertices and constrained edges, and keeps every edge that it touches locally Delaunay
/// unless it is constrained. New vertices and triangles get the next numbers; every step is decided by exact predicates
/// with the tie rule of predicates.h, so that the set of triangles does not depend on the order of the steps where the
/// terrain was a (constrained) Delaunay triangulation.
class EditableTerrain {
 public:
  explicit EditableTerrain(LatticeTerrain terrain);

  [[nodiscard]] const LatticeTerrain& terrain() const { return t_; }
  [[nodiscard]] LatticeTerrain take() { return std::move(t_); }
  [[nodiscard]] bool is_constrained(std::uint32_t h) const { return constrained_[h] != 0; }

  /// The half-edge from a to b, or from b to a where only that has a triangle; none if there is no such edge.
  [[nodiscard]] std::uint32_t find_edge(std::uint32_t a, std::uint32_t b) const;
  void constrain(std::uint32_t h);

  /// Adds p with the given height where it lies; a vertex that is there already is returned as it is. Nothing outside.
  /// @param hint  a vertex near p.
  [[nodiscard]] std::optional<std::uint32_t> insert_vertex(LatticePoint p, double height, std::uint32_t hint);

  /// Puts p in the place of an edge's inner point: the edge's two ends are joined by p, and p with the apexes. Refused
  /// (nothing happens) where a triangle would not stay counter-clockwise. No edge is flipped. On the rim p may lie
  /// outside.
  [[nodiscard]] bool can_split_edge(std::uint32_t h, LatticePoint p) const;
  std::uint32_t split_edge(std::uint32_t h, LatticePoint p, double height);
  /// Precondition: p strictly inside.
  std::uint32_t split_triangle(std::uint32_t triangle, LatticePoint p, double height);

  /// Makes the segment between two vertices a chain of constrained edges: through the vertices that lie on it, across
  /// the edges that it crosses. Appends the vertices after a to `way`. False if it leaves the terrain or meets another
  /// constrained edge: then the chain ends where that happens.
  [[nodiscard]] bool insert_segment(std::uint32_t a, std::uint32_t b, std::vector<std::uint32_t>& way);

  /// Flips from these edges on until all that is not constrained is locally Delaunay.
  void legalize(std::vector<std::uint32_t> halfedges);

  [[nodiscard]] Place locate(LatticePoint p, std::uint32_t hint) const;
  /// Half-edges with origin v.
  [[nodiscard]] std::vector<std::uint32_t> spokes(std::uint32_t v) const;

 private:
  void set_halfedge(std::uint32_t h, std::uint32_t origin, std::uint32_t twin, bool is_constrained);
  std::uint32_t add_triangle();
  void flip(std::uint32_t h);
  [[nodiscard]] bool is_flippable(std::uint32_t h) const;
  [[nodiscard]] bool cross_to(std::uint32_t a, std::uint32_t b, std::uint32_t& reached,
                              std::vector<std::array<std::uint32_t, 2>>& crossed) const;
  void clear_way(std::uint32_t a, std::uint32_t b, std::vector<std::array<std::uint32_t, 2>> crossed);
  void add_fan(std::uint32_t v, std::uint32_t start, std::vector<std::uint32_t>& spokes) const;

  LatticeTerrain t_;
  std::vector<std::uint8_t> constrained_;  ///< [3T]
  std::vector<std::uint32_t> spoke_;       ///< [n] some half-edge with this origin; kNoHalfedge: vertex of no triangle
  /// Vertices where several fans of triangles meet: half-edges of the rim with this origin, some of them outdated.
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> fans_;
};

}  // namespace hydrotin
