#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hydrotin/executor.h"
#include "hydrotin/triangulation.h"

/// Useful order-k Delaunay edges.
///
/// An edge is *useful* if some order-k Delaunay triangulation contains it. All edges of the Delaunay triangulation are
/// useful of order 0; this room finds the others.
///
/// Source   thesis, Definition 2.3, Lemmas 2.1 and 2.2; found by pencil growth (pencil_growth.h).
/// Symbols  s1, s2 = the points of Lemma 2.1 left and right of the edge ab; E = edges found; k = order.
/// Properties
///   (1) Order 0 has no useful edge beyond the Delaunay edges; useful of order k implies useful of order k + 1.
///   (2) The set depends on the points only, not on their numbering (tie rule of predicates.h).
///   (3) Points added outside all deciding circles change nothing.
///   (4) An edge of order k is crossed by at most 2k - 1 Delaunay edges.
/// Threads  Pure functions.

namespace hydrotin {

inline constexpr int kMaxOrder = 20;

/// A point other than s1 and s2 with which an edge makes an order-k triangle of three useful edges.
struct Apex {
  std::uint32_t edge;
  VertexId point;
  std::uint8_t order;  ///< of the triangle
  bool is_right;       ///< of ab

  friend bool operator==(const Apex&, const Apex&) = default;
};

/// Non-Delaunay useful edges ab with a before b in (x, y): those of a = v are begin[v] .. begin[v + 1].
struct UsefulEdges {
  std::vector<std::uint32_t> begin{0};  ///< [n + 1]
  std::vector<VertexId> b;              ///< [E]
  std::vector<VertexId> left, right;    ///< [E] s1 and s2
  std::vector<std::uint8_t> num_left;   ///< [E] points left of ab inside C(a, b, s2): 1..k
  std::vector<std::uint8_t> num_right;  ///< [E] points right of ab inside C(a, b, s1): 1..k
  std::vector<HalfedgeId> entry;        ///< [E] the half-edge opposite a that the edge crosses first
  std::vector<Apex> apex;               ///< by edge

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(b.size()); }
  [[nodiscard]] std::uint8_t useful_order(std::uint32_t e) const { return std::max(num_left[e], num_right[e]); }
  /// The smaller end of edge e. The triangulation is the one that `entry` belongs to.
  [[nodiscard]] VertexId a(const TriangulationView& triangulation, std::uint32_t e) const {
    return triangulation.apex(entry[e]);
  }
  /// The apexes of edge e.
  [[nodiscard]] std::span<const Apex> apexes(std::uint32_t e) const;

  static constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);
  /// The number of the edge ab, or kNone. O(edges of a). Precondition: a before b in (x, y).
  [[nodiscard]] std::uint32_t find(VertexId a, VertexId b) const;

  /// Takes the apexes, in any order, and makes them ready for `apexes`.
  void set_apexes(std::vector<Apex> apexes);

 private:
  static constexpr std::uint32_t kBlock = 16;
  std::vector<std::uint32_t> apex_begin_;  // of blocks of edges
};

/// The number of the non-Delaunay useful edge between p and q, or UsefulEdges::kNone.
[[nodiscard]] inline std::uint32_t find_edge(const TriangulationView& triangulation, const UsefulEdges& edges,
                                             VertexId p, VertexId q) {
  return triangulation.position[p] < triangulation.position[q] ? edges.find(p, q) : edges.find(q, p);
}

/// All useful edges of order at most k, 0..kMaxOrder. Expected O(n k^2) time, O(n k) memory.
[[nodiscard]] UsefulEdges useful_edges(const TriangulationView& triangulation, const VertexLinks& links, int k,
                                       const Executor& executor = serially);

}  // namespace hydrotin
