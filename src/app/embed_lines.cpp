#include "embed_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hydrotin/crs.h"
#include "hydrotin/error.h"
#include "hydrotin/river_matching.h"
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

/// Names of rivers, and lines drawn upstream by their attribute.
struct LineAttributes {
  std::vector<std::string> name;
  std::vector<std::uint8_t> is_against;
};

LineAttributes attributes_of(const EmbedArguments& arguments, const VectorParts& parts) {
  LineAttributes out;
  const bool has_direction = arguments.direction == "attribute", has_name = !arguments.river_name.empty();
  const std::size_t fields = (has_direction ? 1u : 0u) + (has_name ? 1u : 0u);
  out.name.resize(parts.size());
  out.is_against.assign(parts.size(), 0);
  const auto& values = arguments.reversed_values;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (has_name) out.name[i] = parts.value[i * fields + fields - 1];
    if (has_direction)
      out.is_against[i] = std::find(values.begin(), values.end(), parts.value[i * fields]) != values.end() ? 1 : 0;
  }
  return out;
}

/// Heights at points of the lines; of several the least, which no order decides.
std::vector<std::pair<LatticePoint, double>> heights_of(const VectorParts& parts, const PlaneLattice& lattice) {
  std::vector<std::pair<LatticePoint, double>> z;
  const auto [west, south] = lattice.coordinates({0, 0});
  for (const auto& p : parts.point)
    if (std::abs(p[0] - west) < lattice.reach() && std::abs(p[1] - south) < lattice.reach())
      z.emplace_back(lattice.nearest(p[0], p[1]), p[2]);
  std::sort(z.begin(), z.end());
  z.erase(std::unique(z.begin(), z.end(), [](const auto& a, const auto& b) { return a.first == b.first; }), z.end());
  return z;
}

LineMatching matching_of(const EmbedArguments& arguments) {
  LineMatching out;
  out.insert = arguments.match == "insert";
  out.direction = arguments.direction == "digitised"   ? LineDirection::digitised
                  : arguments.direction == "reversed"  ? LineDirection::reversed
                  : arguments.direction == "attribute" ? LineDirection::attribute
                                                       : LineDirection::automatic;
  return out;
}

}  // namespace

LineMatch match_lines(const EmbedArguments& arguments, Mesh& mesh) {
  LineMatch match;
  match.parts = read_parts(arguments, mesh);
  const PlaneLattice lattice = find_lattice(plane_of(mesh));
  const LatticeTerrain terrain = terrain_of(arguments.tin, mesh, lattice);
  LineAttributes attributes = attributes_of(arguments, match.parts);
  RiverLines lines;
  for (std::size_t i = 0; i < match.parts.size(); ++i)
    for (const auto& chain : on_lattice(lattice, match.parts.ring(match.parts.ring_begin[i])))
      lines.add(chain, static_cast<std::uint32_t>(i));
  MatchedLines matched = hydrotin::match_lines(
      terrain, lines, match.parts.size(), matching_of(arguments), attributes.is_against,
      arguments.use_z ? heights_of(match.parts, lattice) : std::vector<std::pair<LatticePoint, double>>());
  if (matched.rivers.empty())
    throw Error(ErrorKind::input,
                fmt::format("{}: no line runs along or across an edge of {} (are they in the same CRS? see "
                            "--rivers-crs and --crs)",
                            arguments.rivers, arguments.tin));
  if (arguments.match == "insert") update(mesh, matched.terrain, lattice);
  match.counts = {{"features", match.parts.num_features},
                  {"without_geometry", match.parts.num_null},
                  {"of_other_kinds", match.parts.num_other},
                  {"lines", match.parts.size()}};
  match.counts.insert(match.counts.end(), matched.counts.begin(), matched.counts.end());
  match.is_turned = std::move(matched.is_turned);
  match.drop = std::move(matched.drop);
  match.disagrees = std::move(matched.disagrees);
  match.name = std::move(attributes.name);
  match.rivers = std::move(matched.rivers);
  match.line_of_edge = std::move(matched.line);
  match.cycles = std::move(matched.cycles);
  return match;
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
