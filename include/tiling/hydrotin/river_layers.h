#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hydrotin/river_constraints.h"
#include "hydrotin/river_embedding.h"
#include "hydrotin/river_mouths.h"
#include "hydrotin/river_statistics.h"
#include "hydrotin/vector.h"
#include "hydrotin/vector_reader.h"

/// What users see of rivers as layers and as points: the same for terrains in tiles and in memory.
///
/// Layers are opened by constructors and filled feature by feature, so that nothing is held. Vertices of a TIN in
/// memory have numbers, which some layers show; vertices of a data set in tiles have none that a tiling leaves alone.
///
/// Units    of the CRS.
/// Errors   Error(storage) from the writer.
/// Threads  An object belongs to the thread of its writer.

namespace hydrotin {

enum class VertexNumbers : std::uint8_t { hidden, shown };

/// What is wrong with a river edge.
struct RiverEdgeState {
  bool wrong_flow = false, not_valley = false, is_level = false;
};

/// That of one edge of `river_faults`.
[[nodiscard]] RiverEdgeState state_of(const RiverFaults& faults, std::size_t edge);

/// "is valid", "flows uphill, before it was no valley", ...
[[nodiscard]] std::string river_edge_status(const RiverEdgeState& before, const RiverEdgeState& after);

/// The layer `river_edges`: from and to (numbers), river, source_layer, source_feature, length, drop_before,
/// drop_after, status, valid.
class RiverEdgeLayer {
 public:
  RiverEdgeLayer(VertexNumbers numbers, GeoPackageWriter& out);

  struct Edge {
    VectorPoint from, to;  ///< final
    std::uint32_t from_vertex = 0, to_vertex = 0;
    std::string river;
    std::int64_t source_layer = -1, source_feature = -1;  ///< -1: it comes from no file of lines
    double drop_before = 0, drop_after = 0;
    RiverEdgeState before{}, after{};
    bool is_valid = false;  ///< by the constraints that were asked for
  };
  void add(const Edge& edge);

 private:
  VertexNumbers numbers_;
  GeoPackageWriter* out_;
  int layer_;
};

enum class VertexRole : std::uint8_t { terrain, lake, chain, river };

/// The layer `moved_vertices`: vertex (number), kind, before, after, change.
class MovedVertexLayer {
 public:
  MovedVertexLayer(VertexNumbers numbers, GeoPackageWriter& out);
  void add(const VectorPoint& after, std::uint32_t vertex, VertexRole role, double before);

 private:
  VertexNumbers numbers_;
  GeoPackageWriter* out_;
  int layer_;
};

/// The layers `binding_limits` (constraint, vertices) and `largest_changes` (vertex, change): rows that leave no room.
class LimitLayers {
 public:
  LimitLayers(VertexNumbers numbers, GeoPackageWriter& out);
  void add_limit(RowKind kind, std::span<const VectorPoint> points, std::span<const std::uint32_t> vertices);
  void add_largest_change(const VectorPoint& point, std::uint32_t vertex, double change);

 private:
  VertexNumbers numbers_;
  GeoPackageWriter* out_;
  int limits_, changes_;
};

/// The layer `contradictions`: constraint, missing, vertices, reason.
class ContradictionLayer {
 public:
  ContradictionLayer(VertexNumbers numbers, GeoPackageWriter& out);
  /// @param was_ended  the search came to its limit of time before all rows held.
  void add(const VectorPoint& first, RowKind kind, double missing, bool is_strict_part, bool was_ended,
           std::span<const std::uint32_t> vertices);

 private:
  VertexNumbers numbers_;
  GeoPackageWriter* out_;
  int layer_;
};

/// The layers `mouths` (vertex, kind, chain_edges, climb) and `outlet_chains` (from, to, length).
class MouthLayers {
 public:
  MouthLayers(VertexNumbers numbers, GeoPackageWriter& out);
  void add_mouth(const VectorPoint& point, std::uint32_t vertex, MouthKind kind, std::uint32_t chain_edges,
                 double climb);
  void add_chain(const VectorPoint& from, const VectorPoint& to, const RiverEdge& edge);

 private:
  VertexNumbers numbers_;
  GeoPackageWriter* out_;
  int mouths_, chains_;
};

/// What became of a line of the file of rivers.
struct UsedLine {
  std::string river;
  bool is_turned = false;         ///< water runs against the order of its points
  double drop = 0;                ///< downstream, by the terrain
  std::uint64_t river_edges = 0;  ///< that it became; 0: nothing is left of it
  bool in_circle = false, left_out_of_circle = false;
  bool rises = false;  ///< downstream, by the terrain
};

/// Marks the lines of a circle, of which the first was left out.
void mark_circle(std::span<const std::uint32_t> circle, std::span<UsedLine> lines);

/// The layers `lines` and `lines_that_rise`: source_layer, source_feature, river, turned, drop, river_edges, cycle.
class LineLayers {
 public:
  explicit LineLayers(GeoPackageWriter& out);
  /// Line i of the file.
  void add(const VectorParts& parts, std::uint32_t i, const UsedLine& line);

 private:
  GeoPackageWriter* out_;
  int all_, rising_;
};

struct RiverPoint {
  VectorPoint at;  ///< final
  std::uint32_t vertex = 0;
  double before = 0;
};

/// Steps and offsets of the integers that LAS stores.
struct PointFrame {
  std::array<double, 3> scale{0.001, 0.001, 0.001}, offset{0, 0, 0};
};

/// River vertices as points of class 2 in LAS if the name ends so, else as the layer `river_vertices` of a GeoPackage:
/// vertex (number), before.
/// Fails: Error(storage), also for points too far apart for the frame.
void write_river_points(const std::string& path, const std::string& crs_wkt, const PointFrame& frame,
                        VertexNumbers numbers, std::span<const RiverPoint> points);

}  // namespace hydrotin
