#include <algorithm>
#include <cmath>
#include <limits>

#include "embedded_rivers.h"
#include "fingerprint.h"
#include "hydrotin/mesh.h"
#include "kept_pits.h"
#include "leftovers.h"
#include "part.h"
#include "phases.h"
#include "pit_options.h"
#include "reduced_store.h"
#include "river_state.h"
#include "settled_heights.h"
#include "surface.h"
#include "terrain_file.h"

namespace hydrotin {
namespace {

std::uint64_t longest_squared(const Part& part, std::uint32_t t) {
  std::uint64_t longest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const LatticePoint a = part.position[part.triangle[3 * std::size_t{t} + i]];
    const LatticePoint b = part.position[part.triangle[3 * std::size_t{t} + (i + 1) % 3]];
    const auto dx = static_cast<std::uint64_t>(std::abs(std::int64_t{a.x} - b.x));
    const auto dy = static_cast<std::uint64_t>(std::abs(std::int64_t{a.y} - b.y));
    // Below 2^62 unless the triangle is as wide as half the lattice; then any large number will do.
    longest = std::max(longest, std::max(dx, dy) >> 31 ? std::numeric_limits<std::uint64_t>::max() : dx * dx + dy * dy);
  }
  return longest;
}

// Few very long triangles would blow up the boxes of many runs: they come last.
std::vector<std::uint32_t> storage_order(const Part& part) {
  constexpr std::uint64_t kBigRatio = 64;
  std::vector<std::uint32_t> order(part.num_triangles());
  if (order.empty()) return order;
  std::vector<std::uint64_t> length2(order.size());
  for (std::uint32_t t = 0; t < order.size(); ++t) length2[t] = longest_squared(part, order[t] = t);
  std::vector<std::uint64_t> sorted = length2;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const std::uint64_t limit = *middle;
  std::stable_partition(order.begin(), order.end(), [&](std::uint32_t t) {
    return length2[t] / (kBigRatio * kBigRatio) < std::max<std::uint64_t>(limit, 1);
  });
  return order;
}

void write_mesh(const RunContext& context, std::uint32_t tile, const Part& part, std::span<const std::int32_t> height) {
  PlyWriter ply(context.layout.mesh(tile), part.num_vertices(), part.num_triangles(), context.plan.crs_wkt);
  const Lattice& lattice = context.plan.lattice;
  constexpr std::uint32_t kBatch = 65536;
  std::vector<MeshVertex> vertices;
  for (std::uint32_t v = 0; v < part.num_vertices(); ++v) {
    vertices.push_back({lattice.x(part.position[v].x), lattice.y(part.position[v].y), lattice.z(height[v])});
    if (vertices.size() < kBatch && v + 1 < part.num_vertices()) continue;
    ply.add_vertices(vertices);
    vertices.clear();
  }
  std::vector<MeshTriangle> triangles;
  for (std::uint32_t t = 0; t < part.num_triangles(); ++t) {
    const std::uint32_t* v = &part.triangle[3 * std::size_t{t}];
    triangles.push_back({v[0], v[1], v[2]});
    if (triangles.size() < kBatch && t + 1 < part.num_triangles()) continue;
    ply.add_triangles(triangles);
    triangles.clear();
  }
  ply.finish();
}

void write_vertices(store::Writer& out, const Part& part, std::span<const std::int32_t> height) {
  write_points(out, part.own.position, part.own.height);
  std::vector<std::int32_t> own_height(part.own.position.size(), kUnusedHeight);
  for (std::uint32_t v = 0; v < part.num_own; ++v) own_height[PointId(part.point[v]).index()] = height[v];
  out.append("height", own_height,
             "z lattice, final height; -2147483648 where no triangle of this file uses the point: its height then "
             "stands in another tile's foreign list");
  std::vector<std::int32_t> xyz;
  for (std::uint32_t v = part.num_own; v < part.num_vertices(); ++v)
    xyz.insert(xyz.end(), {part.position[v].x, part.position[v].y, part.measured[v]});
  out.append("foreign_point", std::span<const std::uint64_t>(part.point).subspan(part.num_own),
             "points of other tiles in this tile's triangles: tile << 32 | index, ascending");
  out.append("foreign_xyz", xyz, "lattice; z as measured");
  out.append("foreign_height", height.subspan(part.num_own), "z lattice, final height");
}

// How the arrays of the file refer to a vertex.
std::uint32_t reference(const Part& part, std::uint32_t v) {
  return v < part.num_own ? PointId(part.point[v]).index()
                          : static_cast<std::uint32_t>(part.own.position.size()) + (v - part.num_own);
}

void write_removed(const RunContext& context, std::uint32_t tile, store::Writer& out) {
  if (!context.thins()) return;
  const store::Reader in(context.points_unit(tile));
  const TilePoints removed = read_points(in, 0, in.size(std::string(kRemoved) + "x"), kRemoved);
  write_points(out, removed.position, removed.height, kRemoved);
}

using PointTriangle = std::array<std::uint64_t, 3>;

PointTriangle canonical(PointTriangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

// Triangles of the tile that came with the rivers.
std::vector<PointTriangle> added_triangles(const RunContext& context, std::uint32_t tile) {
  std::vector<PointTriangle> out;
  if (!context.rivers) return out;
  const RiverNetwork& network = context.rivers->network;
  const auto [first, last] = items_of(network.come, tile);
  for (auto at = first; at != last; ++at)
    out.push_back(
        canonical({network.point[at->vertex[0]], network.point[at->vertex[1]], network.point[at->vertex[2]]}));
  std::sort(out.begin(), out.end());
  return out;
}

void write_triangles(const RunContext& context, std::uint32_t tile, store::Writer& out, const Part& part) {
  const std::vector<PointTriangle> added = added_triangles(context, tile);
  std::vector<std::uint32_t> added_number;
  std::vector<std::uint32_t> triangle;
  triangle.reserve(part.triangle.size());
  std::vector<LatticeBox> box((part.num_triangles() + kRunTriangles - 1) / kRunTriangles);
  for (const std::uint32_t t : storage_order(part)) {
    const std::uint32_t* v = &part.triangle[3 * std::size_t{t}];
    if (!added.empty() && std::binary_search(added.begin(), added.end(),
                                             canonical({part.point[v[0]], part.point[v[1]], part.point[v[2]]})))
      added_number.push_back(static_cast<std::uint32_t>(triangle.size() / 3));
    LatticeBox& run = box[triangle.size() / (std::size_t{3} * kRunTriangles)];
    for (std::size_t i = 0; i < 3; ++i) {
      run.extend(part.position[v[i]]);
      triangle.push_back(reference(part, v[i]));
    }
  }
  out.append(
      "triangle", triangle,
      "vertices of the triangles, counter-clockwise: own points by index, then, from the number of own points on, "
      "entries of foreign_point");
  out.append("triangle_box", flatten(box), "boxes of runs of 1024 triangles: min x, min y, max x, max y, lattice");
  if (context.rivers)
    out.append("added_triangle", added_number, "triangles that came with the rivers: no promise on their order");
  std::vector<std::uint64_t> hull;
  for (const DirectedEdge& e : part.hull_edge) hull.insert(hull.end(), {part.point[e.origin], part.point[e.target]});
  out.append("hull_edge", hull, "origins and targets of edges on the convex hull, the terrain on their left");
}

// Outlets that neither the hull nor the lowest vertex tells: those of layers and voids, and kept pits.
void write_outlets(const RunContext& context, std::uint32_t tile, const Part& part,
                   std::span<const std::uint8_t> is_outlet, store::Writer& out) {
  const PitOptions& pits = context.options.pits;
  const bool stated =
      pits.outlets == OutletPolicy::layer || pits.voids_drain || (context.rivers && !context.rivers->outlet.empty());
  const std::vector<std::uint8_t> is_kept = kept_flags(context, tile, part);
  std::vector<std::uint32_t> outlet, kept;
  for (std::uint32_t v = 0; v < part.num_vertices(); ++v) {
    if (stated && is_outlet[v] && !is_kept[v]) outlet.push_back(reference(part, v));
    if (is_kept[v]) kept.push_back(reference(part, v));
  }
  out.append("outlet_vertex", outlet, "where water may leave by a layer, or at voids; numbered as in `triangle`");
  out.append("kept_vertex", kept, "vertices of pits that were to be kept; numbered as in `triangle`");
}

// Pits before lifting that lie inside the part, with the level at which they overflow.
void write_pits_before(const RunContext& context, std::uint32_t tile, const Part& part,
                       std::span<const std::int32_t> level, store::Writer& out) {
  const store::Reader in(context.layout.unit(Phase::spill, tile));
  std::vector<std::int32_t> xyz, pit_level;
  std::vector<std::uint64_t> vertices;
  for (const Pit& pit : read_pits(in, "")) {
    const auto v = part.find(PointId(pit.vertex));
    if (!v)
      throw Error(ErrorKind::storage, in.path() + ": a pit at no vertex of the tile; delete the file and run again");
    xyz.insert(xyz.end(), {pit.representative.x, pit.representative.y, pit.height});
    pit_level.push_back(level[*v]);
    vertices.push_back(pit.num_vertices);
  }
  out.append("pit_xyz", xyz, "pits before lifting inside this part: smallest vertex by (x, y), and height, lattice");
  out.append("pit_level", pit_level, "z lattice: where the pit overflows");
  out.append("pit_vertices", vertices, "vertices of the plateau");
}

// What rivers made of the part: heights as they left them, and their edges.
void write_rivers(const RunContext& context, const Part& part, std::span<const std::int32_t> height,
                  store::Writer& out) {
  if (!context.rivers) return;
  std::vector<std::uint32_t> moved;
  std::vector<std::int32_t> moved_height;
  for (std::uint32_t v = 0; v < part.num_vertices(); ++v) {
    if (part.height[v] == part.measured[v]) continue;
    moved.push_back(reference(part, v));
    moved_height.push_back(part.height[v]);
  }
  const RiverState state = river_state(context, part, height);
  const auto append = [&](const std::string& name, const std::vector<RiverEdge>& edges, const std::string& meaning) {
    std::vector<std::uint32_t> flat;
    for (const auto& [from, to] : edges) flat.insert(flat.end(), {reference(part, from), reference(part, to)});
    out.append(name, flat, meaning);
  };
  std::vector<std::uint32_t> source;
  for (const std::uint32_t v : state.source) source.push_back(reference(part, v));
  out.append("river_moved", moved, "vertices that the rivers moved, numbered as in `triangle`");
  out.append("river_height", moved_height, "z lattice: their heights before pits were removed");
  append("river_edge", state.edge, "river edges of these triangles: from, to; numbered as in `triangle`");
  append("invalid_river_edge", state.invalid, "those of them along which water climbs, or that are no valleys");
  append("no_valley_edge", state.no_valley, "river edges above a side of theirs in these triangles, asked for or not");
  out.append("river_source", source, "vertices of these triangles with a river edge down, numbered as in `triangle`");
  out.append("steepest_way", state.steepest, "rise over run: the steepest way down from each over these triangles");
  out.set("slopes_beyond_limit", static_cast<std::int64_t>(state.slopes_beyond_limit));
}

void set_figures(const RunContext& context, const Part& part, std::span<const std::int32_t> height,
                 std::span<const std::uint8_t> is_outlet, store::Writer& out) {
  Fingerprint fingerprint;
  const auto corner = [&](std::uint32_t v) {
    return Fingerprint::Corner{part.position[v].x, part.position[v].y, height[v]};
  };
  for (std::size_t i = 0; i < part.triangle.size(); i += 3)
    fingerprint.add({corner(part.triangle[i]), corner(part.triangle[i + 1]), corner(part.triangle[i + 2])});
  out.set("fingerprint", fingerprint.hex());
  const std::int64_t rim = std::count_if(part.is_rim.begin(), part.is_rim.end(), [](std::uint8_t f) { return f != 0; });
  out.set("points", static_cast<std::int64_t>(part.own.position.size()));
  out.set("triangles", static_cast<std::int64_t>(part.num_triangles()));
  out.set("vertices", static_cast<std::int64_t>(part.num_vertices()));
  out.set("rim_vertices", rim);
  out.set("order", std::int64_t{context.options.triangulation.order});
  out.set("outlets", outlet_policy(context.options.pits));
  out.set("pit_method", pit_method(context.options.pits));
  out.set("pits_removed", std::int64_t{context.options.pits.method != PitMethod::none});
  const auto final_plateaus = summarize_plateaus(part.graph, height, part.position, is_outlet, part.point, part.is_rim);
  write_plateaus(out, "final_", final_plateaus);
}

}  // namespace

void finish_tile(const RunContext& context, std::uint32_t tile) {
  const Part part = load_part(context, tile);
  const auto [level, is_outlet] = levels_of(context, tile, part);
  const std::vector<std::int32_t> height = settled_heights(context, tile, part);
  // The mesh first: the terrain file under its final name says that the unit is complete.
  if (context.options.output.mesh_ply && part.num_triangles() > 0)
    write_mesh(context, tile, part, height);
  else
    remove_leftover(context.layout.mesh(tile));

  store::Writer out(context.layout.unit(Phase::finish, tile));
  out.set("recipe", context.recipe(Phase::finish));
  out.set("tile", std::int64_t{tile});
  out.set("crs", context.plan.crs.size() < 60000 ? context.plan.crs : std::string());
  write_lattice(out, context.plan.lattice);
  write_vertices(out, part, height);
  write_removed(context, tile, out);
  write_triangles(context, tile, out, part);
  write_pits_before(context, tile, part, level, out);
  write_outlets(context, tile, part, is_outlet, out);
  write_rivers(context, part, height, out);
  set_figures(context, part, height, is_outlet, out);
  out.commit();
}

}  // namespace hydrotin
