#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "hydrotin/triangulation.h"

/// Useful order-k Delaunay edges.
///
/// An edge is *useful* if some order-k Delaunay triangulation contains it. All edges of the Delaunay triangulation are
/// useful of order 0; this room finds the others.
///
/// Source   thesis, Definition 2.3, Lemmas 2.1 and 2.2. Lemma 2.2's walk is replaced by *pencil growth*: the circles
///          through u and s are slid away from s's left side; in this pencil the next point hit is a Delaunay neighbour
///          of a point already inside (the points below a plane induce a connected subgraph of the lifted hull). A hit
///          v that has all points inside on its right is an edge uv with s1 = s, and the legs of a useful edge are
///          useful, so that recursing on useful edges alone finds all.
/// Symbols  s1, s2 = the points of Lemma 2.1 left and right of the edge; E = edges found; k = order.
/// Properties
///   (1) Order 0 has no useful edge beyond the Delaunay edges; useful of order k implies useful of order k + 1.
///   (2) The set depends on the points only, not on their numbering (tie rule of predicates.h).
///   (3) Points added outside all deciding circles change nothing.
///   (4) An edge of order k is crossed by at most 2k - 1 Delaunay edges.
/// Threads  Pure functions; each thread has its own scratch and output.

namespace hydrotin {

inline constexpr int kMaxOrder = 20;

/// Non-Delaunay useful edges in the order in which their smaller end was asked for.
/// `content` of edge e, [content_begin[e] .. content_begin[e + 1]): first the `num_right[e]` points inside C(a, b, s1),
/// all right of ab, in the order in which circles through a and b that slide to the right hit them (s2 first); then the
/// points inside C(a, b, s2), all left of ab, in the order of circles that slide to the left (s1 first).
struct UsefulEdges {
  std::vector<VertexId> a, b;                   ///< [E] a before b in (x, y)
  std::vector<std::uint8_t> useful_order;       ///< [E] 1..k
  std::vector<std::uint8_t> num_right;          ///< [E]
  std::vector<HalfedgeId> entry;                ///< [E] the half-edge opposite a that the edge crosses first
  std::vector<std::uint32_t> content_begin{0};  ///< [E + 1]
  std::vector<VertexId> content;

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(a.size()); }
  [[nodiscard]] std::span<const VertexId> right(std::uint32_t e) const {
    return std::span(content).subspan(content_begin[e], num_right[e]);
  }
  /// Forgets all edges from number `size` on.
  void truncate(std::uint32_t size);
  /// Gives back the memory that is not in use.
  void trim();

  [[nodiscard]] std::span<const VertexId> left(std::uint32_t e) const {
    const std::uint32_t begin = content_begin[e] + num_right[e];
    return std::span(content).subspan(begin, content_begin[e + 1] - begin);
  }
};

/// A circle through u, s and p on which a decision at u rests: p right of us, or none for the open half plane right of
/// the line from u to s. All points inside it must be known.
struct DecidingCircle {
  VertexId u, s, p;
};

/// Finds the useful edges whose smaller end (in (x, y)) is u.
/// Scratch memory: 4 bytes a vertex.
class PencilGrowth {
 public:
  /// O(n).
  /// @param k       1..kMaxOrder
  /// @param window  region whose points are all known; circles inside it need no certificate
  PencilGrowth(const TriangulationView& triangulation, const VertexLinks& links, int k, const LatticeBox& window);
  ~PencilGrowth();
  PencilGrowth(const PencilGrowth&) = delete;
  PencilGrowth& operator=(const PencilGrowth&) = delete;

  /// Appends the edges of u to `edges`, and the deciding circles that may leave the window to `beyond`.
  /// Complexity: expected O(k) circle comparisons for each Delaunay neighbour and useful edge of u, each O(1).
  void grow(VertexId u, UsefulEdges& edges, std::vector<DecidingCircle>& beyond);

  /// The edges of the vertices [begin, end). Ranges may be grown concurrently, by one growth per thread, and put
  /// together by `concatenate`: the result is the same for every way of cutting.
  [[nodiscard]] UsefulEdges grow_range(VertexId begin, VertexId end, std::vector<DecidingCircle>& beyond);

 private:
  struct Impl;
  Impl* impl_;
};

/// Finds the entries anew after the triangulation was numbered anew; the links of all ends `a` are as they were.
/// O(E degree).
void locate_entries(const TriangulationView& triangulation, const VertexLinks& links, UsefulEdges& edges);

/// The window of a triangulation of all points there are.
inline constexpr LatticeBox kWholePlane{
    {std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min()},
    {std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max()}};

/// Vertices of a range worth growing at once.
inline constexpr std::uint32_t kGrowthRange = 1U << 14;

/// Puts the edges of consecutive ranges of vertices together; `parts` are freed on the way. O(E) time; memory beyond
/// the parts: one array of the result.
[[nodiscard]] UsefulEdges concatenate(std::vector<UsefulEdges> parts);

/// All useful edges of order at most k, by smaller end in vertex order. Expected O(n k^2) time, O(n k^2) memory.
[[nodiscard]] UsefulEdges useful_edges(const TriangulationView& triangulation, const VertexLinks& links, int k);

}  // namespace hydrotin
