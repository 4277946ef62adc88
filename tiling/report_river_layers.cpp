#include <algorithm>
#include <cstdlib>
#include <tuple>
#include <unordered_map>

#include "hydrotin/river_layers.h"
#include "report_rivers.h"
#include "river_input.h"

namespace hydrotin {
namespace {

class LayerWriter {
 public:
  LayerWriter(const RunContext& context, const RiverFigures& figures, GeoPackageWriter& file)
      : rivers_(*context.rivers),
        network_(rivers_.network),
        input_(*context.river_input),
        figures_(figures),
        lattice_(context.plan.lattice),
        file_(file) {}

  void add_edges() {
    std::vector<EmbeddedEdge> states(network_.river.size());
    for (const GroupSolution& s : rivers_.solution)
      for (const EmbeddedEdge& e : s.edge) states[e.edge] = e;
    RiverEdgeLayer layer(VertexNumbers::hidden, file_);
    for (std::size_t e = 0; e < network_.river.size(); ++e) {
      const auto [from, to] = network_.river[e];
      const std::uint32_t line = network_.line[e];
      RiverEdgeLayer::Edge edge{vertex(from), vertex(to), 0, 0, figures_.names.name[figures_.names.river[e]]};
      edge.source_layer = input_.lines.layer[line];
      edge.source_feature = input_.lines.feature[line];
      edge.drop_before = z_between(network_.height[from], network_.height[to]);
      const std::int32_t high = final_height(rivers_, figures_, from), low = final_height(rivers_, figures_, to);
      edge.drop_after = z_between(high, low);
      edge.before = states[e].before;
      const std::pair points(network_.point[from], network_.point[to]);
      edge.is_valid = !std::binary_search(figures_.invalid.begin(), figures_.invalid.end(), points);
      edge.after = {high < low, std::binary_search(figures_.no_valley.begin(), figures_.no_valley.end(), points),
                    high == low};
      layer.add(edge);
    }
  }

  void add_moved() {
    std::unordered_map<std::uint64_t, VertexRole> role;
    for (const Lake& lake : network_.lake)
      for (const std::uint32_t v : lake.vertex) role[network_.point[v]] = VertexRole::lake;
    for (const auto& [from, to] : network_.chain)
      role[network_.point[from]] = role[network_.point[to]] = VertexRole::chain;
    for (const auto& [from, to] : network_.river)
      role[network_.point[from]] = role[network_.point[to]] = VertexRole::river;
    std::vector<const MovedVertex*> all;
    for (const GroupSolution& s : rivers_.solution)
      for (const MovedVertex& v : s.moved) all.push_back(&v);
    std::sort(all.begin(), all.end(),
              [](const MovedVertex* a, const MovedVertex* b) { return a->position < b->position; });
    MovedVertexLayer layer(VertexNumbers::hidden, file_);
    for (const MovedVertex* v : all) {
      const auto found = role.find(v->point);
      layer.add(at(v->position, v->after), 0, found != role.end() ? found->second : VertexRole::terrain,
                lattice_.z(v->before));
    }
  }

  void add_limits() {
    std::vector<const LimitPlace*> all;
    for (const GroupSolution& s : rivers_.solution)
      for (const LimitPlace& limit : s.limit) all.push_back(&limit);
    std::sort(all.begin(), all.end(), [](const LimitPlace* a, const LimitPlace* b) {
      return std::tie(a->is_largest_change, a->kind, a->corner) < std::tie(b->is_largest_change, b->kind, b->corner);
    });
    LimitLayers layers(VertexNumbers::hidden, file_);
    std::vector<VectorPoint> points;
    for (const LimitPlace* limit : all) {
      points.clear();
      for (const auto& [x, y, z] : limit->corner) points.push_back(at({x, y}, z));
      if (limit->is_largest_change)
        layers.add_largest_change(points[0], 0, limit->change * lattice_.scale_z);
      else
        layers.add_limit(limit->kind, points, {});
    }
  }

  void add_contradictions() {
    struct Place {
      const BrokenPlace* place;
      bool was_ended;
    };
    std::vector<Place> all;
    for (const GroupSolution& s : rivers_.solution)
      for (const BrokenPlace& place : s.broken) all.push_back({&place, !s.optimal});
    std::sort(all.begin(), all.end(), [](const Place& a, const Place& b) {
      return std::tie(a.place->at, a.place->kind, a.place->missing) <
             std::tie(b.place->at, b.place->kind, b.place->missing);
    });
    ContradictionLayer layer(VertexNumbers::hidden, file_);
    for (const auto& [place, was_ended] : all)
      layer.add(at(place->at, place->height), place->kind, place->missing, place->is_strict_part, was_ended, {});
  }

  void add_mouths() {
    MouthLayers layers(VertexNumbers::hidden, file_);
    for (std::size_t i = 0; i < network_.mouth.size(); ++i)
      layers.add_mouth(vertex(network_.mouth[i]), 0, static_cast<MouthKind>(network_.mouth_kind[i]),
                       network_.mouth_length[i], network_.mouth_climb[i] * lattice_.scale_z);
    for (const RiverEdge& edge : network_.chain) layers.add_chain(vertex(edge.from), vertex(edge.to), {});
  }

  void add_lines() {
    std::vector<UsedLine> lines(input_.lines.size());
    for (const std::uint32_t line : network_.line) ++lines[line].river_edges;
    for (std::size_t c = 0; c + 1 < network_.cycle_begin.size(); ++c)
      mark_circle(std::span(network_.cycle)
                      .subspan(network_.cycle_begin[c], network_.cycle_begin[c + 1] - network_.cycle_begin[c]),
                  lines);
    for (const std::uint32_t line : network_.disagrees) lines[line].rises = true;
    LineLayers layers(file_);
    for (std::uint32_t i = 0; i < lines.size(); ++i) {
      UsedLine& line = lines[i];
      line.river = input_.name[i];
      line.is_turned = network_.is_turned[i] != 0;
      line.drop = network_.drop[i] * lattice_.scale_z;
      layers.add(input_.lines, i, line);
    }
  }

 private:
  [[nodiscard]] double z_between(std::int32_t high, std::int32_t low) const {
    return static_cast<double>(std::int64_t{high} - low) * lattice_.scale_z;
  }
  [[nodiscard]] VectorPoint at(LatticePoint p, std::int32_t h) const {
    return {lattice_.x(p.x), lattice_.y(p.y), lattice_.z(h)};
  }
  [[nodiscard]] VectorPoint vertex(std::uint32_t v) const {
    return at(network_.position[v], final_height(rivers_, figures_, v));
  }

  const EmbeddedRivers& rivers_;
  const RiverNetwork& network_;
  const RiverInput& input_;
  const RiverFigures& figures_;
  const Lattice& lattice_;
  GeoPackageWriter& file_;
};

}  // namespace

void write_river_points(const RunContext& context, const RiverFigures& figures) {
  const PointsFile format = context.options.rivers.points_out;
  if (format == PointsFile::none) return;
  const RiverNetwork& network = context.rivers->network;
  const Lattice& l = context.plan.lattice;
  std::vector<std::uint32_t> vertices;
  for (const auto& [from, to] : network.river) vertices.insert(vertices.end(), {from, to});
  std::sort(vertices.begin(), vertices.end(),
            [&](std::uint32_t a, std::uint32_t b) { return network.position[a] < network.position[b]; });
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<RiverPoint> points;
  for (const std::uint32_t v : vertices)
    points.push_back(
        {{l.x(network.position[v].x), l.y(network.position[v].y), l.z(final_height(*context.rivers, figures, v))},
         0,
         l.z(network.height[v])});
  // The lattice of the data: nothing is rounded.
  const auto offset = [](std::int64_t base, double scale, double given) {
    return std::abs(base) < (std::int64_t{1} << 30) ? given : given + static_cast<double>(base) * scale;
  };
  const PointFrame frame{{l.scale_xy, l.scale_xy, l.scale_z},
                         {offset(l.base_x, l.scale_xy, l.offset_x), offset(l.base_y, l.scale_xy, l.offset_y),
                          offset(l.base_z, l.scale_z, l.offset_z)}};
  write_river_points(context.layout.river_points(format == PointsFile::las ? "las" : "gpkg"), context.plan.crs_wkt,
                     frame, VertexNumbers::hidden, points);
}

void write_river_layers(const RunContext& context, const RiverFigures& figures, GeoPackageWriter& out) {
  LayerWriter layers(context, figures, out);
  layers.add_edges();
  layers.add_moved();
  layers.add_limits();
  layers.add_contradictions();
  layers.add_mouths();
  layers.add_lines();
}

}  // namespace hydrotin
