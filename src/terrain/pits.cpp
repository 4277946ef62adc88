#include "hydrotin/pits.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>

#include "radix_sort.h"
#include "union_find.h"

namespace hydrotin {
namespace {

/// Calls visit(plateau, drains) for each plateau, `plateau` listing its vertices, the smallest id first.
template <class Visit>
void for_each_plateau(const VertexGraph& graph, std::span<const std::int32_t> height,
                      std::span<const std::uint8_t> is_outlet, Visit visit) {
  std::vector<std::uint8_t> is_seen(height.size(), 0);
  std::vector<std::uint32_t> plateau;
  for (std::uint32_t seed = 0; seed < height.size(); ++seed) {
    if (is_seen[seed]) continue;
    is_seen[seed] = 1;
    plateau.assign(1, seed);
    bool drains = false;
    for (std::size_t next = 0; next < plateau.size(); ++next) {
      const std::uint32_t v = plateau[next];
      drains |= is_outlet[v] != 0;
      for (const std::uint32_t w : graph.neighbors(v)) {
        drains |= height[w] < height[v];
        if (height[w] != height[v] || is_seen[w]) continue;
        is_seen[w] = 1;
        plateau.push_back(w);
      }
    }
    visit(std::span<const std::uint32_t>(plateau), drains);
  }
}

std::uint32_t smallest_by_position(std::span<const std::uint32_t> vertices, std::span<const LatticePoint> position) {
  return *std::min_element(vertices.begin(), vertices.end(),
                           [&](std::uint32_t a, std::uint32_t b) { return position[a] < position[b]; });
}

}  // namespace

std::vector<Pit> find_pits(const VertexGraph& graph, std::span<const std::int32_t> height,
                           std::span<const LatticePoint> position, std::span<const std::uint8_t> is_outlet) {
  assert(height.size() == graph.num_vertices() && is_outlet.size() == height.size() && "one entry per vertex");
  assert(position.size() == height.size() && "one entry per vertex");
  std::vector<Pit> pits;
  for_each_plateau(graph, height, is_outlet, [&](std::span<const std::uint32_t> plateau, bool drains) {
    if (drains) return;
    const std::uint32_t v = smallest_by_position(plateau, position);
    pits.push_back({position[v], v, height[v], plateau.size()});
  });
  std::sort(pits.begin(), pits.end());
  return pits;
}

std::uint64_t count_pits(const VertexGraph& graph, std::span<const std::int32_t> height,
                         std::span<const std::uint8_t> is_outlet) {
  assert(height.size() == graph.num_vertices() && is_outlet.size() == height.size() && "one entry per vertex");
  std::uint64_t count = 0;
  for_each_plateau(graph, height, is_outlet,
                   [&](std::span<const std::uint32_t>, bool drains) { count += drains ? 0 : 1; });
  return count;
}

PlateauSummary summarize_plateaus(const VertexGraph& graph, std::span<const std::int32_t> height,
                                  std::span<const LatticePoint> position, std::span<const std::uint8_t> is_outlet,
                                  std::span<const std::uint64_t> global_id, std::span<const std::uint8_t> is_rim) {
  assert(height.size() == graph.num_vertices() && is_outlet.size() == height.size() && "one entry per vertex");
  assert(position.size() == height.size() && global_id.size() == height.size() && is_rim.size() == height.size());
  PlateauSummary summary;
  summary.rim_begin.push_back(0);
  for_each_plateau(graph, height, is_outlet, [&](std::span<const std::uint32_t> plateau, bool drains) {
    for (const std::uint32_t v : plateau)
      if (is_rim[v]) summary.rim_vertex.push_back(global_id[v]);
    const std::size_t num_rim = summary.rim_vertex.size() - summary.rim_begin.back();
    if (num_rim == 0 && drains) return;
    const std::uint32_t v = smallest_by_position(plateau, position);
    if (num_rim == 0) {
      summary.pit.push_back({position[v], global_id[v], height[v], plateau.size()});
      return;
    }
    summary.representative.push_back(position[v]);
    summary.vertex.push_back(global_id[v]);
    summary.height.push_back(height[v]);
    summary.num_inner.push_back(static_cast<std::uint32_t>(plateau.size() - num_rim));
    summary.drains.push_back(drains);
    summary.rim_begin.push_back(static_cast<std::uint32_t>(summary.rim_vertex.size()));
  });
  std::sort(summary.pit.begin(), summary.pit.end());
  return summary;
}

std::vector<Pit> resolve_plateaus(std::span<const PlateauSummary> parts) {
  struct RimVertex {
    std::uint64_t id;
    std::uint32_t plateau;  // numbered through all parts
  };
  std::vector<RimVertex> rim;
  std::size_t num_plateaus = 0;
  for (const PlateauSummary& part : parts) {
    for (std::size_t i = 0; i < part.num_open(); ++i)
      for (std::uint32_t j = part.rim_begin[i]; j < part.rim_begin[i + 1]; ++j)
        rim.push_back({part.rim_vertex[j], static_cast<std::uint32_t>(num_plateaus + i)});
    num_plateaus += part.num_open();
  }
  assert(num_plateaus < std::numeric_limits<std::uint32_t>::max() && "plateaus are numbered with 32 bits");
  radix_sort(rim, [](const RimVertex& r) { return r.id; });

  UnionFind whole(num_plateaus);
  for (std::size_t i = 1; i < rim.size(); ++i)
    if (rim[i].id == rim[i - 1].id) whole.unite(rim[i].plateau, rim[i - 1].plateau);

  std::vector<Pit> pit(num_plateaus);  // at roots
  std::vector<std::uint8_t> drains(num_plateaus, 0);
  std::uint32_t plateau = 0;
  for (const PlateauSummary& part : parts)
    for (std::size_t i = 0; i < part.num_open(); ++i, ++plateau) {
      const std::uint32_t root = whole.find(plateau);
      drains[root] |= part.drains[i];
      Pit& p = pit[root];
      // The root is the smallest id, so it is met first and fills its slot.
      if (root == plateau || part.representative[i] < p.representative) {
        p.representative = part.representative[i];
        p.vertex = part.vertex[i];
      }
      assert((root == plateau || p.height == part.height[i]) && "parts disagree about the height of a shared vertex");
      p.height = part.height[i];
      p.num_vertices += part.num_inner[i];
    }
  for (std::size_t i = 0; i < rim.size(); ++i)  // a rim vertex counts once, however many parts have it
    if (i == 0 || rim[i].id != rim[i - 1].id) ++pit[whole.find(rim[i].plateau)].num_vertices;

  std::vector<Pit> pits;
  for (std::uint32_t p = 0; p < num_plateaus; ++p)
    if (whole.find(p) == p && !drains[p]) pits.push_back(pit[p]);
  std::sort(pits.begin(), pits.end());
  return pits;
}

}  // namespace hydrotin
