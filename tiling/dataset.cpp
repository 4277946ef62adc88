#include "dataset.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <limits>

#include "layout.h"
#include "reduced_store.h"
#include "terrain_file.h"

namespace hydrotin {
namespace {

[[noreturn]] void contradicts(const std::string& path, const std::string& what) {
  throw Error(ErrorKind::storage, path + ": " + what + "; delete the file and run again");
}

void read_foreign(const store::Reader& in, const DatasetIndex& index, TerrainTile& out) {
  out.foreign = in.read<std::uint64_t>("foreign_point");
  const auto xyz = in.read<std::int32_t>("foreign_xyz");
  const auto height = in.read<std::int32_t>("foreign_height");
  if (xyz.size() != 3 * out.foreign.size() || height.size() != out.foreign.size())
    contradicts(out.path, "the arrays of its foreign points differ in length");
  if (std::adjacent_find(out.foreign.begin(), out.foreign.end(), std::greater_equal<>{}) != out.foreign.end())
    contradicts(out.path, "its foreign points do not ascend");
  for (std::size_t i = 0; i < out.foreign.size(); ++i) {
    const PointId id(out.foreign[i]);
    if (id.tile() == out.tile || id.tile() > index.num_tiles() ||
        id.index() >= (id.tile() == index.num_tiles() ? index.new_position.size() : index.count[id.tile()]))
      contradicts(out.path, "foreign point " + std::to_string(i) + " is no point of another tile");
    out.position.push_back({xyz[3 * i], xyz[3 * i + 1]});
    out.measured.push_back(xyz[3 * i + 2]);
  }
  out.height.insert(out.height.end(), height.begin(), height.end());
}

// Arrays that the checks do not use: reading them tests their checksums.
void read_the_rest(const store::Reader& in) {
  static_cast<void>(read_lattice(in));
  if (in.has(std::string(kRemoved) + "x")) {
    static_cast<void>(read_points(in, 0, in.size(std::string(kRemoved) + "x"), kRemoved));
    static_cast<void>(read_block_boxes(in, kRemoved));
  }
  static_cast<void>(read_pits(in, "final_"));
  static_cast<void>(read_open_plateaus(in, "final_"));
  const auto level = in.read<std::int32_t>("pit_level");
  if (in.read<std::int32_t>("pit_xyz").size() != 3 * level.size() ||
      in.read<std::uint64_t>("pit_vertices").size() != level.size())
    contradicts(in.path(), "the arrays of its pits differ in length");
}

}  // namespace

std::string DatasetIndex::tile_path(std::uint32_t tile) const {
  return tile == num_tiles() ? Layout(dir).rivers() : Layout(dir).terrain(tile);
}

std::string DatasetIndex::place(LatticePoint p) const {
  char text[80];
  std::snprintf(text, sizeof text, "(%.3f, %.3f)", lattice.x(p.x), lattice.y(p.y));
  return text;
}

namespace {

// What the index and terrain/rivers.h5 say of rivers.
void read_rivers(const store::Reader& index, DatasetIndex& out) {
  out.river_edges = static_cast<std::uint64_t>(index.integer("river_edges"));
  out.invalid_river_edges = static_cast<std::uint64_t>(index.integer("invalid_river_edges"));
  out.river_flow = index.integer("river_flow") != 0;
  out.river_valley = index.integer("river_valley") != 0;
  const store::Reader in(Layout(out.dir).rivers());
  const auto xyz = in.read<std::int32_t>("new_xyz");
  const auto edge = in.read<std::uint64_t>("contradicted_edge");
  if (xyz.size() % 3 != 0 || edge.size() % 2 != 0) contradicts(in.path(), "its arrays are cut");
  for (std::size_t i = 0; i < xyz.size(); i += 3) {
    out.new_position.push_back({xyz[i], xyz[i + 1]});
    out.new_height.push_back(xyz[i + 2]);
  }
  for (std::size_t i = 0; i < edge.size(); i += 2) out.contradicted.emplace_back(edge[i], edge[i + 1]);
  if (!std::is_sorted(out.contradicted.begin(), out.contradicted.end()))
    contradicts(in.path(), "its river edges do not ascend");
}

// The arrays of rivers in a terrain file.
void read_river_arrays(const store::Reader& in, TerrainTile& out) {
  out.embedded = out.measured;
  if (!in.has("river_moved")) return;
  const auto moved = in.read<std::uint32_t>("river_moved");
  const auto height = in.read<std::int32_t>("river_height");
  out.river_edge = in.read<std::uint32_t>("river_edge");
  out.added_triangle = in.read<std::uint32_t>("added_triangle");
  static_cast<void>(in.read<std::uint32_t>("invalid_river_edge"));
  static_cast<void>(in.read<std::uint32_t>("no_valley_edge"));
  if (in.read<std::uint32_t>("river_source").size() != in.read<double>("steepest_way").size())
    contradicts(in.path(), "its sources of rivers and their slopes have different lengths");
  const auto is_beyond = [&](std::uint32_t v) { return v >= out.num_vertices(); };
  if (moved.size() != height.size() || out.river_edge.size() % 2 != 0 ||
      std::any_of(moved.begin(), moved.end(), is_beyond) ||
      std::any_of(out.river_edge.begin(), out.river_edge.end(), is_beyond) ||
      !std::is_sorted(out.added_triangle.begin(), out.added_triangle.end()) ||
      (!out.added_triangle.empty() && out.added_triangle.back() >= out.triangle.size() / 3))
    contradicts(out.path, "its arrays of rivers contradict each other");
  for (std::size_t i = 0; i < moved.size(); ++i) out.embedded[moved[i]] = height[i];
}

}  // namespace

DatasetIndex load_index(const std::string& dir) {
  DatasetIndex out;
  out.dir = dir;
  out.path = Layout(dir).index();
  const store::Reader in(out.path);
  out.lattice = read_lattice(in);
  out.count = in.read<std::uint64_t>("tile_count");
  out.box = unflatten(in.read<std::int32_t>("tile_box"));
  out.triangles = in.read<std::uint64_t>("tile_triangles");
  if (in.has("tile_checksum")) out.checksum = in.read<std::uint64_t>("tile_checksum");
  const auto number = [&](const std::string& name) {
    const std::int64_t value = in.integer(name);
    if (value < 0) contradicts(out.path, "the attribute '" + name + "' is negative");
    return static_cast<std::uint64_t>(value);
  };
  out.points = number("points");
  out.vertices = number("vertices");
  out.duplicates = number("duplicates");
  out.num_triangles = number("triangles");
  out.pits = number("pits");
  if (in.has_attribute("removed")) {
    out.removed = number("removed");
    out.removed_max_error = in.real("removed_max_error");
    out.removed_limit_millionths = in.integer("removed_limit_millionths");
  }
  out.order = static_cast<int>(std::min<std::uint64_t>(number("order"), 1'000'000));
  out.fingerprint = in.text("fingerprint");
  out.outlets = in.text("outlets");
  if (in.has_attribute("pits_kept")) out.pits_kept = number("pits_kept");
  out.lowest = PointId(static_cast<std::uint64_t>(in.integer("lowest_point")));
  const bool fits = number("tiles") == out.count.size() && out.box.size() == out.count.size() &&
                    out.triangles.size() == out.count.size() &&
                    (out.checksum.empty() || out.checksum.size() == out.count.size()) && !out.count.empty() &&
                    std::all_of(out.count.begin(), out.count.end(),
                                [](std::uint64_t c) { return c < std::numeric_limits<std::uint32_t>::max(); });
  if (!fits) contradicts(out.path, "its lists of tiles contradict each other");
  if (out.outlets != "hull" && out.outlets != "lowest" && out.outlets != "layer" && out.outlets != "none")
    contradicts(out.path, "the outlets '" + out.outlets + "' are not known");
  if (in.has_attribute("river_edges")) read_rivers(in, out);
  return out;
}

TerrainTile load_terrain_tile(const DatasetIndex& index, std::uint32_t tile) {
  TerrainTile out;
  out.path = index.tile_path(tile);
  out.tile = tile;
  const store::Reader in(out.path);
  const std::uint64_t count = index.count[tile];
  if (in.size("x") != count || in.size("y") != count || in.size("z") != count || in.size("height") != count)
    contradicts(out.path, "it does not hold the " + std::to_string(count) + " points that the index names");
  TilePoints own = read_points(in, 0, count);
  out.num_own = static_cast<std::uint32_t>(count);
  out.position = std::move(own.position);
  out.measured = std::move(own.height);
  out.height = in.read<std::int32_t>("height");
  out.block_box = read_block_boxes(in);
  read_foreign(in, index, out);
  out.triangle = in.read<std::uint32_t>("triangle");
  out.hull_edge = in.read<std::uint64_t>("hull_edge");
  out.triangle_box = unflatten(in.read<std::int32_t>("triangle_box"));
  if (out.triangle.size() != 3 * index.triangles[tile] || out.triangle.size() >= std::size_t{1} << 31)
    contradicts(out.path,
                "it does not hold the " + std::to_string(index.triangles[tile]) + " triangles that the index names");
  if (out.hull_edge.size() % 2 != 0) contradicts(out.path, "the array of hull edges is cut");
  if (out.triangle_box.size() != (out.triangle.size() / 3 + kRunTriangles - 1) / kRunTriangles)
    contradicts(out.path, "the boxes do not fit the triangles");
  if (std::any_of(out.triangle.begin(), out.triangle.end(), [&](std::uint32_t v) { return v >= out.num_vertices(); }))
    contradicts(out.path, "a triangle refers to a vertex that is not listed");
  for (const auto& [name, list] :
       {std::pair{"outlet_vertex", &out.outlet_vertex}, std::pair{"kept_vertex", &out.kept_vertex}}) {
    if (in.has(name)) *list = in.read<std::uint32_t>(name);
    if (std::any_of(list->begin(), list->end(), [&](std::uint32_t v) { return v >= out.num_vertices(); }))
      contradicts(out.path, std::string("the array '") + name + "' refers to a vertex that is not listed");
  }
  read_river_arrays(in, out);
  out.fingerprint = in.text("fingerprint");
  if (in.has_attribute("pit_method")) out.pit_method = in.text("pit_method");
  out.outlets = in.text("outlets");
  out.pits_removed = in.integer("pits_removed") != 0;
  read_the_rest(in);
  return out;
}

}  // namespace hydrotin
