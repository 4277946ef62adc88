#include "part.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <string>
#include <tuple>

#include "embedded_rivers.h"
#include "hydrotin/outlets.h"
#include "hydrotin/predicates.h"
#include "hydrotin/rasterize.h"
#include "mend.h"
#include "store.h"

namespace hydrotin {
namespace {

[[noreturn]] void contradicts(const std::string& path, const std::string& what) {
  throw Error(ErrorKind::storage, path + ": " + what + "; delete the file and run again");
}

struct Located {
  std::uint64_t point;
  LatticePoint position;
  std::int32_t height;
  friend auto operator<=>(const Located&, const Located&) = default;
};

// One file of triangles over its own list of points.
struct TriangleFile {
  std::string path;
  std::vector<std::uint32_t> triangle;
  std::uint32_t num_own = 0;  // references below are own points
  std::vector<Located> listed;
  std::vector<std::uint64_t> hull_edge;
};

std::vector<Located> located(const store::Reader& in, const std::string& ids, const std::string& xyz,
                             const RunContext& context) {
  const auto point = in.read<std::uint64_t>(ids);
  const auto coordinate = in.read<std::int32_t>(xyz);
  if (coordinate.size() != 3 * point.size())
    contradicts(in.path(), "the arrays '" + ids + "' and '" + xyz + "' have different lengths");
  std::vector<Located> out;
  out.reserve(point.size());
  for (std::size_t i = 0; i < point.size(); ++i) {
    const PointId id(point[i]);
    if (id.tile() >= context.outline.count.size() || id.index() >= context.outline.count[id.tile()])
      contradicts(in.path(), "entry " + std::to_string(i) + " of '" + ids + "' names a point that does not exist");
    out.push_back({point[i], {coordinate[3 * i], coordinate[3 * i + 1]}, coordinate[3 * i + 2]});
  }
  return out;
}

// Puts in the triangles of polygons that were solved again.
void replace_mended(const RunContext& context, std::uint32_t tile, TriangleFile& file) {
  const Mending mending = read_mended_triangles(context, tile);
  for (std::size_t i = 0; i < mending.position.size(); ++i) {
    const std::uint64_t at = mending.position[i];
    if (at >= file.triangle.size() / 3) contradicts(file.path, "a triangle that was to be replaced is not there");
    for (std::size_t j = 0; j < 3; ++j) file.triangle[3 * at + j] = mending.triangle[3 * i + j];
  }
}

TriangleFile read_triangles(const RunContext& context, Phase phase, std::uint32_t tile, std::uint32_t num_own) {
  const bool is_seam = phase == Phase::seam;
  const store::Reader in(context.layout.unit(phase, tile));
  TriangleFile file{in.path(), in.read<std::uint32_t>("triangle"), is_seam ? 0 : num_own, {}, {}};
  file.listed =
      is_seam ? located(in, "point", "point_xyz", context) : located(in, "foreign_point", "foreign_xyz", context);
  file.hull_edge = in.read<std::uint64_t>("hull_edge");
  if (is_seam) replace_mended(context, tile, file);
  if (file.triangle.size() % 3 != 0 || file.hull_edge.size() % 2 != 0)
    contradicts(file.path, "an array of triangles or hull edges is cut");
  const std::uint64_t references = std::uint64_t{file.num_own} + file.listed.size();
  if (std::any_of(file.triangle.begin(), file.triangle.end(), [&](std::uint32_t v) { return v >= references; }))
    contradicts(file.path, "a triangle refers to a vertex that is not listed");
  return file;
}

// The triangles that come with the rivers.
TriangleFile added_triangles(const RunContext& context, std::uint32_t tile) {
  const RiverNetwork& network = context.rivers->network;
  TriangleFile file{context.layout.unit(Phase::match, 0), {}, 0, {}, {}};
  std::vector<std::uint32_t> used;
  const auto [first, last] = items_of(network.come, tile);
  for (auto at = first; at != last; ++at) used.insert(used.end(), at->vertex.begin(), at->vertex.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (const std::uint32_t v : used) file.listed.push_back({network.point[v], network.position[v], network.height[v]});
  for (auto at = first; at != last; ++at)
    for (const std::uint32_t v : at->vertex)
      file.triangle.push_back(static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin()));
  const auto [hull_first, hull_last] = items_of(network.hull_come, tile);
  for (auto at = hull_first; at != hull_last; ++at)
    for (const std::uint32_t v : at->vertex) file.hull_edge.push_back(network.point[v]);
  return file;
}

// Takes out the hull edges that go with the rivers.
void remove_hull_edges(const RunContext& context, std::uint32_t tile, TriangleFile& file) {
  const RiverNetwork& network = context.rivers->network;
  const auto [first, last] = items_of(network.hull_gone, tile);
  for (auto at = first; at != last; ++at)
    for (std::size_t i = 0; i + 1 < file.hull_edge.size();) {
      if (file.hull_edge[i] != network.point[at->vertex[0]] || file.hull_edge[i + 1] != network.point[at->vertex[1]]) {
        i += 2;
        continue;
      }
      file.hull_edge.erase(file.hull_edge.begin() + static_cast<std::ptrdiff_t>(i),
                           file.hull_edge.begin() + static_cast<std::ptrdiff_t>(i + 2));
    }
}

// Points numbered: own points by index, foreign ones after them by ascending id.
class Numbering {
 public:
  Numbering(std::uint32_t tile, const TilePoints& own, std::span<const TriangleFile> files) : tile_(tile), own_(own) {
    for (const TriangleFile& file : files)
      for (const Located& p : file.listed) {
        if (PointId(p.point).tile() != tile) {
          foreign_.push_back(p);
          continue;
        }
        const std::uint32_t i = PointId(p.point).index();
        if (own.position[i] != p.position || own.height[i] != p.height)
          contradicts(file.path, "its coordinates of point " + std::to_string(i) + " of the tile are not the tile's");
      }
    std::sort(foreign_.begin(), foreign_.end());
    foreign_.erase(std::unique(foreign_.begin(), foreign_.end()), foreign_.end());
    for (std::size_t i = 1; i < foreign_.size(); ++i)
      if (foreign_[i].point == foreign_[i - 1].point)
        contradicts(files.back().path, "a point of another tile has two different coordinates");
    if (own.position.size() + foreign_.size() >= std::numeric_limits<std::uint32_t>::max())
      throw Error(ErrorKind::resource, files.back().path + ": too many points in one tile; lower tiles.target_points");
  }

  [[nodiscard]] std::uint32_t of(std::uint64_t point) const {
    if (PointId(point).tile() == tile_) return PointId(point).index();
    const auto at = std::lower_bound(foreign_.begin(), foreign_.end(), point,
                                     [](const Located& p, std::uint64_t id) { return p.point < id; });
    return static_cast<std::uint32_t>(own_.position.size() + static_cast<std::size_t>(at - foreign_.begin()));
  }
  [[nodiscard]] std::size_t size() const { return own_.position.size() + foreign_.size(); }
  [[nodiscard]] Located at(std::uint32_t number) const {
    if (number < own_.position.size())
      return {PointId(tile_, number).value, own_.position[number], own_.height[number]};
    return foreign_[number - own_.position.size()];
  }

 private:
  std::uint32_t tile_;
  const TilePoints& own_;
  std::vector<Located> foreign_;
};

// The triangles of both files over the numbering.
std::vector<std::uint32_t> numbered(std::span<const TriangleFile> files, const Numbering& numbering) {
  std::vector<std::uint32_t> out;
  out.reserve(std::accumulate(files.begin(), files.end(), std::size_t{0},
                              [](std::size_t n, const TriangleFile& f) { return n + f.triangle.size(); }));
  std::vector<std::uint32_t> number;
  for (const TriangleFile& file : files) {
    number.clear();
    for (const Located& p : file.listed) number.push_back(numbering.of(p.point));
    for (const std::uint32_t v : file.triangle) out.push_back(v < file.num_own ? v : number[v - file.num_own]);
  }
  if (out.size() >= std::size_t{1} << 31)
    throw Error(ErrorKind::resource,
                files.front().path + ": too many triangles in one tile; lower tiles.target_points");
  return out;
}

// Takes out the triangles that go with the rivers.
void remove_gone(const RunContext& context, std::uint32_t tile, const Numbering& numbering,
                 std::vector<std::uint32_t>& triangle) {
  using Corners = std::array<std::uint32_t, 3>;
  const auto canonical = [](Corners t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  const RiverNetwork& network = context.rivers->network;
  const auto [first, last] = items_of(network.gone, tile);
  std::vector<Corners> gone;
  for (auto at = first; at != last; ++at)
    gone.push_back(canonical({numbering.of(network.point[at->vertex[0]]), numbering.of(network.point[at->vertex[1]]),
                              numbering.of(network.point[at->vertex[2]])}));
  std::sort(gone.begin(), gone.end());
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangle.size(); t += 3) {
    if (std::binary_search(gone.begin(), gone.end(), canonical({triangle[t], triangle[t + 1], triangle[t + 2]})))
      continue;
    std::copy_n(triangle.begin() + static_cast<std::ptrdiff_t>(t), 3,
                triangle.begin() + static_cast<std::ptrdiff_t>(kept));
    kept += 3;
  }
  if (triangle.size() - kept != 3 * gone.size())
    contradicts(context.layout.unit(Phase::match, 0), "a triangle that was to be replaced is not there");
  triangle.resize(kept);
}

// The heights that rivers gave to vertices of the part.
void take_heights(const RunContext& context, Part& part) {
  const auto& moved = context.rivers->moved;
  const auto begin = [&](std::uint64_t point) {
    return std::lower_bound(moved.begin(), moved.end(), std::pair(point, std::numeric_limits<std::int32_t>::min()));
  };
  // Both the tile's own points and all others ascend: each run is walked through together with the list.
  for (const auto& [from, until] : {std::pair{std::uint32_t{0}, part.num_own}, {part.num_own, part.num_vertices()}}) {
    if (from == until) continue;
    auto at = begin(part.point[from]);
    for (std::uint32_t v = from; v < until && at != moved.end(); ++v) {
      if (at->first < part.point[v]) at = begin(part.point[v]);
      if (at != moved.end() && at->first == part.point[v]) part.height[v] = at->second;
    }
  }
}

// Keeps the numbers that triangles use, in their order; `triangle` then holds vertices.
void keep_used(std::vector<std::uint32_t> triangle, const Numbering& numbering, Part& part) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> vertex(numbering.size(), kNone);
  for (const std::uint32_t v : triangle) vertex[v] = 0;
  for (std::uint32_t i = 0; i < vertex.size(); ++i) {
    const bool is_own = i < part.own.position.size();
    if (vertex[i] == kNone) {
      if (is_own) part.unused.push_back(i);
      continue;
    }
    vertex[i] = part.num_vertices();
    const Located p = numbering.at(i);
    part.point.push_back(p.point);
    part.position.push_back(p.position);
    part.height.push_back(p.height);
    part.num_own += is_own ? 1 : 0;
  }
  for (std::uint32_t& v : triangle) v = vertex[v];
  part.triangle = std::move(triangle);
}

// Smallest vertex first, ascending: a counting sort by the first vertex, then few triangles of each.
void put_in_order(std::vector<std::uint32_t>& triangle, std::uint32_t num_vertices) {
  using Corners = std::array<std::uint32_t, 3>;
  std::vector<std::uint32_t> begin(std::size_t{num_vertices} + 1, 0);
  const std::size_t num_triangles = triangle.size() / 3;
  for (std::size_t t = 0; t < num_triangles; ++t)
    ++begin[std::min({triangle[3 * t], triangle[3 * t + 1], triangle[3 * t + 2]}) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Corners> sorted(num_triangles);
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t t = 0; t < num_triangles; ++t) {
    const std::uint32_t a = triangle[3 * t], b = triangle[3 * t + 1], c = triangle[3 * t + 2];
    const std::uint32_t first = std::min({a, b, c});
    sorted[next[first]++] = a == first ? Corners{a, b, c} : b == first ? Corners{b, c, a} : Corners{c, a, b};
  }
  for (std::uint32_t v = 0; v < num_vertices; ++v)
    if (begin[v + 1] - begin[v] > 1)
      std::sort(sorted.begin() + begin[v], sorted.begin() + begin[v + 1],
                [](const Corners& a, const Corners& b) { return a[1] != b[1] ? a[1] < b[1] : a[2] < b[2]; });
  for (std::size_t t = 0; t < num_triangles; ++t) std::copy(sorted[t].begin(), sorted[t].end(), &triangle[3 * t]);
}

void check_orientation(const Part& part, const std::string& path) {
  for (std::uint32_t t = 0; t < part.num_triangles(); ++t) {
    const std::uint32_t* v = &part.triangle[3 * std::size_t{t}];
    if (orientation(part.position[v[0]], part.position[v[1]], part.position[v[2]]) <= 0)
      contradicts(path, "a triangle at (" + std::to_string(part.position[v[0]].x) + ", " +
                            std::to_string(part.position[v[0]].y) + ") is not counter-clockwise");
  }
}

void mark_hull(std::span<const TriangleFile> files, Part& part) {
  part.is_hull.assign(part.num_vertices(), 0);
  for (const TriangleFile& file : files)
    for (std::size_t i = 0; i + 1 < file.hull_edge.size(); i += 2) {
      const auto from = part.find(PointId(file.hull_edge[i])), to = part.find(PointId(file.hull_edge[i + 1]));
      if (!from || !to ||
          !std::binary_search(part.graph.boundary.begin(), part.graph.boundary.end(), DirectedEdge{*from, *to}))
        contradicts(file.path, "hull edge " + std::to_string(i / 2) + " is no boundary edge of the tile's triangles");
      part.hull_edge.push_back({*from, *to});
      part.is_hull[*from] = part.is_hull[*to] = 1;
    }
  std::sort(part.hull_edge.begin(), part.hull_edge.end());
  part.hull_edge.erase(std::unique(part.hull_edge.begin(), part.hull_edge.end()), part.hull_edge.end());
}

void mark_rim(Part& part) {
  part.is_rim.assign(part.num_vertices(), 0);
  for (const DirectedEdge& e : part.graph.boundary)
    if (!std::binary_search(part.hull_edge.begin(), part.hull_edge.end(), e))
      part.is_rim[e.origin] = part.is_rim[e.target] = 1;
}

}  // namespace

std::optional<std::uint32_t> Part::find(PointId id) const {
  // Own points are a run of ascending ids, foreign ones another.
  const auto middle = point.begin() + num_own;
  for (const auto& [first, last] : {std::pair{point.begin(), middle}, {middle, point.end()}}) {
    const auto at = std::lower_bound(first, last, id.value);
    if (at != last && *at == id.value) return static_cast<std::uint32_t>(at - point.begin());
  }
  return std::nullopt;
}

LatticeBox Part::bounds() const {
  LatticeBox box;
  for (const LatticePoint p : position) box.extend(p);
  return box;
}

std::vector<std::uint32_t> Part::rim() const {
  std::vector<std::uint32_t> out;
  for (std::uint32_t v = 0; v < num_vertices(); ++v)
    if (is_rim[v]) out.push_back(v);
  std::sort(out.begin(), out.end(), [&](std::uint32_t a, std::uint32_t b) { return point[a] < point[b]; });
  return out;
}

Part load_part(const RunContext& context, std::uint32_t tile) {
  Part part;
  const store::Reader arranged(context.points_unit(tile));
  const std::uint64_t count = context.outline.count[tile];
  if (arranged.size("x") != count) contradicts(arranged.path(), "its points are not those of the outline");
  part.own = read_points(arranged, 0, count);
  const auto num_own = static_cast<std::uint32_t>(count);
  {
    std::vector<TriangleFile> files;
    files.push_back(read_triangles(context, Phase::triangulate, tile, num_own));
    files.push_back(read_triangles(context, Phase::seam, tile, num_own));
    if (context.rivers)
      for (TriangleFile& file : files) remove_hull_edges(context, tile, file);
    const std::size_t num_first = files[0].triangle.size() + files[1].triangle.size();
    if (context.rivers) files.push_back(added_triangles(context, tile));
    const Numbering numbering(tile, part.own, files);
    std::vector<std::uint32_t> triangle = numbered(files, numbering);
    if (context.rivers) {
      std::vector<std::uint32_t> come(triangle.begin() + static_cast<std::ptrdiff_t>(num_first), triangle.end());
      triangle.resize(num_first);
      remove_gone(context, tile, numbering, triangle);
      triangle.insert(triangle.end(), come.begin(), come.end());
    }
    keep_used(std::move(triangle), numbering, part);
    check_orientation(part, files[0].path);
    put_in_order(part.triangle, part.num_vertices());
    part.graph = make_vertex_graph(part.num_vertices(), part.triangle);
    mark_hull(files, part);
  }
  mark_rim(part);
  part.measured = part.height;
  if (context.rivers) take_heights(context, part);
  return part;
}

std::vector<std::uint8_t> has_lower_neighbor(const Part& part) {
  const auto key = [&](std::uint32_t v) { return std::tie(part.height[v], part.position[v]); };
  std::vector<std::uint8_t> flag(part.num_vertices());
  for (std::uint32_t v = 0; v < flag.size(); ++v) {
    const auto neighbors = part.graph.neighbors(v);
    flag[v] = std::any_of(neighbors.begin(), neighbors.end(), [&](std::uint32_t w) { return key(w) < key(v); });
  }
  return flag;
}

std::vector<std::uint8_t> outlet_flags(const RunContext& context, const Part& part) {
  const PitOptions& pits = context.options.pits;
  std::vector<std::uint8_t> flag(part.num_vertices(), 0);
  if (pits.outlets == OutletPolicy::hull) flag = part.is_hull;
  if (pits.outlets == OutletPolicy::lowest)
    if (const auto lowest = part.find(context.outline.lowest.point)) flag[*lowest] = 1;
  if (pits.outlets == OutletPolicy::layer)
    context.places->outlets.mark(part.position, part.measured, part.triangle, flag);
  if (pits.voids_drain)
    mark_void_corners(part.position, part.triangle,
                      squared_edge_limit(pits.void_edge_m / context.plan.metres_per_unit, context.plan.lattice), flag);
  if (context.rivers)
    for (const std::uint64_t point : context.rivers->outlet)
      if (const auto v = part.find(PointId(point))) flag[*v] = 1;
  return flag;
}

}  // namespace hydrotin
