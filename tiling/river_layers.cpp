#include "hydrotin/river_layers.h"

#include <algorithm>
#include <cmath>

#include "hydrotin/error.h"
#include "hydrotin/las_writer.h"

namespace hydrotin {
namespace {

using Fields = std::vector<VectorField>;
using Values = std::vector<FieldValue>;

// Columns of vertex numbers come first, or not at all.
Fields fields_of(VertexNumbers numbers, Fields shown, const Fields& always) {
  if (numbers == VertexNumbers::hidden) shown.clear();
  shown.insert(shown.end(), always.begin(), always.end());
  return shown;
}

Values values_of(VertexNumbers numbers, Values shown, const Values& always) {
  if (numbers == VertexNumbers::hidden) shown.clear();
  shown.insert(shown.end(), always.begin(), always.end());
  return shown;
}

std::string listed(std::span<const std::uint32_t> vertices) {
  std::string out;
  for (const std::uint32_t v : vertices) out.append(out.empty() ? "" : " ").append(std::to_string(v));
  return out;
}

double length_of(const VectorPoint& a, const VectorPoint& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

std::string text_of(const RiverEdgeState& state) {
  if (state.wrong_flow) return state.not_valley ? "flows uphill and is no valley" : "flows uphill";
  if (state.not_valley) return "is no valley";
  return state.is_level ? "is level" : "is valid";
}

void write_las(const std::string& path, const std::string& crs_wkt, const PointFrame& frame,
               std::span<const RiverPoint> points) {
  LasWriterOptions options;
  options.scale = frame.scale;
  options.offset = frame.offset;
  options.crs = crs_wkt;
  std::array<std::vector<std::int32_t>, 3> columns;
  for (const RiverPoint& point : points) {
    const std::array<double, 3> at{point.at.x, point.at.y, point.at.z};
    for (std::size_t i = 0; i < 3; ++i) {
      const double scaled = std::round((at[i] - frame.offset[i]) / frame.scale[i]);
      if (!(std::abs(scaled) <= 2147483000.0))
        throw Error(ErrorKind::storage, path + ": the rivers are too far apart for the integers of LAS (write GPKG)");
      columns[i].push_back(static_cast<std::int32_t>(scaled));
    }
  }
  const std::vector<std::uint8_t> ground(points.size(), 2);
  LasPoints out;
  out.x = columns[0];
  out.y = columns[1];
  out.z = columns[2];
  out.classification = ground;
  LasWriter writer(path, options);
  writer.write(out);
  writer.close();
}

}  // namespace

RiverEdgeState state_of(const RiverFaults& faults, std::size_t edge) {
  return {faults.wrong_flow[edge] != 0, faults.not_valley[edge] != 0, faults.flat[edge] != 0};
}

std::string river_edge_status(const RiverEdgeState& before, const RiverEdgeState& after) {
  const std::string then = text_of(before), now = text_of(after);
  return then == now ? now : now + ", before it " + (then.starts_with("is") ? "was" + then.substr(2) : then);
}

RiverEdgeLayer::RiverEdgeLayer(VertexNumbers numbers, GeoPackageWriter& out)
    : numbers_(numbers),
      out_(&out),
      layer_(out.add_layer("river_edges", VectorGeometry::line, true,
                           fields_of(numbers, {{"from", FieldType::integer}, {"to", FieldType::integer}},
                                     {{"river", FieldType::text},
                                      {"source_layer", FieldType::integer},
                                      {"source_feature", FieldType::integer},
                                      {"length", FieldType::real},
                                      {"drop_before", FieldType::real},
                                      {"drop_after", FieldType::real},
                                      {"status", FieldType::text},
                                      {"valid", FieldType::integer}}))) {}

void RiverEdgeLayer::add(const Edge& edge) {
  out_->add_line(
      layer_, std::array{edge.from, edge.to},
      values_of(numbers_, {std::int64_t{edge.from_vertex}, std::int64_t{edge.to_vertex}},
                {edge.river, edge.source_layer, edge.source_feature, length_of(edge.from, edge.to), edge.drop_before,
                 edge.drop_after, river_edge_status(edge.before, edge.after), std::int64_t{edge.is_valid ? 1 : 0}}));
}

MovedVertexLayer::MovedVertexLayer(VertexNumbers numbers, GeoPackageWriter& out)
    : numbers_(numbers),
      out_(&out),
      layer_(out.add_layer("moved_vertices", VectorGeometry::point, true,
                           fields_of(numbers, {{"vertex", FieldType::integer}},
                                     {{"kind", FieldType::text},
                                      {"before", FieldType::real},
                                      {"after", FieldType::real},
                                      {"change", FieldType::real}}))) {}

void MovedVertexLayer::add(const VectorPoint& after, std::uint32_t vertex, VertexRole role, double before) {
  static constexpr const char* kRoles[] = {"terrain", "lake", "outlet chain", "river"};
  out_->add_point(layer_, after,
                  values_of(numbers_, {std::int64_t{vertex}},
                            {std::string(kRoles[static_cast<std::size_t>(role)]), before, after.z, after.z - before}));
}

LimitLayers::LimitLayers(VertexNumbers numbers, GeoPackageWriter& out)
    : numbers_(numbers),
      out_(&out),
      limits_(out.add_layer("binding_limits", VectorGeometry::line, true,
                            fields_of(numbers, {{"vertices", FieldType::text}}, {{"constraint", FieldType::text}}))),
      changes_(out.add_layer("largest_changes", VectorGeometry::point, true,
                             fields_of(numbers, {{"vertex", FieldType::integer}}, {{"change", FieldType::real}}))) {}

void LimitLayers::add_limit(RowKind kind, std::span<const VectorPoint> points,
                            std::span<const std::uint32_t> vertices) {
  out_->add_line(limits_, points, values_of(numbers_, {listed(vertices)}, {std::string(name_of(kind))}));
}

void LimitLayers::add_largest_change(const VectorPoint& point, std::uint32_t vertex, double change) {
  out_->add_point(changes_, point, values_of(numbers_, {std::int64_t{vertex}}, {change}));
}

ContradictionLayer::ContradictionLayer(VertexNumbers numbers, GeoPackageWriter& out)
    : numbers_(numbers),
      out_(&out),
      layer_(out.add_layer(
          "contradictions", VectorGeometry::point, true,
          fields_of(numbers, {{"vertices", FieldType::text}},
                    {{"constraint", FieldType::text}, {"missing", FieldType::real}, {"reason", FieldType::text}}))) {}

void ContradictionLayer::add(const VectorPoint& first, RowKind kind, double missing, bool is_strict_part,
                             bool was_ended, std::span<const std::uint32_t> vertices) {
  std::string reason = "contradicts other constraints or the largest change";
  if (is_strict_part) reason = "holds weakly; its decline or side slope contradicts other constraints";
  if (was_ended) reason = "the time limit ended the search before it held";
  out_->add_point(layer_, first,
                  values_of(numbers_, {listed(vertices)}, {std::string(name_of(kind)), missing, reason}));
}

MouthLayers::MouthLayers(VertexNumbers numbers, GeoPackageWriter& out)
    : numbers_(numbers),
      out_(&out),
      mouths_(out.add_layer(
          "mouths", VectorGeometry::point, true,
          fields_of(numbers, {{"vertex", FieldType::integer}},
                    {{"kind", FieldType::text}, {"chain_edges", FieldType::integer}, {"climb", FieldType::real}}))),
      chains_(out.add_layer("outlet_chains", VectorGeometry::line, true,
                            fields_of(numbers, {{"from", FieldType::integer}, {"to", FieldType::integer}},
                                      {{"length", FieldType::real}}))) {}

void MouthLayers::add_mouth(const VectorPoint& point, std::uint32_t vertex, MouthKind kind, std::uint32_t chain_edges,
                            double climb) {
  static constexpr const char* kKinds[] = {"at an outlet", "with an outlet chain", "closed in by its own river"};
  out_->add_point(mouths_, point,
                  values_of(numbers_, {std::int64_t{vertex}},
                            {std::string(kKinds[static_cast<std::size_t>(kind)]), std::int64_t{chain_edges}, climb}));
}

void MouthLayers::add_chain(const VectorPoint& from, const VectorPoint& to, const RiverEdge& edge) {
  out_->add_line(chains_, std::array{from, to},
                 values_of(numbers_, {std::int64_t{edge.from}, std::int64_t{edge.to}}, {length_of(from, to)}));
}

void mark_circle(std::span<const std::uint32_t> circle, std::span<UsedLine> lines) {
  for (const std::uint32_t line : circle)
    (line == circle[0] ? lines[line].left_out_of_circle : lines[line].in_circle) = true;
}

LineLayers::LineLayers(GeoPackageWriter& out) : out_(&out) {
  const Fields fields{{"source_layer", FieldType::integer},
                      {"source_feature", FieldType::integer},
                      {"river", FieldType::text},
                      {"turned", FieldType::integer},
                      {"drop", FieldType::real},
                      {"river_edges", FieldType::integer},
                      {"cycle", FieldType::text}};
  all_ = out.add_layer("lines", VectorGeometry::line, false, fields);
  rising_ = out.add_layer("lines_that_rise", VectorGeometry::line, false, fields);
}

void LineLayers::add(const VectorParts& parts, std::uint32_t i, const UsedLine& line) {
  std::vector<VectorPoint> points;
  for (const auto& p : parts.ring(parts.ring_begin[i])) points.push_back({p[0], p[1], 0});
  if (line.is_turned) std::reverse(points.begin(), points.end());
  const std::string cycle = line.left_out_of_circle ? "left out of a circle" : line.in_circle ? "in a circle" : "";
  const Values values{std::int64_t{parts.layer[i]},
                      parts.feature[i],
                      line.river,
                      std::int64_t{line.is_turned ? 1 : 0},
                      line.drop,
                      static_cast<std::int64_t>(line.river_edges),
                      cycle};
  out_->add_line(all_, points, values);
  if (line.rises) out_->add_line(rising_, points, values);
}

void write_river_points(const std::string& path, const std::string& crs_wkt, const PointFrame& frame,
                        VertexNumbers numbers, std::span<const RiverPoint> points) {
  if (path.ends_with(".las")) {
    write_las(path, crs_wkt, frame, points);
    return;
  }
  GeoPackageWriter file(path, crs_wkt);
  const int layer = file.add_layer("river_vertices", VectorGeometry::point, true,
                                   fields_of(numbers, {{"vertex", FieldType::integer}}, {{"before", FieldType::real}}));
  for (const RiverPoint& point : points)
    file.add_point(layer, point.at, values_of(numbers, {std::int64_t{point.vertex}}, {point.before}));
  file.finish();
}

}  // namespace hydrotin
