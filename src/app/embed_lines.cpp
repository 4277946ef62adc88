#include "embed_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "hydrotin/crs.h"
#include "hydrotin/error.h"
#include "hydrotin/flow_direction.h"
#include "hydrotin/line_insertion.h"
#include "hydrotin/line_snapping.h"
#include "hydrotin/network_cleaning.h"
#include "hydrotin/wingtip_clearing.h"
#include "plane_lattice.h"

namespace hydrotin::app {
namespace {

std::vector<std::array<double, 2>> plane_of(const Mesh& mesh) {
  std::vector<std::array<double, 2>> plane;
  for (const auto& v : mesh.vertex) plane.push_back({v[0], v[1]});
  return plane;
}

/// The mesh on its lattice, triangles counter-clockwise.
LatticeTerrain terrain_of(const std::string& path, const Mesh& mesh, const PlaneLattice& lattice) {
  LatticeTerrain terrain;
  for (const auto& v : mesh.vertex) {
    terrain.position.push_back(lattice.nearest(v[0], v[1]));
    terrain.height.push_back(v[2]);
  }
  for (const auto& t : mesh.triangle) {
    const auto &a = mesh.vertex[t[0]], &b = mesh.vertex[t[1]], &c = mesh.vertex[t[2]];
    const bool is_left = (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]);
    terrain.triangle.insert(terrain.triangle.end(), {t[0], is_left ? t[1] : t[2], is_left ? t[2] : t[1]});
  }
  const std::uint32_t bad = find_bad_triangle(terrain.position, terrain.triangle);
  if (bad < terrain.triangle.size() / 3)
    throw Error(
        ErrorKind::input,
        fmt::format("{}: triangle {} overlaps a neighbour or is thinner than {} (lines cannot be matched to it; "
                    "remove the triangle)",
                    path, bad, 1 / lattice.denominator));
  link_twins(terrain);
  return terrain;
}

/// Writes new vertices and the triangles back.
void update(Mesh& mesh, const LatticeTerrain& terrain, const PlaneLattice& lattice) {
  for (std::size_t v = mesh.vertex.size(); v < terrain.position.size(); ++v) {
    const auto p = lattice.coordinates(terrain.position[v]);
    mesh.vertex.push_back({p[0], p[1], terrain.height[v]});
  }
  mesh.triangle.clear();
  for (std::size_t t = 0; t < terrain.triangle.size(); t += 3)
    mesh.triangle.push_back({terrain.triangle[t], terrain.triangle[t + 1], terrain.triangle[t + 2]});
}

VectorParts read_parts(const EmbedArguments& arguments, const Mesh& mesh) {
  VectorReadOptions options;
  options.target_wkt = mesh.crs_wkt;
  if (!arguments.rivers_crs.empty()) options.missing_crs_wkt = parse_crs(arguments.rivers_crs, "--rivers-crs").wkt;
  if (arguments.direction == "attribute") options.fields.push_back(arguments.direction_field);
  if (!arguments.river_name.empty()) options.fields.push_back(arguments.river_name);
  VectorParts parts = read_vector(arguments.rivers, options);
  if (mesh.crs_wkt.empty() && !parts.crs_was_missing)
    fmt::print(stderr, "hydrotin: {}: the CRS of the TIN is unknown: lines are taken as they are (set --crs)\n",
               arguments.rivers);
  if (!mesh.crs_wkt.empty() && parts.crs_was_missing && arguments.rivers_crs.empty())
    fmt::print(stderr, "hydrotin: {}: has no CRS: lines are taken to be in that of the TIN (set --rivers-crs)\n",
               arguments.rivers);
  if (parts.size() == 0)
    throw Error(ErrorKind::input,
                fmt::format("{}: has no line: {} features, {} without geometry, {} of other kinds (give river lines)",
                            arguments.rivers, parts.num_features, parts.num_null, parts.num_other));
  return parts;
}

class Matcher {
 public:
  Matcher(const EmbedArguments& arguments, Mesh& mesh)
      : arguments_(arguments),
        mesh_(mesh),
        lattice_(find_lattice(plane_of(mesh))),
        terrain_(terrain_of(arguments.tin, mesh, lattice_)),
        locator_(terrain_) {}

  LineMatch run() {
    match_.parts = read_parts(arguments_, mesh_);
    count("features", match_.parts.num_features);
    count("without_geometry", match_.parts.num_null);
    count("of_other_kinds", match_.parts.num_other);
    count("lines", match_.parts.size());
    set_names();
    const RiverLines lines = directed(lay_on_lattice());
    const RiverLines reaches = split_at_nodes(lines);
    count("reaches", reaches.size());
    arguments_.match == "insert" ? insert(reaches) : snap(reaches);
    if (match_.rivers.empty())
      throw Error(ErrorKind::input,
                  fmt::format("{}: no line runs along or across an edge of {} (are they in the same CRS? see "
                              "--rivers-crs and --crs)",
                              arguments_.rivers, arguments_.tin));
    return std::move(match_);
  }

 private:
  void count(const std::string& name, std::uint64_t number) { match_.counts.emplace_back(name, number); }

  void set_names() {
    match_.name.resize(match_.parts.size());
    const std::size_t fields =
        (arguments_.direction == "attribute" ? 1u : 0u) + (arguments_.river_name.empty() ? 0u : 1u);
    if (!arguments_.river_name.empty())
      for (std::size_t i = 0; i < match_.parts.size(); ++i)
        match_.name[i] = match_.parts.value[i * fields + fields - 1];
  }

  RiverLines lay_on_lattice() {
    RiverLines lines;
    for (std::size_t i = 0; i < match_.parts.size(); ++i)
      for (const auto& chain : on_lattice(lattice_, match_.parts.ring(match_.parts.ring_begin[i])))
        lines.add(chain, static_cast<std::uint32_t>(i));
    RiverLines clean = without_repeats(lines);
    count("repeated_points", lines.point.size() - clean.point.size());
    return clean;
  }

  RiverLines directed(const RiverLines& lines) {
    match_.is_turned.assign(match_.parts.size(), 0);
    match_.drop.assign(match_.parts.size(), 0);
    std::vector<std::uint8_t> is_turned(lines.size(), 0);
    if (arguments_.direction == "auto") {
      const FlowVote vote = vote_on_flow(locator_, lines);
      is_turned = vote.is_turned;
      count("line_networks", vote.num_networks);
      count("line_networks_turned", vote.num_turned);
    } else {
      for (std::size_t i = 0; i < lines.size(); ++i) is_turned[i] = wants_turn(lines.source[i]) ? 1 : 0;
    }
    RiverLines result = turned(lines, is_turned);
    const auto drops = drops_along(locator_, result);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      match_.is_turned[lines.source[i]] = is_turned[i];
      match_.drop[lines.source[i]] += drops[i];
    }
    for (std::uint32_t i = 0; i < match_.drop.size(); ++i)
      if (match_.drop[i] < 0) match_.disagrees.push_back(i);
    count("lines_turned", static_cast<std::uint64_t>(std::count(match_.is_turned.begin(), match_.is_turned.end(), 1)));
    count("lines_that_rise", match_.disagrees.size());
    return result;
  }

  [[nodiscard]] bool wants_turn(std::uint32_t part) const {
    if (arguments_.direction == "reversed") return true;
    if (arguments_.direction != "attribute") return false;
    const std::size_t fields = 1u + (arguments_.river_name.empty() ? 0u : 1u);
    const auto& values = arguments_.reversed_values;
    return std::find(values.begin(), values.end(), match_.parts.value[part * fields]) != values.end();
  }

  void snap(const RiverLines& reaches) {
    SnappedLines snapped = snap_lines(locator_, reaches);
    count("reaches_outside", snapped.counts.outside);
    count("pieces", snapped.counts.pieces);
    count("crossings", snapped.counts.crossings);
    count("points_inside_triangles", snapped.counts.dropped_points);
    count("points_snapped_together", snapped.counts.repeated);
    count("pieces_snapped_to_a_vertex", snapped.counts.vanished);
    clean(snapped.paths, terrain_, true);
  }

  void insert(const RiverLines& reaches) {
    InsertedLines inserted = insert_lines(locator_, reaches);
    if (arguments_.use_z) take_heights(inserted.terrain);
    count("reaches_outside", inserted.counts.outside);
    count("pieces", inserted.counts.pieces);
    count("line_crossings", inserted.counts.crossings);
    count("points_bent_in", inserted.counts.bent);
    count("vertices_inserted", inserted.counts.new_vertices);
    count("vertices_on_the_rim", inserted.counts.rim_vertices);
    count("segments_lost", inserted.counts.lost_segments);
    clean(inserted.paths, inserted.terrain, false);
    update(mesh_, inserted.terrain, lattice_);
  }

  /// New vertices at points of the lines take their z; of several the least, which no order decides.
  void take_heights(LatticeTerrain& terrain) {
    std::map<LatticePoint, double> z;
    for (const auto& p : match_.parts.point) {
      const auto [west, south] = lattice_.coordinates({0, 0});
      if (std::abs(p[0] - west) >= lattice_.reach() || std::abs(p[1] - south) >= lattice_.reach()) continue;
      const auto [at, is_new] = z.emplace(lattice_.nearest(p[0], p[1]), p[2]);
      if (!is_new) at->second = std::min(at->second, p[2]);
    }
    std::uint64_t taken = 0;
    for (std::size_t v = mesh_.vertex.size(); v < terrain.position.size(); ++v)
      if (const auto found = z.find(terrain.position[v]); found != z.end()) {
        terrain.height[v] = found->second;
        ++taken;
      }
    count("heights_from_lines", taken);
  }

  void clean(const RiverPaths& paths, const LatticeTerrain& terrain, bool with_third_edges) {
    CleanNetwork network = clean_network(terrain.position, terrain.height, paths);
    count("loop_edges", network.counts.loop_edges);
    count("repeated_edges", network.counts.repeated_edges);
    count("opposed_edges", network.counts.opposed_edges);
    count("shortcut_edges", network.counts.shortcut_edges);
    count("joined_edges", network.counts.joined_edges);
    count("cycles", network.cycle_begin.size() - 1);
    count("cycle_edges", network.counts.cycle_edges);
    if (with_third_edges) count("third_edges", take_third_edges(terrain, network));
    for (std::size_t i = 0; i + 1 < network.cycle_begin.size(); ++i)
      match_.cycles.emplace_back(network.cycle.begin() + static_cast<std::ptrdiff_t>(network.cycle_begin[i]),
                                 network.cycle.begin() + static_cast<std::ptrdiff_t>(network.cycle_begin[i + 1]));
    match_.rivers = std::move(network.edge);
    match_.line_of_edge = std::move(network.line);
  }

  const EmbedArguments& arguments_;
  Mesh& mesh_;
  PlaneLattice lattice_;
  LatticeTerrain terrain_;
  TerrainLocator locator_;
  LineMatch match_;
};

}  // namespace

LineMatch match_lines(const EmbedArguments& arguments, Mesh& mesh) {
  return Matcher(arguments, mesh).run();
}

std::pair<std::uint64_t, std::uint64_t> clear_mesh_wingtips(const std::string& path, Mesh& mesh,
                                                            const std::vector<RiverEdge>& rivers,
                                                            const std::vector<RiverEdge>& chain,
                                                            const std::vector<std::uint32_t>& lake) {
  // Finer than the lattice of the data, so that there is room in small triangles.
  const PlaneLattice lattice = find_lattice(plane_of(mesh), 100);
  LatticeTerrain terrain = terrain_of(path, mesh, lattice);
  const ClearedWingtips cleared = clear_wingtips(terrain, rivers, chain, lake);
  update(mesh, terrain, lattice);
  return {cleared.num_points, cleared.num_left};
}

}  // namespace hydrotin::app
