#include <algorithm>
#include <cmath>
#include <limits>

#include "fingerprint.h"
#include "hydrotin/lifting.h"
#include "hydrotin/mesh.h"
#include "leftovers.h"
#include "part.h"
#include "phases.h"
#include "reduced_store.h"
#include "terrain_file.h"

namespace hydrotin {
namespace {

// The tile's slice of the levels, checked to be aligned with the part's rim.
std::vector<std::int32_t> rim_levels(const RunContext& context, std::uint32_t tile, const Part& part,
                                     std::span<const std::uint32_t> rim) {
  const store::Reader in(context.layout.unit(Phase::drain, 0));
  const auto begin = in.read_range<std::uint64_t>("rim_begin", tile, 2);
  const auto known = store::Reader(context.layout.unit(Phase::spill, tile)).read<std::uint64_t>("rim");
  const bool fits = begin[0] <= begin[1] && begin[1] - begin[0] == rim.size() && known.size() == rim.size() &&
                    std::equal(rim.begin(), rim.end(), known.begin(),
                               [&](std::uint32_t v, std::uint64_t id) { return part.point[v] == id; });
  if (!fits)
    throw Error(ErrorKind::storage, in.path() + ": its levels are not those of the rim of tile " +
                                        std::to_string(tile) +
                                        "; delete the scratch folder's spill and drain and run again");
  return in.read_range<std::int32_t>("rim_level", begin[0], rim.size());
}

std::vector<std::int32_t> levels_of(const RunContext& context, std::uint32_t tile, const Part& part,
                                    std::span<const std::uint8_t> is_outlet) {
  const std::vector<std::uint32_t> rim = part.rim();
  const std::vector<std::int32_t> rim_level = rim_levels(context, tile, part, rim);
  std::vector<std::int32_t> source(part.num_vertices(), kNoLevel);
  for (std::size_t i = 0; i < rim.size(); ++i) source[rim[i]] = rim_level[i];
  std::vector<std::int32_t> level = lift_from(part.graph, part.height, is_outlet, source);
  if (std::find(level.begin(), level.end(), kNoLevel) != level.end())
    throw Error(ErrorKind::storage, context.layout.unit(Phase::triangulate, tile) +
                                        ": some triangles are joined to no others; delete the file and run again");
  return level;
}

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
    xyz.insert(xyz.end(), {part.position[v].x, part.position[v].y, part.height[v]});
  out.append("foreign_point", std::span<const std::uint64_t>(part.point).subspan(part.num_own),
             "points of other tiles in this tile's triangles: tile << 32 | index, ascending");
  out.append("foreign_xyz", xyz, "lattice; z as measured");
  out.append("foreign_height", height.subspan(part.num_own), "z lattice, final height");
}

void write_removed(const RunContext& context, std::uint32_t tile, store::Writer& out) {
  if (!context.thins()) return;
  const store::Reader in(context.points_unit(tile));
  const TilePoints removed = read_points(in, 0, in.size(std::string(kRemoved) + "x"), kRemoved);
  write_points(out, removed.position, removed.height, kRemoved);
}

void write_triangles(store::Writer& out, const Part& part) {
  const auto num_own_points = static_cast<std::uint32_t>(part.own.position.size());
  const auto reference = [&](std::uint32_t v) {
    return v < part.num_own ? PointId(part.point[v]).index() : num_own_points + (v - part.num_own);
  };
  std::vector<std::uint32_t> triangle;
  triangle.reserve(part.triangle.size());
  std::vector<LatticeBox> box((part.num_triangles() + kRunTriangles - 1) / kRunTriangles);
  for (const std::uint32_t t : storage_order(part)) {
    LatticeBox& run = box[triangle.size() / (std::size_t{3} * kRunTriangles)];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t v = part.triangle[3 * std::size_t{t} + i];
      run.extend(part.position[v]);
      triangle.push_back(reference(v));
    }
  }
  out.append(
      "triangle", triangle,
      "vertices of the triangles, counter-clockwise: own points by index, then, from the number of own points on, "
      "entries of foreign_point");
  out.append("triangle_box", flatten(box), "boxes of runs of 1024 triangles: min x, min y, max x, max y, lattice");
  std::vector<std::uint64_t> hull;
  for (const DirectedEdge& e : part.hull_edge) hull.insert(hull.end(), {part.point[e.origin], part.point[e.target]});
  out.append("hull_edge", hull, "origins and targets of edges on the convex hull, the terrain on their left");
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

void set_figures(const RunContext& context, const Part& part, std::span<const std::int32_t> height,
                 std::span<const std::uint8_t> is_outlet, store::Writer& out) {
  Fingerprint fingerprint;
  const auto corner = [&](std::uint32_t v) {
    return Fingerprint::Corner{part.position[v].x, part.position[v].y, height[v]};
  };
  for (std::size_t i = 0; i < part.triangle.size(); i += 3)
    fingerprint.add({corner(part.triangle[i]), corner(part.triangle[i + 1]), corner(part.triangle[i + 2])});
  out.set("fingerprint", fingerprint.hex());
  std::int64_t lifted = 0, total = 0, greatest = 0, rim = 0;
  for (std::uint32_t v = 0; v < part.num_vertices(); ++v) {
    rim += part.is_rim[v];
    if (part.is_rim[v]) continue;  // shared: `drain` counts them once
    const std::int64_t rise = std::int64_t{height[v]} - part.height[v];
    lifted += rise > 0 ? 1 : 0;
    total += rise;
    greatest = std::max(greatest, rise);
  }
  out.set("points", static_cast<std::int64_t>(part.own.position.size()));
  out.set("triangles", static_cast<std::int64_t>(part.num_triangles()));
  out.set("vertices", static_cast<std::int64_t>(part.num_vertices()));
  out.set("rim_vertices", rim);
  out.set("inner_lifted", lifted);
  out.set("inner_lift_total", total);
  out.set("inner_lift_max", greatest);
  out.set("order", std::int64_t{context.options.triangulation.order});
  out.set("outlets", std::string(context.options.pits.outlets == OutletPolicy::hull ? "hull" : "lowest"));
  out.set("pits_removed", std::int64_t{context.options.pits.method != PitMethod::none});
  const auto final_plateaus = summarize_plateaus(part.graph, height, part.position, is_outlet, part.point, part.is_rim);
  write_plateaus(out, "final_", final_plateaus);
}

}  // namespace

void finish_tile(const RunContext& context, std::uint32_t tile) {
  const Part part = load_part(context, tile);
  const std::vector<std::uint8_t> is_outlet = outlet_flags(context, part);
  const std::vector<std::int32_t> level = levels_of(context, tile, part, is_outlet);
  const std::vector<std::int32_t>& height = context.options.pits.method == PitMethod::lift ? level : part.height;
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
  write_triangles(out, part);
  write_pits_before(context, tile, part, level, out);
  set_figures(context, part, height, is_outlet, out);
  out.commit();
}

}  // namespace hydrotin
