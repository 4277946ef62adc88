#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "block_index.h"
#include "clouds.h"
#include "hydrotin/lifting.h"
#include "hydrotin/triangulation.h"
#include "hydrotin/vertex_graph.h"
#include "mend.h"
#include "phases.h"
#include "schedule.h"
#include "store.h"
#include "tiling_fixture.h"

/// Small terrains cut into the files that `spill` and the phases after it read: points owned through a k-d plan,
/// triangles given to tiles and to either file of a tile in any way at all.

namespace hydrotin::testing {

struct WholeTerrain {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  std::vector<std::uint32_t> triangle;  ///< [3T] counter-clockwise
  std::vector<std::uint8_t> on_hull;
  std::vector<DirectedEdge> hull_edge;

  [[nodiscard]] VertexGraph graph() const {
    return make_vertex_graph(static_cast<std::uint32_t>(position.size()), triangle);
  }
};

inline WholeTerrain make_terrain(std::vector<LatticePoint> points, std::uint64_t seed, std::int32_t levels) {
  WholeTerrain out;
  out.position = distinct(std::move(points));
  out.height = random_heights(seed, out.position.size(), levels);
  const Triangulation dt = delaunay(out.position);
  out.on_hull.assign(out.position.size(), 0);
  for (std::uint32_t h = 0; h < dt.origin.size(); ++h) {
    out.triangle.push_back(dt.origin[h].value);
    if (!dt.twin[h].is_none()) continue;
    const std::uint32_t a = dt.origin[h].value, b = dt.view().target(HalfedgeId{h}).value;
    out.hull_edge.push_back({a, b});
    out.on_hull[a] = out.on_hull[b] = 1;
  }
  return out;
}

/// A tiling of a terrain, with the id of each vertex.
struct CutTerrain {
  RunContext context;
  std::vector<PointId> id;                        ///< [n]
  std::vector<std::vector<std::uint32_t>> owned;  ///< vertices of each tile in the order of its file
  std::vector<std::uint32_t> tile_of_triangle;
};

inline std::uint32_t cut_plan(Plan& plan, const std::vector<LatticePoint>& points, LatticeBox core, int depth,
                              Random& random) {
  const auto node = static_cast<std::uint32_t>(plan.nodes.size());
  plan.nodes.emplace_back();
  if (depth == 0 || points.empty() || (depth < 3 && random.below(6) == 0)) {
    plan.nodes[node].below = plan.num_tiles();
    plan.core.push_back(core);
    plan.expected.push_back(points.size());
    return node;
  }
  const bool by_x = depth % 2 == 0;
  const LatticePoint pivot = points[random.below(points.size())];
  const std::int32_t split = by_x ? pivot.x : pivot.y;
  std::vector<LatticePoint> low, high;
  for (const LatticePoint p : points) ((by_x ? p.x : p.y) < split ? low : high).push_back(p);
  LatticeBox below = core, above = core;
  (by_x ? below.max.x : below.max.y) = split - 1;
  (by_x ? above.min.x : above.min.y) = split;
  plan.nodes[node].axis = by_x ? 0 : 1;
  plan.nodes[node].split = split;
  const std::uint32_t b = cut_plan(plan, low, below, depth - 1, random);
  const std::uint32_t a = cut_plan(plan, high, above, depth - 1, random);
  plan.nodes[node].below = b;
  plan.nodes[node].above = a;
  return node;
}

inline void write_arranged(const CutTerrain& cut, const WholeTerrain& whole, std::uint32_t tile) {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  for (const std::uint32_t v : cut.owned[tile]) {
    position.push_back(whole.position[v]);
    height.push_back(whole.height[v]);
  }
  store::Writer out(cut.context.layout.unit(Phase::arrange, tile));
  out.set("points", static_cast<std::int64_t>(position.size()));
  write_points(out, position, height);
  out.append("hull", convex_hull(position));
  if (!position.empty()) out.set("lowest", static_cast<std::int64_t>(lowest_vertex(height, position)));
  out.commit();
}

/// Triangles [3T] over whole vertices into one of the two files of a tile.
inline void write_triangle_file(const CutTerrain& cut, const WholeTerrain& whole, std::uint32_t tile, Phase phase,
                                const std::vector<std::uint32_t>& triangle) {
  const bool is_seam = phase == Phase::seam;
  const auto num_own = is_seam ? 0 : static_cast<std::uint32_t>(cut.owned[tile].size());
  std::map<std::uint32_t, std::uint32_t> listed;
  std::vector<std::uint64_t> point, hull;
  std::vector<std::int32_t> xyz;
  std::vector<std::uint32_t> reference;
  for (const std::uint32_t v : triangle) {
    if (!is_seam && cut.id[v].tile() == tile) {
      reference.push_back(cut.id[v].index());
      continue;
    }
    const auto [at, is_new] = listed.try_emplace(v, static_cast<std::uint32_t>(listed.size()));
    if (is_new) {
      point.push_back(cut.id[v].value);
      xyz.insert(xyz.end(), {whole.position[v].x, whole.position[v].y, whole.height[v]});
    }
    reference.push_back(num_own + at->second);
  }
  for (std::size_t h = 0; h < triangle.size(); ++h) {
    const DirectedEdge e{triangle[h], triangle[h % 3 == 2 ? h - 2 : h + 1]};
    if (std::find(whole.hull_edge.begin(), whole.hull_edge.end(), e) != whole.hull_edge.end())
      hull.insert(hull.end(), {cut.id[e.origin].value, cut.id[e.target].value});
  }
  store::Writer out(cut.context.layout.unit(phase, tile));
  out.append("triangle", reference);
  out.append(is_seam ? "point" : "foreign_point", point);
  out.append(is_seam ? "point_xyz" : "foreign_xyz", xyz);
  out.append("hull_edge", hull);
  out.commit();
}

/// Writes all files before `spill`. `depth` 0: one tile.
inline CutTerrain cut_terrain(const WholeTerrain& whole, const PipelineOptions& options, const Lattice& lattice,
                              std::uint64_t seed, int depth) {
  Random random(seed);
  CutTerrain cut{{options, Layout(options), {}, {}}, {}, {}, {}};
  Plan& plan = cut.context.plan;
  plan.files.push_back({"made.las", whole.position.size(), {}});
  plan.lattice = lattice;
  constexpr std::int32_t kLow = std::numeric_limits<std::int32_t>::min(),
                         kHigh = std::numeric_limits<std::int32_t>::max();
  cut_plan(plan, whole.position, {{kLow, kLow}, {kHigh, kHigh}}, depth, random);
  cut.owned.resize(plan.num_tiles());
  std::vector<std::uint32_t> order(whole.position.size());
  std::iota(order.begin(), order.end(), 0U);
  shuffle(seed, order);  // the order of a tile's points is nobody's business
  cut.id.resize(order.size());
  for (const std::uint32_t v : order) {
    const std::uint32_t t = plan.tile_of(whole.position[v]);
    cut.id[v] = PointId(t, static_cast<std::uint32_t>(cut.owned[t].size()));
    cut.owned[t].push_back(v);
  }
  for (std::uint32_t t = 0; t < plan.num_tiles(); ++t) write_arranged(cut, whole, t);
  make_outline(cut.context);
  cut.context.outline = load_outline(cut.context.layout.unit(Phase::outline, 0));

  std::vector<std::array<std::vector<std::uint32_t>, 2>> share(plan.num_tiles());
  for (std::size_t i = 0; i < whole.triangle.size(); i += 3) {
    const std::uint32_t tile =
        random.below(20) == 0 ? random.below(plan.num_tiles()) : cut.id[whole.triangle[i + random.below(3)]].tile();
    cut.tile_of_triangle.push_back(tile);
    auto& file = share[tile][random.below(4) == 0];
    const std::size_t turn = random.below(3);
    for (std::size_t j = 0; j < 3; ++j) file.push_back(whole.triangle[i + (turn + j) % 3]);
  }
  for (std::uint32_t t = 0; t < plan.num_tiles(); ++t) {
    write_triangle_file(cut, whole, t, Phase::triangulate, share[t][0]);
    write_triangle_file(cut, whole, t, Phase::seam, share[t][1]);
  }
  write_mendings(cut.context, std::vector<Mending>(plan.num_tiles()), std::vector<std::uint64_t>(plan.num_tiles()));
  return cut;
}

/// All units of the phases from `first` to `last` that the options ask for.
inline void run_phases(const RunContext& context, Phase first, Phase last) {
  Silent silent;
  for (auto p = static_cast<std::size_t>(first); p <= static_cast<std::size_t>(last); ++p)
    run_units(context, static_cast<Phase>(p), 0, 1, true, silent);
}

inline void run_parts(const RunContext& context) {
  run_phases(context, Phase::nest, Phase::raster);
}

inline std::vector<std::uint8_t> outlets_of(const WholeTerrain& whole, OutletPolicy policy) {
  if (policy == OutletPolicy::hull) return whole.on_hull;
  std::vector<std::uint8_t> flag(whole.position.size(), 0);
  flag[lowest_vertex(whole.height, whole.position)] = 1;
  return flag;
}

}  // namespace hydrotin::testing
