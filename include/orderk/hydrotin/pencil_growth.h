#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "hydrotin/useful_edges.h"

/// Pencil growth: finds the useful edges of single vertices, and says which circles they rest on.
///
/// Source   thesis, Lemma 2.2; its walk is replaced. The circles through u and s are slid away from s's left side; in
///          this pencil the next point hit is a Delaunay neighbour of a point already inside (the points below a plane
///          induce a connected subgraph of the lifted hull). A hit v that has all points inside on its right is an edge
///          uv with s1 = s, and the legs of a useful edge are useful, so that recursing on useful edges alone finds
///          all.
/// Threads  Each thread has its own growth and output.

namespace hydrotin {

/// A circle through u, s and p on which a decision at u rests: p right of us, or none for the open half plane right of
/// the line from u to s. All points inside it must be known.
struct DecidingCircle {
  VertexId u, s, p;
};

/// The useful edges of some vertices, in the order in which these were grown: those of vertex[i] are edges.begin[i] ..
/// edges.begin[i + 1]. The legs to the points of `edges.apex` may yet be found not to be useful.
struct GrownEdges {
  std::vector<VertexId> vertex;
  UsefulEdges edges;

  /// Forgets the vertices with a 0 in `wanted` [number of vertices].
  void keep(std::span<const std::uint8_t> wanted);
  /// Forgets all vertices and keeps the memory.
  void clear();
};

/// Finds the useful edges whose smaller end (in (x, y)) is u.
/// Scratch memory: 8 bytes a vertex.
class PencilGrowth {
 public:
  /// O(n).
  /// @param k       1..kMaxOrder
  /// @param window  region whose points are all known; circles inside it need no certificate
  PencilGrowth(const TriangulationView& triangulation, const VertexLinks& links, int k, const LatticeBox& window);
  ~PencilGrowth();
  PencilGrowth(const PencilGrowth&) = delete;
  PencilGrowth& operator=(const PencilGrowth&) = delete;

  /// Appends the edges of u to `grown`, and the deciding circles that may leave the window to `beyond`.
  /// Complexity: expected O(k) circle comparisons for each Delaunay neighbour and useful edge of u, each O(1).
  void grow(VertexId u, GrownEdges& grown, std::vector<DecidingCircle>& beyond);

 private:
  struct Impl;
  Impl* impl_;
};

/// The window of a triangulation of all points there are.
inline constexpr LatticeBox kWholePlane{
    {std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min()},
    {std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max()}};

/// Vertices worth growing at once.
inline constexpr std::uint32_t kGrowthRange = 1U << 13;

/// Puts together what was grown of different vertices; the same for every way of cutting. Vertices that were not grown
/// have no edges. O(n + E degree) time; memory beyond the parts, which are freed on the way: one array of the result.
[[nodiscard]] UsefulEdges assemble(const TriangulationView& triangulation, const VertexLinks& links,
                                   std::vector<GrownEdges> parts, const Executor& executor = serially);

/// Finds the entries anew after the triangulation was numbered anew; the links of all smaller ends are as they were.
/// O(E degree).
void locate_entries(const TriangulationView& triangulation, const VertexLinks& links, UsefulEdges& edges);

}  // namespace hydrotin
