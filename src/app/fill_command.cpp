#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "hydrotin/error.h"
#include "hydrotin/lifting.h"
#include "hydrotin/mesh.h"
#include "hydrotin/pits.h"
#include "hydrotin/vertex_graph.h"

namespace hydrotin::app {
namespace {

struct FillArguments {
  std::string tin, method = "lift", measure = "total", outlets = "hull", out;
  std::vector<std::uint32_t> pits;
  bool json = false;
};

/// A terrain whose coordinates are replaced by their ranks: lifting compares and never calculates, so ranks are exact.
struct RankedTerrain {
  std::vector<double> level;           ///< heights that occur, ascending
  std::vector<std::int32_t> height;    ///< [n] index into `level`
  std::vector<LatticePoint> position;  ///< [n] ranks of x and of y
};

std::vector<double> sorted_values(const Mesh& mesh, std::size_t axis) {
  std::vector<double> values;
  values.reserve(mesh.vertex.size());
  for (const auto& vertex : mesh.vertex) values.push_back(vertex[axis]);
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

std::int32_t rank_of(const std::vector<double>& values, double value) {
  return static_cast<std::int32_t>(std::lower_bound(values.begin(), values.end(), value) - values.begin());
}

RankedTerrain rank(const Mesh& mesh) {
  RankedTerrain terrain;
  const auto xs = sorted_values(mesh, 0), ys = sorted_values(mesh, 1);
  terrain.level = sorted_values(mesh, 2);
  for (const auto& vertex : mesh.vertex) {
    terrain.position.push_back({rank_of(xs, vertex[0]), rank_of(ys, vertex[1])});
    terrain.height.push_back(rank_of(terrain.level, vertex[2]));
  }
  return terrain;
}

/// Refuses what is no terrain: two vertices at one place, an edge of three triangles.
/// Returns for each vertex whether it lies on the rim, i.e. on an edge of one triangle.
std::vector<std::uint8_t> checked_rim(const std::string& path, const Mesh& mesh, const RankedTerrain& terrain) {
  std::vector<std::pair<LatticePoint, std::uint32_t>> places;
  for (std::uint32_t v = 0; v < mesh.vertex.size(); ++v) places.emplace_back(terrain.position[v], v);
  std::sort(places.begin(), places.end());
  for (std::size_t i = 1; i < places.size(); ++i)
    if (places[i].first == places[i - 1].first)
      throw Error(ErrorKind::input,
                  fmt::format("{}: vertices {} and {} have the same x and y (a terrain has one height at a place)",
                              path, places[i - 1].second, places[i].second));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangle.size());
  for (const auto& triangle : mesh.triangle)
    for (std::size_t i = 0; i < 3; ++i) edges.push_back(std::minmax({triangle[i], triangle[(i + 1) % 3]}));
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint8_t> on_rim(mesh.vertex.size(), 0);
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end] == edges[begin]) ++end;
    const auto [a, b] = edges[begin];
    if (end - begin > 2)
      throw Error(ErrorKind::input,
                  fmt::format("{}: the edge between vertices {} and {} belongs to {} triangles (at most 2)", path, a, b,
                              end - begin));
    if (end - begin == 1) on_rim[a] = on_rim[b] = 1;
  }
  return on_rim;
}

/// Where water may leave. Vertices of no triangle count as outlets: nothing is to happen to them.
std::vector<std::uint8_t> find_outlets(const FillArguments& arguments, const VertexGraph& graph,
                                       const RankedTerrain& terrain, std::vector<std::uint8_t> on_rim) {
  std::vector<std::uint8_t> is_outlet(terrain.height.size(), 0);
  const auto is_used = [&](std::uint32_t v) { return !graph.neighbors(v).empty(); };
  if (arguments.outlets == "hull") {
    is_outlet = std::move(on_rim);
  } else {
    const auto key = [&](std::uint32_t v) { return std::pair(terrain.height[v], terrain.position[v]); };
    std::uint32_t lowest = graph.num_vertices();
    for (std::uint32_t v = 0; v < graph.num_vertices(); ++v)
      if (is_used(v) && (lowest == graph.num_vertices() || key(v) < key(lowest))) lowest = v;
    if (lowest != graph.num_vertices()) is_outlet[lowest] = 1;
  }
  for (std::uint32_t v = 0; v < graph.num_vertices(); ++v)
    if (!is_used(v)) is_outlet[v] = 1;
  return is_outlet;
}

/// For each vertex the number of its pit, or the number of pits.
std::vector<std::uint32_t> pit_of_vertices(const VertexGraph& graph, const RankedTerrain& terrain,
                                           const std::vector<Pit>& pits) {
  const auto none = static_cast<std::uint32_t>(pits.size());
  std::vector<std::uint32_t> pit_of(terrain.height.size(), none), open;
  for (std::uint32_t pit = 0; pit < none; ++pit) {
    open.push_back(static_cast<std::uint32_t>(pits[pit].vertex));
    pit_of[open.back()] = pit;
    while (!open.empty()) {
      const std::uint32_t v = open.back();
      open.pop_back();
      for (const std::uint32_t w : graph.neighbors(v))
        if (terrain.height[w] == terrain.height[v] && pit_of[w] == none) {
          pit_of[w] = pit;
          open.push_back(w);
        }
    }
  }
  return pit_of;
}

/// With --pits all other pits are outlets while lifting: water may stay in them.
std::vector<std::uint8_t> keep_other_pits(const FillArguments& arguments, const VertexGraph& graph,
                                          const RankedTerrain& terrain, std::vector<std::uint8_t> is_outlet) {
  if (arguments.pits.empty()) return is_outlet;
  const auto pits = find_pits(graph, terrain.height, terrain.position, is_outlet);
  const auto pit_of = pit_of_vertices(graph, terrain, pits);
  std::vector<std::uint8_t> is_wanted(pits.size() + 1, 0);
  for (const std::uint32_t v : arguments.pits) {
    if (v >= pit_of.size())
      throw Error(ErrorKind::config, fmt::format("--pits: vertex {} does not exist: there are {}", v, pit_of.size()));
    if (pit_of[v] == pits.size()) throw Error(ErrorKind::config, fmt::format("--pits: vertex {} lies in no pit", v));
    is_wanted[pit_of[v]] = 1;
  }
  for (std::size_t v = 0; v < pit_of.size(); ++v)
    if (pit_of[v] != pits.size() && is_wanted[pit_of[v]] == 0) is_outlet[v] = 1;
  return is_outlet;
}

struct FillResult {
  std::uint64_t minima_before = 0, minima_after = 0, moved = 0;
  double total = 0, most = 0;
};

FillResult apply_levels(Mesh& mesh, const RankedTerrain& terrain, const std::vector<std::int32_t>& level) {
  FillResult result;
  for (std::size_t v = 0; v < mesh.vertex.size(); ++v) {
    if (level[v] == terrain.height[v]) continue;
    double& z = mesh.vertex[v][2];
    const double lifted = terrain.level[static_cast<std::size_t>(level[v])];
    ++result.moved;
    result.total += lifted - z;
    result.most = std::max(result.most, lifted - z);
    z = lifted;
  }
  return result;
}

void require_known(const std::string& option, const std::string& text, const std::vector<std::string>& known,
                   const std::string& more) {
  if (std::find(known.begin(), known.end(), text) != known.end()) return;
  throw Error(ErrorKind::config,
              fmt::format("{}: '{}' is not possible (allowed: {}{})", option, text, fmt::join(known, ", "), more));
}

int fill(const FillArguments& arguments) {
  require_known("--method", arguments.method, {"lift"}, " in this version");
  require_known("--measure", arguments.measure, {"total", "max", "count", "volume"}, "");
  require_known("--outlets", arguments.outlets, {"hull", "lowest"}, " in this version");
  Mesh mesh = read_mesh(arguments.tin);
  const RankedTerrain terrain = rank(mesh);
  const auto on_rim = checked_rim(arguments.tin, mesh, terrain);
  std::vector<std::uint32_t> corners;
  for (const auto& triangle : mesh.triangle) corners.insert(corners.end(), triangle.begin(), triangle.end());
  const VertexGraph graph = make_vertex_graph(static_cast<std::uint32_t>(mesh.vertex.size()), corners);
  const auto is_outlet = find_outlets(arguments, graph, terrain, on_rim);
  const auto level = lift(graph, terrain.height, keep_other_pits(arguments, graph, terrain, is_outlet));
  for (std::size_t v = 0; v < level.size(); ++v)
    if (level[v] == kNoLevel)
      throw Error(ErrorKind::input,
                  fmt::format("{}: no path leads from vertex {} to an outlet: the terrain is in several pieces "
                              "(use --outlets hull)",
                              arguments.tin, v));
  FillResult result = apply_levels(mesh, terrain, level);
  result.minima_before = count_pits(graph, terrain.height, is_outlet);
  result.minima_after = count_pits(graph, level, is_outlet);
  if (!arguments.out.empty()) write_ply(arguments.out, mesh.vertex, mesh.triangle, mesh.crs_wkt);
  if (!arguments.json) {
    fmt::print("vertices            {}\nminima before       {}\nminima after        {}\nvertices moved      {}\n",
               mesh.vertex.size(), result.minima_before, result.minima_after, result.moved);
    fmt::print("total displacement  {}\nmax displacement    {}\n", result.total, result.most);
    return 0;
  }
  nlohmann::ordered_json heights = nlohmann::ordered_json::array();
  for (const auto& vertex : mesh.vertex) heights.push_back(vertex[2]);
  const nlohmann::ordered_json json = {{"vertices", mesh.vertex.size()},
                                       {"minima_before", result.minima_before},
                                       {"minima_after", result.minima_after},
                                       {"vertices_moved", result.moved},
                                       {"total_displacement", result.total},
                                       {"max_displacement", result.most},
                                       {"heights", heights}};
  fmt::print("{}\n", json.dump());
  return 0;
}

}  // namespace

void add_fill_command(CLI::App& program, Action& action) {
  auto arguments = std::make_shared<FillArguments>();
  CLI::App* command = program.add_subcommand("fill", "remove the pits of one TIN in memory");
  command->add_option("tin", arguments->tin, "PLY or OBJ")->required()->type_name("TIN");
  command->add_option("--method", arguments->method, "lift")->capture_default_str();
  command->add_option("--measure", arguments->measure, "total, max, count or volume: lifting is best for all of them")
      ->capture_default_str();
  command
      ->add_option("--outlets", arguments->outlets,
                   "hull: water may leave at the rim; lowest: at the lowest vertex only")
      ->capture_default_str();
  command->add_option("--pits", arguments->pits, "remove only the pits of these vertices")
      ->delimiter(',')
      ->type_name("V,V,...");
  command->add_option("--out", arguments->out, "write the lifted TIN")->type_name("TIN.ply");
  command->add_flag("--json", arguments->json, "print JSON");
  command->callback([arguments, &action] { action = [arguments] { return fill(*arguments); }; });
}

}  // namespace hydrotin::app
