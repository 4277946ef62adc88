#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "hydrotin/executor.h"
#include "hydrotin/river_constraints.h"
#include "hydrotin/river_network.h"

/// Embeds rivers into a terrain with the least total change of height.
///
/// Minimises sum |h - h0| over all heights that satisfy the constraints: a linear program (T7.1). Rows are added only
/// when they are violated; connected components of touched vertices are solved one by one with Clp's dual simplex, each
/// from the basis it had. A relaxation whose optimum satisfies every row is the optimum of the whole program.
///
/// Source   thesis, Theorem 7.1; displacement form and lazy rows: this project.
/// Properties
///   (1) The objective equals that of the program with all rows and all vertices, to 1e-6.
///   (2) With a quantum every height that moved is a multiple of it, and the flow and valley rows hold for the heights
///       as returned in exact arithmetic, except at the places in `broken`.
///   (3) The result does not depend on the numbering of vertices, triangles or edges: columns and rows are in (x, y)
///       order. A component depends on nothing outside it.
///   (4) Of a part of a terrain: the heights of the whole terrain, or vertices around which the part must grow.
/// Units    metres.
/// Threads  Pure: safe to call concurrently; parallel by the executor given.

namespace hydrotin {

enum class RowKind : std::uint8_t {
  flow,
  valley,
  slope_limit,
  triangle_slope,
  contiguous,
  lake,
  drainage,
  curvature,
  chain
};

[[nodiscard]] const char* name_of(RowKind kind);

struct EmbeddingOptions {
  RiverConstraints constraints;
  double quantum = 0;  ///< heights that move become multiples of it; 0 = doubles, without margin
  std::uint64_t max_iterations = 1'000'000'000;  ///< of the simplex, all components together
  std::function<bool()> stop;    ///< asked now and then, perhaps by several threads; true = end soon with what there is
  Executor executor = serially;  ///< of the components; the heights do not depend on it
  std::span<const std::uint8_t> is_complete;  ///< [n] all triangles of the vertex are there; or empty: of every vertex
};

/// A row that the heights returned do not satisfy, because it contradicts others or the limits of change.
struct BrokenRow {
  RowKind kind = RowKind::flow;
  std::vector<std::uint32_t> vertex;  ///< from, to and wingtip; or the ends of the edge; ...
  double missing = 0;                 ///< how much [m]
  bool is_strict_part = false;        ///< only what goes beyond the weak row (decline, side slope) is missing
};

struct Embedding {
  std::vector<double> height;  ///< [n]
  double objective = 0;        ///< sum |h - h0| of these heights
  double bound = 0;            ///< no heights that satisfy the rows not given up, with their margins, have less
  bool optimal = false;        ///< the program was solved to its end
  std::uint64_t rows = 0, columns = 0;  ///< of the relaxation at the end; a column per touched vertex
  std::uint32_t rounds = 0, components = 0;
  std::uint64_t iterations = 0;
  std::vector<BrokenRow> broken;                ///< in (x, y) order
  std::vector<std::uint32_t> clamped_networks;  ///< whose average slope is not positive: their decline is 0
  std::vector<std::uint32_t> touched;           ///< ascending: vertices with a column, all that moved among them
  std::vector<std::uint32_t> incomplete;  ///< ascending; not empty: the rest is void, these need all their triangles
};

/// @param rivers  edges of the terrain without fault (`check_network`).
/// Complexity: O(n + T) plus the simplex.
/// Fails: never on data; std::bad_alloc. Preconditions are asserted.
[[nodiscard]] Embedding embed_rivers(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                     const EmbeddingOptions& options);

}  // namespace hydrotin
