#include "embed_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "hydrotin/river_layers.h"
#include "hydrotin/river_statistics.h"
#include "hydrotin/valley_floor.h"

namespace hydrotin::app {
namespace {

class LayerWriter {
 public:
  LayerWriter(const std::string& path, const EmbedInput& input, const RiverConstraints& constraints,
              const std::vector<double>& after)
      : file_(path, input.mesh.crs_wkt), input_(input), constraints_(constraints), after_(after) {}

  void add_edges(const NamedRivers& rivers, double tolerance) {
    const RiverFaults old = river_faults(input_.terrain(), input_.rivers, input_.height, tolerance);
    const RiverFaults now = river_faults(input_.terrain(), input_.rivers, after_, tolerance);
    RiverEdgeLayer layer(VertexNumbers::shown, file_);
    for (std::size_t e = 0; e < input_.rivers.size(); ++e) {
      const auto [from, to] = input_.rivers[e];
      RiverEdgeLayer::Edge edge{point(from), point(to), from, to, rivers.name[rivers.river[e]]};
      if (input_.lines) {
        const std::uint32_t part = input_.lines->line_of_edge[e];
        edge.source_layer = input_.lines->parts.layer[part];
        edge.source_feature = input_.lines->parts.feature[part];
      }
      edge.drop_before = input_.height[from] - input_.height[to];
      edge.drop_after = after_[from] - after_[to];
      edge.before = state_of(old, e);
      edge.after = state_of(now, e);
      edge.is_valid = !(constraints_.flow && edge.after.wrong_flow) && !(constraints_.valley && edge.after.not_valley);
      layer.add(edge);
    }
  }

  void add_moved(double tolerance) {
    std::vector<VertexRole> role(after_.size(), VertexRole::terrain);
    for (const Lake& lake : constraints_.lakes)
      for (const std::uint32_t v : lake.vertex) role[v] = VertexRole::lake;
    for (const auto& [from, to] : input_.mouths.edge) role[from] = role[to] = VertexRole::chain;
    for (const auto& [from, to] : input_.rivers) role[from] = role[to] = VertexRole::river;
    MovedVertexLayer layer(VertexNumbers::shown, file_);
    for (std::uint32_t v = 0; v < after_.size(); ++v)
      if (std::abs(after_[v] - input_.height[v]) > tolerance) layer.add(point(v), v, role[v], input_.height[v]);
  }

  void add_limits(double quantum, double tolerance) {
    const auto limits =
        binding_limits(input_.terrain(), input_.rivers, constraints_, after_, std::max(tolerance, 1e-6), quantum);
    LimitLayers layers(VertexNumbers::shown, file_);
    for (const BindingLimit& limit : limits) {
      const std::uint32_t v = limit.vertex[0];
      if (limit.is_largest_change)
        layers.add_largest_change(point(v), v, after_[v] - input_.height[v]);
      else
        layers.add_limit(limit.kind, line(limit.vertex), limit.vertex);
    }
  }

  void add_contradictions(const Embedding& embedding) {
    ContradictionLayer layer(VertexNumbers::shown, file_);
    for (const BrokenRow& row : embedding.broken)
      layer.add(point(row.vertex[0]), row.kind, row.missing, row.is_strict_part, !embedding.optimal, row.vertex);
  }

  void add_mouths() {
    MouthLayers layers(VertexNumbers::shown, file_);
    for (const RiverMouth& mouth : input_.mouths.mouth)
      layers.add_mouth(point(mouth.vertex), mouth.vertex, mouth.kind, mouth.length, mouth.climb);
    for (const RiverEdge& edge : input_.mouths.edge) layers.add_chain(point(edge.from), point(edge.to), edge);
  }

  void add_lines() {
    const LineMatch& match = *input_.lines;
    std::vector<UsedLine> lines(match.parts.size());
    for (const std::uint32_t part : match.line_of_edge) ++lines[part].river_edges;
    for (const auto& circle : match.cycles) mark_circle(circle, lines);
    for (const std::uint32_t part : match.disagrees) lines[part].rises = true;
    LineLayers layers(file_);
    for (std::uint32_t part = 0; part < lines.size(); ++part) {
      UsedLine& used = lines[part];
      used.river = match.name[part];
      used.is_turned = match.is_turned[part] != 0;
      used.drop = match.drop[part];
      layers.add(match.parts, part, used);
    }
  }

  void finish() { file_.finish(); }

 private:
  [[nodiscard]] VectorPoint point(std::uint32_t v) const {
    return {input_.position[v][0], input_.position[v][1], after_[v]};
  }
  [[nodiscard]] std::vector<VectorPoint> line(const std::vector<std::uint32_t>& vertices) const {
    std::vector<VectorPoint> points;
    for (const std::uint32_t v : vertices) points.push_back(point(v));
    return points;
  }

  GeoPackageWriter file_;
  const EmbedInput& input_;
  const RiverConstraints& constraints_;
  const std::vector<double>& after_;
};

std::vector<std::uint32_t> river_vertices(const EmbedInput& input) {
  std::vector<std::uint32_t> vertices;
  for (const auto& [from, to] : input.rivers) vertices.insert(vertices.end(), {from, to});
  std::sort(vertices.begin(), vertices.end(),
            [&](std::uint32_t a, std::uint32_t b) { return input.position[a] < input.position[b]; });
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

}  // namespace

NamedRivers name_rivers(const EmbedInput& input, const std::vector<double>& after, double tolerance) {
  const RiverNetworks networks = connect_networks(input.terrain(), input.rivers);
  std::map<std::string, std::uint32_t> number;
  NamedRivers rivers;
  for (std::size_t e = 0; e < input.rivers.size(); ++e) {
    std::string name = input.lines ? input.lines->name[input.lines->line_of_edge[e]] : "";
    if (name.empty()) name = fmt::format("network {}", networks.network[e] + 1);
    const auto [at, is_new] = number.emplace(name, static_cast<std::uint32_t>(rivers.name.size()));
    if (is_new) rivers.name.push_back(name);
    rivers.river.push_back(at->second);
  }
  const auto table = river_table(input.terrain(), input.rivers, rivers.river,
                                 static_cast<std::uint32_t>(rivers.name.size()), after, tolerance);
  std::vector<std::uint32_t> order(rivers.name.size()), place(order.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return table[a].length != table[b].length ? table[a].length > table[b].length : rivers.name[a] < rivers.name[b];
  });
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    place[order[i]] = i;
    names.push_back(rivers.name[order[i]]);
    rivers.row.push_back(table[order[i]]);
  }
  rivers.name = std::move(names);
  for (std::uint32_t& r : rivers.river) r = place[r];
  return rivers;
}

void write_layers(const std::string& path, const EmbedInput& input, const EmbeddingOptions& options,
                  const Embedding& embedding, const std::vector<double>& after, const NamedRivers& rivers,
                  double tolerance) {
  LayerWriter writer(path, input, options.constraints, after);
  writer.add_edges(rivers, tolerance);
  writer.add_moved(tolerance);
  writer.add_limits(options.quantum, tolerance);
  writer.add_contradictions(embedding);
  if (!input.is_outlet.empty()) writer.add_mouths();
  if (input.lines) writer.add_lines();
  writer.finish();
}

void write_river_points(const std::string& path, const EmbedInput& input, const std::vector<double>& after) {
  std::vector<RiverPoint> points;
  for (const std::uint32_t v : river_vertices(input))
    points.push_back({{input.position[v][0], input.position[v][1], after[v]}, v, input.height[v]});
  PointFrame frame;
  if (!points.empty())
    frame.offset = {std::floor(points[0].at.x), std::floor(points[0].at.y), std::floor(points[0].at.z)};
  hydrotin::write_river_points(path, input.mesh.crs_wkt, frame, VertexNumbers::shown, points);
}

}  // namespace hydrotin::app
