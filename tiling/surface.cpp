#include "surface.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "block_index.h"
#include "hydrotin/lifting.h"
#include "hydrotin/spill_tree.h"
#include "kept_pits.h"
#include "reduced_store.h"
#include "store_arrays.h"
#include "terrain_file.h"
#include "triangle_runs.h"

namespace hydrotin {
namespace {

using store::contradicts;

void read_vertices(const store::Reader& in, std::span<const std::uint32_t> number, Surface& out) {
  store::for_stretches(number, kVertexGap,
                       [&](std::uint64_t begin, std::uint64_t count, std::span<const std::uint32_t> some) {
                         const auto point = in.read_range<std::uint64_t>("point", begin, count);
                         const auto xyz = in.read_range<std::int32_t>("xyz", 3 * begin, 3 * count);
                         const auto level = in.read_range<std::int32_t>("level", begin, count);
                         const auto outlet = in.read_range<std::uint8_t>("outlet", begin, count);
                         for (const std::uint32_t v : some) {
                           const std::size_t i = v - begin;
                           out.point.push_back(point[i]);
                           out.position.push_back({xyz[3 * i], xyz[3 * i + 1]});
                           out.height.push_back(xyz[3 * i + 2]);
                           out.level.push_back(level[i]);
                           out.is_outlet.push_back(outlet[i]);
                         }
                       });
}

// The triangles of one file with a corner in the cells, over their own vertices.
Surface read_share(const store::Reader& in, const CellGrid& grid, std::span<const Cell> cells) {
  Surface out;
  const std::uint64_t n = in.size("point");
  if (in.size("xyz") != 3 * n || in.size("level") != n || in.size("outlet") != n)
    contradicts(in.path(), "its arrays have different lengths");
  const std::vector<std::uint32_t> triangle = read_triangle_runs(in, grid, cells);
  const auto [used, number] = number_used(triangle, n);
  read_vertices(in, used, out);
  std::vector<std::uint8_t> is_inside(used.size());
  for (std::size_t i = 0; i < used.size(); ++i)
    is_inside[i] = std::binary_search(cells.begin(), cells.end(), grid.of(out.position[i]));
  for (std::size_t t = 0; t < triangle.size(); t += 3) {
    std::uint32_t corner[3];
    bool any = false;
    for (std::size_t i = 0; i < 3; ++i) {
      corner[i] = number[triangle[t + i]];
      any = any || is_inside[corner[i]];
    }
    if (any) out.triangle.insert(out.triangle.end(), corner, corner + 3);
  }
  return out;
}

/// A vertex of one of several parts.
struct Placed {
  std::uint64_t place;  // orders as its position does
  std::uint32_t part, vertex;
};

std::vector<Placed> vertices_by_place(std::span<const Surface> parts) {
  const auto biased = [](std::int32_t c) { return std::uint64_t{static_cast<std::uint32_t>(c) ^ 0x80000000u}; };
  std::vector<Placed> order;
  order.reserve(std::accumulate(parts.begin(), parts.end(), std::size_t{0},
                                [](std::size_t n, const Surface& part) { return n + part.num_vertices(); }));
  for (std::uint32_t p = 0; p < parts.size(); ++p)
    for (std::uint32_t v = 0; v < parts[p].num_vertices(); ++v) {
      const LatticePoint at = parts[p].position[v];
      order.push_back({biased(at.x) << 32 | biased(at.y), p, v});
    }
  std::sort(order.begin(), order.end(), [](const Placed& a, const Placed& b) { return a.place < b.place; });
  return order;
}

}  // namespace

bool meets(const LatticeBox& box, const CellGrid& grid, std::span<const Cell> cells) {
  const Cell low = grid.of(box.min), high = grid.of(box.max);
  auto at = std::lower_bound(cells.begin(), cells.end(), Cell{low.first, low.second});
  while (at != cells.end() && at->first <= high.first) {
    if (at->second < low.second)
      at = std::lower_bound(at, cells.end(), Cell{at->first, low.second});
    else if (at->second <= high.second)
      return true;
    else
      at = std::lower_bound(at, cells.end(), Cell{at->first + 1, low.second});
  }
  return false;
}

PartLevels levels_of(const RunContext& context, std::uint32_t tile, const Part& part) {
  const std::vector<std::uint32_t> rim = part.rim();
  const store::Reader in(context.layout.unit(Phase::drain, 0));
  const auto begin = in.read_range<std::uint64_t>("rim_begin", tile, 2);
  const store::Reader spill(context.layout.unit(Phase::spill, tile));
  const auto known = spill.read<std::uint64_t>("rim");
  const bool fits = begin[0] <= begin[1] && begin[1] - begin[0] == rim.size() && known.size() == rim.size() &&
                    std::equal(rim.begin(), rim.end(), known.begin(),
                               [&](std::uint32_t v, std::uint64_t id) { return part.point[v] == id; });
  if (!fits)
    throw Error(ErrorKind::storage, in.path() + ": its levels are not those of the rim of tile " +
                                        std::to_string(tile) +
                                        "; delete the scratch folder's spill and drain and run again");
  const auto rim_level = in.read_range<std::int32_t>("rim_level", begin[0], rim.size());
  const auto rim_outlet = in.read_range<std::uint8_t>("rim_outlet", begin[0], rim.size());
  PartLevels out;
  out.is_outlet = outlet_flags(context, part);
  const std::vector<std::uint8_t> is_kept = kept_flags(context, tile, part);
  for (std::uint32_t v = 0; v < part.num_vertices(); ++v) out.is_outlet[v] |= is_kept[v];
  for (std::size_t i = 0; i < rim.size(); ++i) out.is_outlet[rim[i]] = rim_outlet[i];
  out.level = lift_catchments(read_catchments(spill, part.height, rim.size()), rim_level);
  if (std::find(out.level.begin(), out.level.end(), kNoLevel) != out.level.end())
    throw Error(ErrorKind::storage, context.layout.unit(Phase::triangulate, tile) +
                                        ": some triangles are joined to no others; delete the file and run again");
  return out;
}

void write_surface(store::Writer& out, const Surface& s) {
  std::vector<std::int32_t> xyz;
  xyz.reserve(3 * s.point.size());
  for (std::uint32_t v = 0; v < s.num_vertices(); ++v)
    xyz.insert(xyz.end(), {s.position[v].x, s.position[v].y, s.height[v]});
  out.append("point", s.point, "tile << 32 | index");
  out.append("xyz", xyz, "lattice; z as measured");
  out.append("level", s.level, "z lattice: where the water stands when all pits are full");
  out.append("outlet", s.is_outlet, "1: water may leave");
  out.append("rim", s.is_rim, "1: another part has the vertex too");
  out.append("triangle", s.triangle, "vertices, counter-clockwise");
  std::vector<LatticeBox> box((s.triangle.size() / 3 + kRunTriangles - 1) / kRunTriangles);
  for (std::size_t i = 0; i < s.triangle.size(); ++i)
    box[i / (std::size_t{3} * kRunTriangles)].extend(s.position[s.triangle[i]]);
  out.append("triangle_box", flatten(box), "boxes of runs of 1024 triangles");
}

Surface read_surface(const store::Reader& in) {
  Surface out;
  const std::uint64_t n = in.size("point");
  if (in.size("xyz") != 3 * n || in.size("level") != n || in.size("outlet") != n || in.size("rim") != n ||
      n >= std::numeric_limits<std::uint32_t>::max())
    contradicts(in.path(), "its arrays have different lengths");
  out.point = in.read<std::uint64_t>("point");
  const auto xyz = in.read<std::int32_t>("xyz");
  for (std::size_t v = 0; v < n; ++v) {
    out.position.push_back({xyz[3 * v], xyz[3 * v + 1]});
    out.height.push_back(xyz[3 * v + 2]);
  }
  out.level = in.read<std::int32_t>("level");
  out.is_outlet = in.read<std::uint8_t>("outlet");
  out.is_rim = in.read<std::uint8_t>("rim");
  out.triangle = in.read<std::uint32_t>("triangle");
  if (out.triangle.size() % 3 != 0 ||
      std::any_of(out.triangle.begin(), out.triangle.end(), [&](std::uint32_t v) { return v >= n; }))
    contradicts(in.path(), "a triangle refers to a vertex that is not listed");
  out.graph = make_vertex_graph(out.num_vertices(), out.triangle);
  return out;
}

CellGrid::CellGrid(const Outline& outline) {
  const LatticeBox box = outline.bounds();
  const double area =
      (static_cast<double>(box.max.x) - box.min.x + 1) * (static_cast<double>(box.max.y) - box.min.y + 1);
  const double wanted = area / static_cast<double>(std::max<std::uint64_t>(outline.vertices, 1)) * double{kVertices};
  while (shift_ < 30 && std::int64_t{1} << (2 * (shift_ + 1)) <= static_cast<std::int64_t>(wanted)) ++shift_;
}

LatticeBox CellGrid::box(const Cell& cell) const {
  const auto low = [&](std::int32_t c) { return std::int64_t{c} * (std::int64_t{1} << shift_); };
  const auto high = [&](std::int32_t c) { return low(c) + (std::int64_t{1} << shift_) - 1; };
  return {{static_cast<std::int32_t>(low(cell.first)), static_cast<std::int32_t>(low(cell.second))},
          {static_cast<std::int32_t>(high(cell.first)), static_cast<std::int32_t>(high(cell.second))}};
}

std::optional<Surface> read_window(const RunContext& context, const CellGrid& grid, std::span<const Cell> cells,
                                   std::uint64_t most_vertices) {
  std::vector<Surface> shares;
  std::uint64_t num_vertices = 0;
  const bool fits = context.parts().for_each(
      [&](const LatticeBox& box) { return meets(box, grid, cells); },
      [&](std::uint32_t t) {
        shares.push_back(read_share(store::Reader(context.layout.unit(Phase::pools, t)), grid, cells));
        num_vertices += shares.back().num_vertices();
        return num_vertices <= most_vertices;
      });
  if (!fits) return std::nullopt;
  return merged(shares, context.layout.unit(Phase::pools, 0));
}

Surface merged(std::span<const Surface> parts, const std::string& path) {
  const std::vector<Placed> order = vertices_by_place(parts);
  std::vector<std::vector<std::uint32_t>> number(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) number[p].resize(parts[p].num_vertices());
  Surface out;
  out.point.reserve(order.size()), out.position.reserve(order.size()), out.height.reserve(order.size());
  out.level.reserve(order.size()), out.is_outlet.reserve(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    constexpr std::size_t kAhead = 16;  // vertices in the order of a part lie anywhere in this one
    if (i + kAhead < order.size()) {
      const Surface& next = parts[order[i + kAhead].part];
      const std::uint32_t w = order[i + kAhead].vertex;
      __builtin_prefetch(&next.point[w]);
      __builtin_prefetch(&next.position[w]);
      __builtin_prefetch(&next.height[w]);
      __builtin_prefetch(&next.level[w]);
      __builtin_prefetch(&next.is_outlet[w]);
      __builtin_prefetch(&number[order[i + kAhead].part][w], 1);
    }
    const Placed& k = order[i];
    const Surface& from = parts[k.part];
    const std::uint32_t v = k.vertex;
    if (i == 0 || order[i - 1].place != k.place) {
      out.point.push_back(from.point[v]);
      out.position.push_back(from.position[v]);
      out.height.push_back(from.height[v]);
      out.level.push_back(from.level[v]);
      out.is_outlet.push_back(from.is_outlet[v]);
    } else if (out.point.back() != from.point[v] || out.height.back() != from.height[v] ||
               out.level.back() != from.level[v] || out.is_outlet.back() != from.is_outlet[v]) {
      contradicts(path, "tiles disagree about a vertex that they share");
    }
    number[k.part][v] = out.num_vertices() - 1;
  }
  out.triangle.reserve(std::accumulate(parts.begin(), parts.end(), std::size_t{0},
                                       [](std::size_t n, const Surface& part) { return n + part.triangle.size(); }));
  for (std::size_t p = 0; p < parts.size(); ++p)
    for (const std::uint32_t v : parts[p].triangle) out.triangle.push_back(number[p][v]);
  if (out.triangle.size() >= std::size_t{1} << 31)
    throw Error(ErrorKind::resource, path + ": too many triangles hang together around pits; use pits.method: lift");
  out.graph = make_vertex_graph(out.num_vertices(), out.triangle);
  return out;
}

}  // namespace hydrotin
