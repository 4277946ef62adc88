#include "embed_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "edge_list.h"
#include "fill_terrain.h"
#include "hydrotin/crs.h"
#include "hydrotin/error.h"
#include "hydrotin/river_lakes.h"
#include "lake_vertices.h"

namespace hydrotin::app {
namespace {

constexpr std::size_t kMostNamed = 20;

/// All edges of some triangles.
class TerrainEdges {
 public:
  explicit TerrainEdges(const std::vector<std::uint32_t>& triangle) {
    for (std::size_t t = 0; t < triangle.size(); t += 3)
      for (std::size_t i = 0; i < 3; ++i) edges_.push_back(std::minmax({triangle[t + i], triangle[t + (i + 1) % 3]}));
    std::sort(edges_.begin(), edges_.end());
  }
  [[nodiscard]] bool contains(std::uint32_t a, std::uint32_t b) const {
    return std::binary_search(edges_.begin(), edges_.end(),
                              std::pair<std::uint32_t, std::uint32_t>(std::minmax({a, b})));
  }

 private:
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;
};

/// Refuses what is no terrain: two vertices at one place, a triangle without area, an edge of three triangles.
void check_terrain(const std::string& path, const EmbedInput& input) {
  std::vector<std::uint32_t> order(input.position.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return input.position[a] < input.position[b]; });
  for (std::size_t i = 1; i < order.size(); ++i)
    if (input.position[order[i]] == input.position[order[i - 1]])
      throw Error(ErrorKind::input,
                  fmt::format("{}: vertices {} and {} have the same x and y (a terrain has one height at a place)",
                              path, std::min(order[i], order[i - 1]), std::max(order[i], order[i - 1])));
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t t = 0; t < input.triangle.size(); t += 3) {
    const std::array<std::uint32_t, 3> v = {input.triangle[t], input.triangle[t + 1], input.triangle[t + 2]};
    const auto &a = input.position[v[0]], &b = input.position[v[1]], &c = input.position[v[2]];
    if ((b[0] - a[0]) * (c[1] - a[1]) == (b[1] - a[1]) * (c[0] - a[0]))
      throw Error(ErrorKind::input, fmt::format("{}: triangle {} ({}, {}, {}) has no area seen from above (remove it)",
                                                path, t / 3, v[0], v[1], v[2]));
    for (std::size_t i = 0; i < 3; ++i) edges.push_back(std::minmax(v[i], v[(i + 1) % 3]));
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 2; i < edges.size(); ++i)
    if (edges[i] == edges[i - 2])
      throw Error(ErrorKind::input,
                  fmt::format("{}: the edge between vertices {} and {} belongs to more than 2 triangles", path,
                              edges[i].first, edges[i].second));
}

void check_rivers(const std::string& tin, const EmbedInput& input) {
  const NetworkCheck check = check_network(input.terrain(), input.rivers);
  const auto name = [&](std::size_t i) { return input.name_of(check.edge[i]); };
  const auto fail = [&](const std::string& what) { throw Error(ErrorKind::input, input.rivers_path + ": " + what); };
  switch (check.fault) {
    case NetworkFault::none:
      return;
    case NetworkFault::no_vertex:
      fail(name(0) + " does not join two vertices (write two different indices)");
      return;
    case NetworkFault::no_edge:
      fail(fmt::format("{} is not an edge of {} (rivers run along edges; use --rivers to snap lines to them)", name(0),
                       tin));
      return;
    case NetworkFault::repeated:
      fail(fmt::format("{} comes twice (rows {} and {} after the header; remove one)", name(0), check.edge[0] + 1,
                       check.edge[1] + 1));
      return;
    case NetworkFault::directed_cycle:
      break;
  }
  std::string way = std::to_string(input.rivers[check.edge[0]].from);
  for (std::size_t i = 0; i < check.edge.size() && i < kMostNamed; ++i)
    way += fmt::format(" -> {}", input.rivers[check.edge[i]].to);
  if (check.edge.size() > kMostNamed) way += " -> ...";
  fail(fmt::format("the {} river edges {} make a directed cycle: water cannot flow in a circle (turn or remove one)",
                   check.edge.size(), way));
}

}  // namespace

double EmbedInput::length(const RiverEdge& edge) const {
  const auto &a = position[edge.from], &b = position[edge.to];
  return std::hypot(b[0] - a[0], b[1] - a[1]);
}

std::uint64_t EmbedInput::num_river_vertices() const {
  std::vector<std::uint32_t> ends;
  for (const auto& [from, to] : rivers) ends.insert(ends.end(), {from, to});
  std::sort(ends.begin(), ends.end());
  return static_cast<std::uint64_t>(std::unique(ends.begin(), ends.end()) - ends.begin());
}

std::uint64_t EmbedInput::num_wingtips() const {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& [from, to] : rivers) edges.push_back(std::minmax(from, to));
  std::sort(edges.begin(), edges.end());
  std::uint64_t count = 0;
  for (const auto& t : mesh.triangle)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::pair<std::uint32_t, std::uint32_t> edge = std::minmax(t[i], t[(i + 1) % 3]);
      count += std::binary_search(edges.begin(), edges.end(), edge) ? 1 : 0;
    }
  return count;
}

std::string EmbedInput::name_of(std::uint32_t edge) const {
  return fmt::format("the river edge {} -> {}", rivers[edge].from, rivers[edge].to);
}

void EmbedInput::refresh() {
  position.clear();
  height.clear();
  triangle.clear();
  for (const auto& vertex : mesh.vertex) {
    position.push_back({vertex[0], vertex[1]});
    height.push_back(vertex[2]);
  }
  for (const auto& t : mesh.triangle) triangle.insert(triangle.end(), t.begin(), t.end());
}

namespace {

/// Edges of the TIN as it was given: before lines are inserted.
void add_preserved(const EmbedArguments& arguments, const EmbedInput& input, RiverConstraints& constraints) {
  if (arguments.preserve_edges.empty()) return;
  const TerrainEdges edges(input.triangle);
  for (const auto& [a, b] : read_edges(arguments.preserve_edges, input.num_given)) {
    if (!edges.contains(a, b))
      throw Error(ErrorKind::input, fmt::format("{}: {}, {} is not an edge of {} (write edges of the TIN)",
                                                arguments.preserve_edges, a, b, arguments.tin));
    constraints.preserve.push_back({a, b, arguments.preserve != "curvature", arguments.preserve != "drainage"});
  }
}

/// Lakes through which rivers come back become one level.
void join_lakes(EmbedInput& input, RiverConstraints& constraints) {
  if (constraints.lakes.empty()) return;
  ClosedLakes closed = close_lakes(input.terrain(), input.rivers, constraints.lakes);
  constraints.lakes = std::move(closed.lake);
  if (!input.lines) return;
  input.lines->counts.emplace_back("lakes", constraints.lakes.size());
  input.lines->counts.emplace_back("lakes_joined", closed.joined_lakes);
  input.lines->counts.emplace_back("vertices_joined_to_lakes", closed.joined_vertices);
}

/// By the policy, and lakes that no river leaves.
void find_outlet_vertices(const EmbedArguments& arguments, EmbedInput& input, const RiverConstraints& constraints) {
  const std::string policy = arguments.outlets.empty() ? "hull" : arguments.outlets;
  input.is_outlet =
      find_outlets(arguments.tin, {policy, input.mesh.crs_wkt, {}}, make_fill_terrain(arguments.tin, input.mesh));
  const auto lake = lake_numbers(static_cast<std::uint32_t>(input.position.size()), constraints.lakes);
  add_closed_lakes(input.rivers, lake, input.is_outlet);
  for (const RiverMouth& mouth : input.mouths.mouth)
    if (mouth.kind == MouthKind::closed) input.is_outlet[mouth.vertex] = 1;
}

/// An edge that an inserted line or a Steiner point cut has no type any more.
void drop_cut_edges(const EmbedInput& input, RiverConstraints& constraints) {
  if (constraints.preserve.empty()) return;
  const TerrainEdges edges(input.triangle);
  const std::size_t cut =
      std::erase_if(constraints.preserve, [&](const PreservedEdge& edge) { return !edges.contains(edge.a, edge.b); });
  if (cut > 0)
    fmt::print(stderr,
               "hydrotin: {} edges to be preserved were cut by inserted lines or by Steiner points between rivers\n",
               cut);
}

/// Mouths, chains to outlets, and wingtips that are free to rise.
void prepare_mouths(const EmbedArguments& arguments, EmbedInput& input, RiverConstraints& constraints) {
  find_outlet_vertices(arguments, input, constraints);
  input.mouths = find_outlet_chains(input.terrain(), input.rivers, input.is_outlet,
                                    lake_numbers(static_cast<std::uint32_t>(input.position.size()), constraints.lakes));
  constraints.chain = input.mouths.edge;
  for (const RiverMouth& mouth : input.mouths.mouth)
    if (mouth.kind == MouthKind::closed) input.is_outlet[mouth.vertex] = 1;
  if (!input.lines) return;
  auto& counts = input.lines->counts;
  count_mouths(input.mouths, counts);
  const auto lake = lake_numbers(static_cast<std::uint32_t>(input.position.size()), constraints.lakes);
  const auto [points, left] = clear_mesh_wingtips(arguments.tin, input.mesh, input.rivers, input.mouths.edge, lake);
  counts.emplace_back("steiner_points", points);
  counts.emplace_back("triangles_too_small", left);
  input.refresh();
  find_outlet_vertices(arguments, input, constraints);
  drop_cut_edges(input, constraints);
}

}  // namespace

EmbedInput read_embed_input(const EmbedArguments& arguments, RiverConstraints& constraints) {
  EmbedInput input;
  input.mesh = read_mesh(arguments.tin);
  if (!arguments.crs.empty()) input.mesh.crs_wkt = parse_crs(arguments.crs, "--crs").wkt;
  input.refresh();
  input.num_given = static_cast<std::uint32_t>(input.position.size());
  check_terrain(arguments.tin, input);
  add_preserved(arguments, input, constraints);
  if (!arguments.rivers.empty()) {
    input.rivers_path = arguments.rivers;
    input.lines = match_lines(arguments, input.mesh);
    input.rivers = input.lines->rivers;
    input.refresh();
  } else {
    input.rivers_path = arguments.river_edges;
    for (const auto& [from, to] : read_edges(arguments.river_edges, input.position.size()))
      input.rivers.push_back({from, to});
  }
  check_rivers(arguments.tin, input);
  std::string missing_wkt;
  if (!arguments.rivers_crs.empty()) missing_wkt = parse_crs(arguments.rivers_crs, "--rivers-crs").wkt;
  if (!arguments.lakes.empty())
    constraints.lakes =
        read_lakes(arguments.lakes, input.position, input.mesh.crs_wkt, missing_wkt, arguments.lake_level);
  join_lakes(input, constraints);
  drop_cut_edges(input, constraints);
  if (arguments.wants_chains()) prepare_mouths(arguments, input, constraints);
  return input;
}

}  // namespace hydrotin::app
