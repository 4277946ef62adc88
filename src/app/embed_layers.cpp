#include "embed_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "hydrotin/error.h"
#include "hydrotin/las_writer.h"
#include "hydrotin/valley_floor.h"
#include "hydrotin/vector.h"

namespace hydrotin::app {
namespace {

using Fields = std::vector<VectorField>;
using Values = std::vector<FieldValue>;

class LayerWriter {
 public:
  LayerWriter(const std::string& path, const EmbedInput& input, const std::vector<double>& after)
      : file_(path, input.mesh.crs_wkt), input_(input), after_(after) {}

  void add_edges(const NamedRivers& rivers, double tolerance) {
    const RiverFaults old = river_faults(input_.terrain(), input_.rivers, input_.height, tolerance);
    const RiverFaults now = river_faults(input_.terrain(), input_.rivers, after_, tolerance);
    const int layer = file_.add_layer("river_edges", VectorGeometry::line, true,
                                      Fields{{"from", FieldType::integer},
                                             {"to", FieldType::integer},
                                             {"river", FieldType::text},
                                             {"source_layer", FieldType::integer},
                                             {"source_feature", FieldType::integer},
                                             {"length", FieldType::real},
                                             {"drop_before", FieldType::real},
                                             {"drop_after", FieldType::real},
                                             {"status", FieldType::text},
                                             {"valid", FieldType::integer}});
    for (std::size_t e = 0; e < input_.rivers.size(); ++e) {
      const auto [from, to] = input_.rivers[e];
      const bool is_valid = now.wrong_flow[e] == 0 && now.not_valley[e] == 0;
      std::int64_t source_layer = -1, source = -1;
      if (input_.lines) {
        const std::uint32_t part = input_.lines->line_of_edge[e];
        source_layer = input_.lines->parts.layer[part];
        source = input_.lines->parts.feature[part];
      }
      file_.add_line(layer, line({from, to}),
                     Values{std::int64_t{from}, std::int64_t{to}, rivers.name[rivers.river[e]], source_layer, source,
                            input_.length(input_.rivers[e]), input_.height[from] - input_.height[to],
                            after_[from] - after_[to], status(old, now, e), std::int64_t{is_valid ? 1 : 0}});
    }
  }

  void add_moved(double tolerance) {
    std::vector<const char*> kind(after_.size(), "terrain");
    for (const auto& [from, to] : input_.mouths.edge) kind[from] = kind[to] = "outlet chain";
    for (const auto& [from, to] : input_.rivers) kind[from] = kind[to] = "river";
    const int layer = file_.add_layer("moved_vertices", VectorGeometry::point, true,
                                      Fields{{"vertex", FieldType::integer},
                                             {"kind", FieldType::text},
                                             {"before", FieldType::real},
                                             {"after", FieldType::real},
                                             {"change", FieldType::real}});
    for (std::uint32_t v = 0; v < after_.size(); ++v) {
      const double change = after_[v] - input_.height[v];
      if (std::abs(change) <= tolerance) continue;
      file_.add_point(layer, point(v),
                      Values{std::int64_t{v}, std::string(kind[v]), input_.height[v], after_[v], change});
    }
  }

  void add_limits(const RiverConstraints& constraints, double tolerance) {
    const auto limits = binding_limits(input_.terrain(), input_.rivers, constraints, after_, std::max(tolerance, 1e-6));
    const int edges = file_.add_layer("binding_limits", VectorGeometry::line, true,
                                      Fields{{"constraint", FieldType::text}, {"vertices", FieldType::text}});
    for (const BindingLimit& limit : limits) {
      if (limit.is_largest_change) continue;
      file_.add_line(edges, line(limit.vertex),
                     Values{std::string(name_of(limit.kind)), fmt::format("{}", fmt::join(limit.vertex, " "))});
    }
    const int points = file_.add_layer("largest_changes", VectorGeometry::point, true,
                                       Fields{{"vertex", FieldType::integer}, {"change", FieldType::real}});
    for (const BindingLimit& limit : limits) {
      if (!limit.is_largest_change) continue;
      const std::uint32_t v = limit.vertex[0];
      file_.add_point(points, point(v), Values{std::int64_t{v}, after_[v] - input_.height[v]});
    }
  }

  void add_contradictions(const Embedding& embedding) {
    const int layer = file_.add_layer("contradictions", VectorGeometry::point, true,
                                      Fields{{"constraint", FieldType::text},
                                             {"missing", FieldType::real},
                                             {"vertices", FieldType::text},
                                             {"reason", FieldType::text}});
    for (const BrokenRow& row : embedding.broken) {
      std::string reason = "contradicts other constraints or the largest change";
      if (row.is_strict_part) reason = "holds weakly; its decline or side slope contradicts other constraints";
      if (!embedding.optimal) reason = "the time limit ended the search before it held";
      file_.add_point(
          layer, point(row.vertex[0]),
          Values{std::string(name_of(row.kind)), row.missing, fmt::format("{}", fmt::join(row.vertex, " ")), reason});
    }
  }

  void add_mouths() {
    static constexpr const char* kKinds[] = {"at an outlet", "with an outlet chain", "closed in by its own river"};
    const int mouths = file_.add_layer("mouths", VectorGeometry::point, true,
                                       Fields{{"vertex", FieldType::integer},
                                              {"kind", FieldType::text},
                                              {"chain_edges", FieldType::integer},
                                              {"climb", FieldType::real}});
    for (const RiverMouth& mouth : input_.mouths.mouth)
      file_.add_point(mouths, point(mouth.vertex),
                      Values{std::int64_t{mouth.vertex}, std::string(kKinds[static_cast<std::size_t>(mouth.kind)]),
                             std::int64_t{mouth.length}, mouth.climb});
    const int chains = file_.add_layer("outlet_chains", VectorGeometry::line, true,
                                       Fields{{"from", FieldType::integer}, {"to", FieldType::integer}});
    for (const auto& [from, to] : input_.mouths.edge)
      file_.add_line(chains, line({from, to}), Values{std::int64_t{from}, std::int64_t{to}});
  }

  void add_lines() {
    const LineMatch& match = *input_.lines;
    std::vector<std::int64_t> edges(match.parts.size(), 0), in_cycle(match.parts.size(), 0);
    for (const std::uint32_t part : match.line_of_edge) ++edges[part];
    for (const auto& cycle : match.cycles)
      for (const std::uint32_t part : cycle)
        in_cycle[part] = part == cycle[0] ? 2 : std::max<std::int64_t>(in_cycle[part], 1);
    const Fields fields{{"source_layer", FieldType::integer},
                        {"source_feature", FieldType::integer},
                        {"river", FieldType::text},
                        {"turned", FieldType::integer},
                        {"drop", FieldType::real},
                        {"river_edges", FieldType::integer},
                        {"cycle", FieldType::text}};
    const int all = file_.add_layer("lines", VectorGeometry::line, false, fields);
    const auto add = [&](int layer, std::uint32_t part) {
      static constexpr const char* kCycle[] = {"", "in a circle", "left out of a circle"};
      std::vector<VectorPoint> points;
      for (const auto& p : match.parts.ring(match.parts.ring_begin[part])) points.push_back({p[0], p[1], 0});
      if (match.is_turned[part] != 0) std::reverse(points.begin(), points.end());
      file_.add_line(layer, points,
                     Values{std::int64_t{match.parts.layer[part]}, match.parts.feature[part], match.name[part],
                            std::int64_t{match.is_turned[part]}, match.drop[part], edges[part],
                            std::string(kCycle[in_cycle[part]])});
    };
    for (std::uint32_t part = 0; part < match.parts.size(); ++part) add(all, part);
    const int rising = file_.add_layer("lines_that_rise", VectorGeometry::line, false, fields);
    for (const std::uint32_t part : match.disagrees) add(rising, part);
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

  static std::string status(const RiverFaults& old, const RiverFaults& now, std::size_t e) {
    const auto name = [e](const RiverFaults& faults) -> std::string {
      if (faults.wrong_flow[e] != 0)
        return faults.not_valley[e] != 0 ? "flows uphill and is no valley" : "flows uphill";
      if (faults.not_valley[e] != 0) return "is no valley";
      return faults.flat[e] != 0 ? "is level" : "is valid";
    };
    const std::string then = name(old), is = name(now);
    return then == is ? is : is + ", before it " + (then.starts_with("is") ? "was" + then.substr(2) : then);
  }

  GeoPackageWriter file_;
  const EmbedInput& input_;
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

void write_las(const std::string& path, const EmbedInput& input, const std::vector<double>& after) {
  const auto vertices = river_vertices(input);
  LasWriterOptions options;
  options.scale = {0.001, 0.001, 0.001};
  options.crs = input.mesh.crs_wkt;
  std::array<std::vector<std::int32_t>, 3> columns;
  for (const std::uint32_t v : vertices) {
    const std::array<double, 3> p{input.position[v][0], input.position[v][1], after[v]};
    if (v == vertices[0])
      for (std::size_t i = 0; i < 3; ++i) options.offset[i] = std::floor(p[i]);
    for (std::size_t i = 0; i < 3; ++i) {
      const double scaled = std::round((p[i] - options.offset[i]) / options.scale[i]);
      if (std::abs(scaled) > 2147483000.0)
        throw Error(ErrorKind::storage,
                    fmt::format("{}: the rivers are too far apart for millimetres in LAS (write a .gpkg)", path));
      columns[i].push_back(static_cast<std::int32_t>(scaled));
    }
  }
  const std::vector<std::uint8_t> ground(vertices.size(), 2);
  LasPoints points;
  points.x = columns[0];
  points.y = columns[1];
  points.z = columns[2];
  points.classification = ground;
  LasWriter writer(path, options);
  writer.write(points);
  writer.close();
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
  LayerWriter writer(path, input, after);
  writer.add_edges(rivers, tolerance);
  writer.add_moved(tolerance);
  writer.add_limits(options.constraints, tolerance);
  writer.add_contradictions(embedding);
  if (!input.is_outlet.empty()) writer.add_mouths();
  if (input.lines) writer.add_lines();
  writer.finish();
}

void write_river_points(const std::string& path, const EmbedInput& input, const std::vector<double>& after) {
  if (path.ends_with(".las")) {
    write_las(path, input, after);
    return;
  }
  GeoPackageWriter file(path, input.mesh.crs_wkt);
  const int layer = file.add_layer("river_vertices", VectorGeometry::point, true,
                                   Fields{{"vertex", FieldType::integer}, {"before", FieldType::real}});
  for (const std::uint32_t v : river_vertices(input))
    file.add_point(layer, {input.position[v][0], input.position[v][1], after[v]},
                   Values{std::int64_t{v}, input.height[v]});
  file.finish();
}

}  // namespace hydrotin::app
