#include "fill_terrain.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

#include "hydrotin/error.h"
#include "hydrotin/outlets.h"
#include "hydrotin/pit_removal.h"
#include "hydrotin/pits.h"
#include "hydrotin/place_layer.h"
#include "hydrotin/rasterize.h"
#include "plane_lattice.h"

namespace hydrotin::app {
namespace {

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

/// Twice the area of a triangle; its sign says how it turns.
std::int64_t doubled_area(const std::vector<LatticePoint>& p, const std::uint32_t* v) {
  return (std::int64_t{p[v[1]].x} - p[v[0]].x) * (std::int64_t{p[v[2]].y} - p[v[0]].y) -
         (std::int64_t{p[v[1]].y} - p[v[0]].y) * (std::int64_t{p[v[2]].x} - p[v[0]].x);
}

bool are_distinct(std::vector<LatticePoint> position) {
  std::sort(position.begin(), position.end());
  return std::adjacent_find(position.begin(), position.end()) == position.end();
}

void set_ranks(const Mesh& mesh, FillTerrain& terrain) {
  const auto xs = sorted_values(mesh, 0), ys = sorted_values(mesh, 1);
  terrain.position.clear();
  for (const auto& vertex : mesh.vertex) terrain.position.push_back({rank_of(xs, vertex[0]), rank_of(ys, vertex[1])});
}

/// Positions and triangles; on a lattice if that keeps them what they are.
void set_plane(const Mesh& mesh, FillTerrain& terrain) {
  constexpr double kFarthest = 1e15;
  for (const auto& t : mesh.triangle) terrain.triangle.insert(terrain.triangle.end(), t.begin(), t.end());
  std::vector<std::array<double, 2>> plane;
  plane.reserve(mesh.vertex.size());
  for (const auto& v : mesh.vertex) {
    plane.push_back({v[0], v[1]});
    if (std::abs(v[0]) > kFarthest || std::abs(v[1]) > kFarthest) return set_ranks(mesh, terrain);
  }
  const PlaneLattice lattice = find_lattice(plane);
  for (const auto& p : plane) terrain.position.push_back(lattice.nearest(p[0], p[1]));
  terrain.has_lattice = are_distinct(terrain.position);
  std::size_t num_left = 0, num_right = 0;
  for (std::size_t t = 0; t < terrain.triangle.size(); t += 3) {
    std::uint32_t* v = &terrain.triangle[t];
    const auto &a = plane[v[0]], &b = plane[v[1]], &c = plane[v[2]];
    const double exact = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    const std::int64_t rounded = doubled_area(terrain.position, v);
    num_left += rounded > 0;
    num_right += rounded < 0;
    if (!lattice.is_exact && ((exact > 0 && rounded <= 0) || (exact < 0 && rounded >= 0))) terrain.has_lattice = false;
  }
  for (std::size_t t = 0; t < terrain.triangle.size(); t += 3) {
    std::uint32_t* v = &terrain.triangle[t];
    const std::int64_t area = doubled_area(terrain.position, v);
    if (area < 0 || (area == 0 && num_right > num_left)) std::swap(v[1], v[2]);
  }
  terrain.lattice.scale_xy = 1 / lattice.denominator;
  terrain.lattice.base_x = lattice.base_x;
  terrain.lattice.base_y = lattice.base_y;
  if (!terrain.has_lattice) set_ranks(mesh, terrain);
}

/// Whether all heights are integers over `denominator`, their differences within 31 bits; exactly, or but for the last
/// bits that a product with a scale leaves.
bool fits(const std::vector<double>& values, std::int64_t denominator, bool exactly) {
  const auto d = static_cast<double>(denominator);
  if ((values.back() - values.front()) * d >= 2147483000.0) return false;
  return std::all_of(values.begin(), values.end(), [&](double z) {
    const double scaled = std::round(z * d);
    if (std::abs(scaled) >= 9007199254740992.0) return false;
    return exactly ? scaled / d == z : std::abs(scaled / d - z) <= 4e-16 * std::max(std::abs(z), 1.0);
  });
}

/// Heights become integers: decimals if they are, binary fractions if they are, else the finest decimals that fit.
void set_heights(const std::string& path, const Mesh& mesh, FillTerrain& terrain) {
  const std::vector<double> values = sorted_values(mesh, 2);
  if (values.empty()) return;
  if (std::max(std::abs(values.front()), std::abs(values.back())) > 1e15 || values.back() - values.front() > 1e9)
    throw Error(ErrorKind::input, fmt::format("{}: heights from {} to {} are no terrain (at most 1e15, and 1e9 apart)",
                                              path, values.front(), values.back()));
  std::vector<std::int64_t> candidates;
  for (std::int64_t d = 100; d <= 1'000'000'000'000; d *= 10) candidates.push_back(d);
  candidates.insert(candidates.end(), {10, 1});  // centimetres if they fit: a best surface may lie between heights
  for (int bit = 1; bit <= 40; ++bit) candidates.push_back(std::int64_t{1} << bit);
  auto found =
      std::find_if(candidates.begin(), candidates.end(), [&](std::int64_t d) { return fits(values, d, true); });
  terrain.is_exact = found != candidates.end();
  if (!terrain.is_exact)
    found = std::find_if(candidates.begin(), candidates.end(), [&](std::int64_t d) { return fits(values, d, false); });
  terrain.is_rounded = found == candidates.end();
  terrain.denominator = terrain.is_rounded ? 1 : *found;
  const double largest = std::max(std::abs(values.front()), std::abs(values.back()));
  while (terrain.is_rounded && terrain.denominator < 1'000'000'000 &&
         (values.back() - values.front()) * static_cast<double>(terrain.denominator) * 10 < 2e9 &&
         largest * static_cast<double>(terrain.denominator) * 10 < 9e15)
    terrain.denominator *= 10;
  const auto scaled = [&](double z) {
    return static_cast<std::int64_t>(std::round(z * static_cast<double>(terrain.denominator)));
  };
  terrain.base = scaled(values.front());
  terrain.lattice.scale_z = terrain.quantum();
  terrain.lattice.base_z = terrain.base;
  for (const auto& vertex : mesh.vertex)
    terrain.height.push_back(static_cast<std::int32_t>(scaled(vertex[2]) - terrain.base));
}

void refuse_doubled_places(const std::string& path, const FillTerrain& terrain) {
  std::vector<std::pair<LatticePoint, std::uint32_t>> places;
  for (std::uint32_t v = 0; v < terrain.position.size(); ++v) places.emplace_back(terrain.position[v], v);
  std::sort(places.begin(), places.end());
  for (std::size_t i = 1; i < places.size(); ++i)
    if (places[i].first == places[i - 1].first)
      throw Error(ErrorKind::input,
                  fmt::format("{}: vertices {} and {} have the same x and y (a terrain has one height at a place)",
                              path, places[i - 1].second, places[i].second));
}

std::vector<std::uint8_t> checked_rim(const std::string& path, const Mesh& mesh) {
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

/// Exact if no cost can overflow, else to 24 bits.
void set_weights(const Mesh& mesh, FillTerrain& terrain) {
  if (terrain.has_lattice) {
    terrain.weight = star_weights(terrain.position, terrain.triangle);
    terrain.area_unit = terrain.lattice.scale_xy * terrain.lattice.scale_xy / 2;
    double sum = 0;
    for (const std::int64_t w : terrain.weight) sum += static_cast<double>(w);
    const std::int32_t relief =
        terrain.height.empty() ? 0 : *std::max_element(terrain.height.begin(), terrain.height.end());
    if (sum * std::max(relief, 1) < 4e18) return;
    terrain.weight.clear();
  }
  std::vector<double> star(mesh.vertex.size(), 0);
  for (const auto& t : mesh.triangle) {
    const auto &a = mesh.vertex[t[0]], &b = mesh.vertex[t[1]], &c = mesh.vertex[t[2]];
    const double area = std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    for (const std::uint32_t v : t) star[v] += area;
  }
  const double largest = star.empty() ? 0 : *std::max_element(star.begin(), star.end());
  terrain.area_unit = largest > 0 ? largest / (1 << 24) : 1;
  for (const double area : star)
    terrain.weight.push_back(std::max<std::int64_t>(1, std::llround(area / terrain.area_unit)));
}

/// The vertices named in a CSV file: a header line, then one or two indices a line.
std::vector<std::uint8_t> read_outlets(const std::string& file, std::size_t num_vertices) {
  std::ifstream stream(file);
  if (!stream) throw Error(ErrorKind::input, fmt::format("--outlets: cannot read {}", file));
  std::vector<std::uint8_t> is_outlet(num_vertices, 0);
  std::string line;
  const auto bad = [&](std::size_t number, const std::string& what) {
    return Error(ErrorKind::input,
                 fmt::format("{}:{}: {}: expected one or two vertex indices below {} (0-based, separated "
                             "by a comma)",
                             file, number, what, num_vertices));
  };
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    if (line.size() > 1000 || line.find('\0') != std::string::npos) throw bad(number, "no line of a CSV file");
    if (number == 1) continue;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (line.empty()) continue;
    const char *at = line.data(), *const end = line.data() + line.size();
    for (int column = 0;; ++column) {
      while (at != end && *at == ' ') ++at;
      std::uint32_t v = 0;
      const auto [stop, error] = std::from_chars(at, end, v);
      if (error != std::errc{} || v >= num_vertices || column == 2)
        throw bad(number, fmt::format("'{}'", std::string(line, 0, 60)));
      is_outlet[v] = 1;
      at = stop;
      while (at != end && *at == ' ') ++at;
      if (at == end) break;
      if (*at++ != ',') throw bad(number, fmt::format("'{}'", std::string(line, 0, 60)));
    }
  }
  return is_outlet;
}

}  // namespace

RankedHeights rank_heights(const Mesh& mesh) {
  RankedHeights ranked{sorted_values(mesh, 2), {}};
  for (const auto& vertex : mesh.vertex) ranked.height.push_back(rank_of(ranked.level, vertex[2]));
  return ranked;
}

FillTerrain make_fill_terrain(const std::string& path, const Mesh& mesh) {
  FillTerrain terrain;
  set_plane(mesh, terrain);
  refuse_doubled_places(path, terrain);
  terrain.on_rim = checked_rim(path, mesh);
  set_heights(path, mesh, terrain);
  set_weights(mesh, terrain);
  terrain.graph = make_vertex_graph(static_cast<std::uint32_t>(mesh.vertex.size()), terrain.triangle);
  return terrain;
}

void require_lattice(const std::string& path, const FillTerrain& terrain, const std::string& what) {
  if (!terrain.has_lattice)
    throw Error(
        ErrorKind::input,
        fmt::format("{}: {} needs exact places, but its vertices lie closer together than {} of its width, which "
                    "is the finest that can be told apart (write it with fewer digits)",
                    path, what, 1.0 / (1 << 30)));
  std::vector<DirectedEdge> edge;
  edge.reserve(terrain.triangle.size());
  for (std::size_t h = 0; h < terrain.triangle.size(); ++h)
    edge.push_back({terrain.triangle[h], terrain.triangle[h % 3 == 2 ? h - 2 : h + 1]});
  std::sort(edge.begin(), edge.end());
  const auto twice = std::adjacent_find(edge.begin(), edge.end());
  if (twice != edge.end())
    throw Error(ErrorKind::input,
                fmt::format("{}: two triangles lie on the same side of the edge between vertices {} and {} ({} needs a "
                            "terrain without overhangs)",
                            path, twice->origin, twice->target, what));
}

std::vector<std::uint8_t> find_outlets(const std::string& path, const OutletChoice& choice,
                                       const FillTerrain& terrain) {
  const std::string& policy = choice.policy;
  const std::size_t n = terrain.height.size();
  std::vector<std::uint8_t> is_outlet(n, 0);
  if (policy == "hull") {
    is_outlet = terrain.on_rim;
  } else if (policy == "lowest") {
    std::size_t lowest = n;
    const auto key = [&](std::size_t v) { return std::pair(terrain.height[v], terrain.position[v]); };
    for (std::size_t v = 0; v < n; ++v)
      if (!terrain.graph.neighbors(static_cast<std::uint32_t>(v)).empty() && (lowest == n || key(v) < key(lowest)))
        lowest = v;
    if (lowest != n) is_outlet[lowest] = 1;
  } else if (!policy.starts_with("/vsi") && !std::filesystem::exists(policy)) {
    throw Error(ErrorKind::config,
                fmt::format("--outlets: '{}' is neither hull nor lowest, and no such file exists", policy));
  } else if (policy.ends_with(".csv") || policy.ends_with(".txt")) {
    is_outlet = read_outlets(policy, n);
  } else {
    require_lattice(path, terrain, "--outlets with a layer");
    PlaceLayer(policy, terrain.lattice, choice.crs_wkt, false)
        .mark(terrain.position, terrain.height, terrain.triangle, is_outlet);
  }
  if (choice.void_edge) {
    require_lattice(path, terrain, "--voids-drain");
    mark_void_corners(terrain.position, terrain.triangle, squared_edge_limit(*choice.void_edge, terrain.lattice),
                      is_outlet);
  }
  for (std::uint32_t v = 0; v < n; ++v)
    if (terrain.graph.neighbors(v).empty()) is_outlet[v] = 1;
  if (n > 0 && !std::count(is_outlet.begin(), is_outlet.end(), 1))
    throw Error(ErrorKind::input, fmt::format("{}: it names no vertex of {}, so water could leave nowhere (check its "
                                              "CRS and place, or use --outlets hull)",
                                              policy, path));
  const auto dry = pieces_without_outlet(terrain.graph, terrain.position, is_outlet);
  if (!dry.empty())
    throw Error(
        ErrorKind::input,
        fmt::format("{}: no path leads from vertex {} to an outlet: the terrain is in several pieces and {} of them "
                    "{} none (use --outlets hull, or name vertices in each)",
                    path, dry.front(), dry.size(), dry.size() == 1 ? "has" : "have"));
  return is_outlet;
}

std::vector<std::uint8_t> keep_other_pits(const std::vector<std::uint32_t>& wanted, const FillTerrain& terrain,
                                          std::vector<std::uint8_t> is_outlet) {
  if (wanted.empty()) return is_outlet;
  const auto pits = find_pits(terrain.graph, terrain.height, terrain.position, is_outlet);
  const auto none = static_cast<std::uint32_t>(pits.size());
  std::vector<std::uint32_t> pit_of(terrain.height.size(), none), open;
  for (std::uint32_t pit = 0; pit < none; ++pit) {
    open.push_back(static_cast<std::uint32_t>(pits[pit].vertex));
    pit_of[open.back()] = pit;
    while (!open.empty()) {
      const std::uint32_t v = open.back();
      open.pop_back();
      for (const std::uint32_t w : terrain.graph.neighbors(v)) {
        if (terrain.height[w] != terrain.height[v] || pit_of[w] != none) continue;
        pit_of[w] = pit;
        open.push_back(w);
      }
    }
  }
  std::vector<std::uint8_t> is_wanted(pits.size(), 0);
  for (const std::uint32_t v : wanted) {
    if (v >= pit_of.size())
      throw Error(ErrorKind::config, fmt::format("--pits: vertex {} does not exist: there are {}", v, pit_of.size()));
    if (pit_of[v] == none)
      throw Error(ErrorKind::config,
                  fmt::format("--pits: vertex {} lies in no pit{}", v, is_outlet[v] ? " (it is an outlet)" : ""));
    is_wanted[pit_of[v]] = 1;
  }
  for (std::size_t v = 0; v < pit_of.size(); ++v)
    if (pit_of[v] != none && !is_wanted[pit_of[v]]) is_outlet[v] = 1;
  return is_outlet;
}

}  // namespace hydrotin::app
