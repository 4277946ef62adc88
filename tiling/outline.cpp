#include "outline.h"

#include <algorithm>
#include <tuple>

#include "block_index.h"
#include "phases.h"
#include "store.h"
#include "whole_array.h"

namespace hydrotin {
namespace {

bool lower(const HullVertex& a, const HullVertex& b) {
  return std::tie(a.height, a.position) < std::tie(b.height, b.position);
}

HullVertex read_vertex(const store::Reader& in, std::uint32_t tile, std::uint32_t index) {
  const TilePoints point = read_points(in, index, 1);
  return {PointId(tile, index), point.position[0], point.height[0]};
}

struct TileOutline {
  LatticeBox box, reference_box;
  std::uint64_t count = 0, points = 0, removed = 0, reference_count = 0;
  std::vector<HullVertex> hull;
  HullVertex lowest;
};

// @param prefix  of the reference points; null: there are none
TileOutline outline_of(const store::Reader& in, std::uint32_t tile, const char* prefix) {
  TileOutline out;
  for (const LatticeBox& b : read_block_boxes(in)) out.box.extend(b);
  out.count = in.size("x");
  out.points = static_cast<std::uint64_t>(in.integer("points"));
  if (in.has_attribute("removed")) out.removed = static_cast<std::uint64_t>(in.integer("removed"));
  if (prefix != nullptr) {
    for (const LatticeBox& b : read_block_boxes(in, prefix)) out.reference_box.extend(b);
    out.reference_count = in.size(std::string(prefix) + "x");
  }
  if (out.count == 0) return out;
  for (const std::uint32_t i : in.read<std::uint32_t>("hull")) out.hull.push_back(read_vertex(in, tile, i));
  out.lowest = read_vertex(in, tile, static_cast<std::uint32_t>(in.integer("lowest")));
  return out;
}

// Of the tiles' points as `from` left them.
void write_outline(const RunContext& context, Phase from, Phase phase, const char* prefix) {
  Outline outline;
  std::vector<HullVertex> candidates;
  std::vector<TileOutline> tiles(context.plan.num_tiles());
  for_all(context, tiles.size(), [&](std::uint64_t t) {
    tiles[t] = outline_of(store::Reader(context.layout.unit(from, t)), static_cast<std::uint32_t>(t), prefix);
  });
  for (const TileOutline& tile : tiles) {
    outline.box.push_back(tile.box);
    outline.count.push_back(tile.count);
    outline.reference_count.push_back(tile.reference_count);
    outline.reference_box.push_back(tile.reference_box);
    outline.points += tile.points;
    outline.vertices += tile.count;
    outline.removed += tile.removed;
    candidates.insert(candidates.end(), tile.hull.begin(), tile.hull.end());
    if (tile.count > 0 && (outline.lowest.point == PointId() || lower(tile.lowest, outline.lowest)))
      outline.lowest = tile.lowest;
  }
  if (outline.vertices == 0)
    throw Error(ErrorKind::input,
                context.plan.files.front().path +
                    ": no input has a point of the classes wanted; check input.classes against `hydrotin info`");
  std::vector<LatticePoint> position;
  for (const HullVertex& v : candidates) position.push_back(v.position);
  for (const std::uint32_t i : convex_hull(position)) outline.hull.push_back(candidates[i]);
  if (outline.hull.size() < 3)
    throw Error(ErrorKind::input,
                context.plan.files.front().path + ": all " + std::to_string(outline.vertices) +
                    " points lie on one line, so there is no triangle; give points that span an area");

  store::Writer out(context.layout.unit(phase, 0));
  out.set("recipe", context.recipe(phase));
  out.set("removed", static_cast<std::int64_t>(outline.removed));
  out.append("tile_count", outline.count, "vertices");
  out.append("tile_box", flatten(outline.box), "tight boxes: min x, min y, max x, max y");
  out.append("tile_reference_count", outline.reference_count, "reference points");
  out.append("tile_reference_box", flatten(outline.reference_box), "tight boxes of these");
  std::vector<std::uint64_t> point;
  std::vector<std::int32_t> xyz;
  outline.hull.push_back(outline.lowest);
  for (const HullVertex& v : outline.hull) {
    point.push_back(v.point.value);
    xyz.insert(xyz.end(), {v.position.x, v.position.y, v.height});
  }
  out.append("hull_point", point, "tile << 32 | index; the last one is the lowest vertex");
  out.append("hull_xyz", xyz);
  out.set("points", static_cast<std::int64_t>(outline.points));
  out.commit();
}

}  // namespace

void survey_points(const RunContext& context) {
  write_outline(context, Phase::arrange, Phase::survey, nullptr);
}

void make_outline(const RunContext& context) {
  write_outline(context, context.thins() ? Phase::thin : Phase::arrange, Phase::outline,
                context.has_reference() ? context.reference_prefix() : nullptr);
}

Outline load_outline(const std::string& path) {
  const store::Reader in(path);
  Outline out;
  out.count = in.read<std::uint64_t>("tile_count");
  out.box = unflatten(in.read<std::int32_t>("tile_box"));
  const auto point = in.read<std::uint64_t>("hull_point");
  const auto xyz = in.read<std::int32_t>("hull_xyz");
  out.reference_count = in.read<std::uint64_t>("tile_reference_count");
  out.reference_box = unflatten(in.read<std::int32_t>("tile_reference_box"));
  if (out.box.size() != out.count.size() || out.reference_count.size() != out.count.size() ||
      out.reference_box.size() != out.count.size() || point.size() < 4 || xyz.size() != 3 * point.size())
    throw Error(ErrorKind::storage, path + ": the outline contradicts itself; delete it and run again");
  for (std::size_t i = 0; i < point.size(); ++i)
    out.hull.push_back({PointId(point[i]), {xyz[3 * i], xyz[3 * i + 1]}, xyz[3 * i + 2]});
  out.lowest = out.hull.back();
  out.hull.pop_back();
  out.points = static_cast<std::uint64_t>(in.integer("points"));
  for (const std::uint64_t c : out.count) out.vertices += c;
  out.removed = static_cast<std::uint64_t>(in.integer("removed"));
  out.duplicates = out.points - out.vertices - out.removed;
  out.tree = BoxTree(out.box);
  out.reference_tree = BoxTree(out.reference_box);
  return out;
}

}  // namespace hydrotin
