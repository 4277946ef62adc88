#include "hydrotin/river_profiles.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "hydrotin/vertex_graph.h"

namespace hydrotin {
namespace {

constexpr auto kNone = static_cast<std::uint32_t>(-1);

double length_of(const RiverTerrain& terrain, const RiverEdge& edge) {
  const auto &a = terrain.position[edge.from], &b = terrain.position[edge.to];
  return std::hypot(b[0] - a[0], b[1] - a[1]);
}

// Vertices that moved, by the river that reaches them first over others that moved.
std::vector<std::uint32_t> spread(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                  std::span<const std::uint32_t> river, const std::vector<double>& change) {
  std::vector<std::uint32_t> of(terrain.num_vertices(), kNone);
  for (std::size_t e = 0; e < rivers.size(); ++e)
    for (const std::uint32_t v : {rivers[e].from, rivers[e].to}) of[v] = std::min(of[v], river[e]);
  const VertexGraph graph = make_vertex_graph(terrain.num_vertices(), terrain.triangle);
  std::vector<std::uint32_t> ring, next;
  for (std::uint32_t v = 0; v < of.size(); ++v)
    if (of[v] != kNone) ring.push_back(v);
  while (!ring.empty()) {
    next.clear();
    std::sort(ring.begin(), ring.end(), [&](std::uint32_t a, std::uint32_t b) { return of[a] < of[b]; });
    for (const std::uint32_t v : ring)
      for (const std::uint32_t w : graph.neighbors(v)) {
        if (of[w] != kNone || change[w] == 0) continue;
        of[w] = of[v];
        next.push_back(w);
      }
    ring.swap(next);
  }
  return of;
}

}  // namespace

std::vector<RiverRow> river_table(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                  std::span<const std::uint32_t> river, std::uint32_t num_rivers,
                                  std::span<const double> after, double tolerance) {
  return river_table(terrain, rivers, river, num_rivers, after, tolerance,
                     river_faults(terrain, rivers, terrain.height, tolerance),
                     river_faults(terrain, rivers, after, tolerance));
}

std::vector<RiverRow> river_table(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                  std::span<const std::uint32_t> river, std::uint32_t num_rivers,
                                  std::span<const double> after, double tolerance, const RiverFaults& old,
                                  const RiverFaults& now) {
  std::vector<RiverRow> table(num_rivers);
  std::vector<std::uint32_t> at_source(terrain.num_vertices(), kNone);
  for (std::size_t e = 0; e < rivers.size(); ++e) {
    const auto [from, to] = rivers[e];
    RiverRow& row = table[river[e]];
    ++row.edges;
    row.length += length_of(terrain, rivers[e]);
    row.drop_before += terrain.height[from] - terrain.height[to];
    row.drop_after += after[from] - after[to];
    row.wrong_flow_before += old.wrong_flow[e];
    row.not_valley_before += old.not_valley[e];
    row.flat_before += old.flat[e];
    row.wrong_flow_after += now.wrong_flow[e];
    row.not_valley_after += now.not_valley[e];
    row.flat_after += now.flat[e];
    at_source[from] = std::min(at_source[from], river[e]);
  }
  for (const std::uint32_t v : old.leak_vertex) ++table[at_source[v]].leaks_before;
  for (const std::uint32_t v : now.leak_vertex) ++table[at_source[v]].leaks_after;
  std::vector<double> change(terrain.num_vertices());
  for (std::size_t v = 0; v < change.size(); ++v) {
    change[v] = std::abs(after[v] - terrain.height[v]);
    if (!(change[v] > tolerance)) change[v] = 0;
  }
  const auto of = spread(terrain, rivers, river, change);
  for (std::size_t v = 0; v < change.size(); ++v) {
    if (change[v] == 0 || of[v] == kNone) continue;
    RiverRow& row = table[of[v]];
    ++row.moved;
    row.total += change[v];
    row.largest = std::max(row.largest, change[v]);
  }
  return table;
}

MainStems main_stems(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                     std::span<const std::uint32_t> river, std::uint32_t num_rivers) {
  // Edges of each river, by (x, y).
  std::vector<std::uint32_t> order(rivers.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(river[a], terrain.position[rivers[a].from], terrain.position[rivers[a].to]) <
           std::tuple(river[b], terrain.position[rivers[b].from], terrain.position[rivers[b].to]);
  });
  MainStems stems;
  std::vector<double> longest(terrain.num_vertices(), 0);
  std::vector<std::uint32_t> above(terrain.num_vertices(), kNone), num_in(terrain.num_vertices(), 0);
  std::vector<std::uint32_t> first_out(terrain.num_vertices(), kNone), next_out(rivers.size(), kNone);
  std::size_t i = 0;
  for (std::uint32_t g = 0; g < num_rivers; ++g) {
    const std::size_t begin = i;
    std::vector<std::uint32_t> touched, open;
    for (; i < order.size() && river[order[i]] == g; ++i) {
      const auto [from, to] = rivers[order[i]];
      ++num_in[to];
      next_out[order[i]] = first_out[from];
      first_out[from] = order[i];
      touched.insert(touched.end(), {from, to});
    }
    for (std::size_t k = begin; k < i; ++k)
      if (num_in[rivers[order[k]].from] == 0 && (open.empty() || open.back() != rivers[order[k]].from))
        open.push_back(rivers[order[k]].from);
    std::uint32_t best = kNone;
    while (!open.empty()) {
      const std::uint32_t v = open.back();
      open.pop_back();
      if (first_out[v] == kNone && (best == kNone || longest[v] > longest[best] ||
                                    (longest[v] == longest[best] && terrain.position[v] < terrain.position[best])))
        best = v;
      for (std::uint32_t e = first_out[v]; e != kNone; e = next_out[e]) {
        const std::uint32_t w = rivers[e].to;
        const double length = longest[v] + length_of(terrain, rivers[e]);
        if (length > longest[w] ||
            (length == longest[w] && above[w] != kNone && terrain.position[v] < terrain.position[above[w]])) {
          longest[w] = length;
          above[w] = v;
        }
        if (--num_in[w] == 0) open.push_back(w);
      }
    }
    const auto start = static_cast<std::ptrdiff_t>(stems.vertex.size());
    for (std::uint32_t v = best; v != kNone; v = above[v]) stems.vertex.push_back(v);
    std::reverse(stems.vertex.begin() + start, stems.vertex.end());
    stems.begin.push_back(stems.vertex.size());
    for (const std::uint32_t v : touched) {
      longest[v] = 0;
      above[v] = first_out[v] = kNone;
      num_in[v] = 0;
    }
  }
  return stems;
}

}  // namespace hydrotin
