#include <algorithm>
#include <string>

#include "block_index.h"
#include "hydrotin/lifting.h"
#include "phases.h"
#include "reduced_store.h"
#include "whole_array.h"

namespace hydrotin {
namespace {

store::Reader open_spill(const RunContext& context, std::uint32_t tile) {
  return store::Reader(context.layout.unit(Phase::spill, tile));
}

RimLevels levels_of_all(const RunContext& context) {
  std::vector<SpillTree> trees(context.plan.num_tiles());
  for_all(context, trees.size(),
          [&](std::uint64_t t) { trees[t] = read_tree(open_spill(context, static_cast<std::uint32_t>(t))); });
  RimLevels levels = drain(trees);
  const auto lost = std::find(levels.level.begin(), levels.level.end(), kNoLevel);
  if (lost != levels.level.end())
    throw Error(
        ErrorKind::storage,
        context.layout.unit(Phase::spill, 0) + ": no way out for vertex " +
            std::to_string(PointId(levels.vertex[static_cast<std::size_t>(lost - levels.level.begin())]).index()) +
            " of a tile, so the parts do not fit together; delete the scratch folder and run again");
  return levels;
}

// What all parts know together of the rim vertices.
struct RimFacts {
  std::vector<std::int32_t> height;
  std::vector<std::uint8_t> has_lower, is_outlet;
};

// Writes each tile's slice of the levels.
RimFacts write_slices(const RunContext& context, const RimLevels& levels, store::Writer& out) {
  RimFacts facts{std::vector<std::int32_t>(levels.vertex.size()), std::vector<std::uint8_t>(levels.vertex.size(), 0),
                 std::vector<std::uint8_t>(levels.vertex.size(), 0)};
  std::vector<std::uint64_t> begin{0};
  std::vector<std::uint8_t> is_met(levels.vertex.size(), 0);
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    const store::Reader in = open_spill(context, t);
    const auto rim = in.read<std::uint64_t>("rim");
    const auto height = in.read<std::int32_t>("rim_height");
    const auto has_lower = in.read<std::uint8_t>("rim_has_lower");
    const auto is_outlet = in.read<std::uint8_t>("rim_outlet");
    if (height.size() != rim.size() || has_lower.size() != rim.size() || is_outlet.size() != rim.size())
      throw Error(ErrorKind::storage, in.path() + ": its rim arrays differ in length; delete the file and run again");
    for (const std::uint64_t id : rim)
      if (PointId(id).tile() >= context.plan.num_tiles() + (context.rivers ? 1u : 0u))
        throw Error(ErrorKind::storage,
                    in.path() + ": a rim vertex is of a tile that does not exist; delete the file and run again");
    std::vector<std::int32_t> slice(rim.size());
    auto at = levels.vertex.begin();
    for (std::size_t i = 0; i < rim.size(); ++i) {
      at = std::lower_bound(at, levels.vertex.end(), rim[i]);
      const auto v = static_cast<std::size_t>(at - levels.vertex.begin());
      slice[i] = levels.level[v];
      if (is_met[v] && facts.height[v] != height[i])
        throw Error(ErrorKind::storage, in.path() +
                                            ": tiles disagree about the height of a vertex that they share; "
                                            "delete the scratch folder and run again");
      is_met[v] = 1;
      facts.height[v] = height[i];
      facts.has_lower[v] |= has_lower[i];
      facts.is_outlet[v] |= is_outlet[i];
    }
    begin.push_back(begin.back() + rim.size());
    out.append("rim_level", slice, "z lattice: final level of each entry of the tile's `rim`");
  }
  // Outlets once more, as all parts know them together.
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    std::vector<std::uint8_t> slice;
    auto at = levels.vertex.begin();
    for (const std::uint64_t id : open_spill(context, t).read<std::uint64_t>("rim")) {
      at = std::lower_bound(at, levels.vertex.end(), id);
      slice.push_back(facts.is_outlet[static_cast<std::size_t>(at - levels.vertex.begin())]);
    }
    out.append("rim_outlet", slice, "1: an outlet, for each entry of the tile's `rim`");
  }
  std::vector<std::uint64_t> rim_minima(context.plan.num_tiles() + 1);  // the last ones of new vertices of rivers
  for (std::size_t v = 0; v < levels.vertex.size(); ++v)
    rim_minima[PointId(levels.vertex[v]).tile()] += !facts.has_lower[v];
  rim_minima.pop_back();
  out.append("rim_minima", rim_minima, "rim vertices without a lower neighbour, by the tile that owns them");
  out.append("rim_begin", begin, "offsets of the tiles into rim_level, one more than tiles");
  return facts;
}

void set_lift_figures(const RimLevels& levels, const RimFacts& facts, store::Writer& out) {
  std::int64_t lifted = 0, total = 0, greatest = 0;
  for (std::size_t v = 0; v < levels.vertex.size(); ++v) {
    const std::int64_t rise = std::int64_t{levels.level[v]} - facts.height[v];
    lifted += rise > 0 ? 1 : 0;
    total += rise;
    greatest = std::max(greatest, rise);
  }
  out.set("rim_lifted", lifted);
  out.set("rim_lift_total", total);
  out.set("rim_lift_max", greatest);
}

// Pits that reach across tiles. All vertices of a plateau share one level, so any rim vertex of it tells it.
std::uint64_t write_shared_pits(const RunContext& context, const RimLevels& levels, store::Writer& out) {
  std::vector<PlateauSummary> parts;
  std::vector<std::pair<std::uint64_t, std::uint64_t>>
      rim_of;  // representative of a part's plateau, a rim vertex of it
  std::uint64_t decided = 0;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    const store::Reader in = open_spill(context, t);
    decided += in.size("pit_vertex");
    const PlateauSummary& part = parts.emplace_back(read_open_plateaus(in, ""));
    for (std::size_t i = 0; i < part.num_open(); ++i)
      if (!part.drains[i]) rim_of.emplace_back(part.vertex[i], part.rim_vertex[part.rim_begin[i]]);
  }
  std::sort(rim_of.begin(), rim_of.end());
  const std::vector<Pit> pits = resolve_plateaus(parts);
  std::vector<std::int32_t> xyz, level;
  std::vector<std::uint64_t> vertices;
  for (const Pit& pit : pits) {
    const auto found = std::lower_bound(rim_of.begin(), rim_of.end(), std::pair{pit.vertex, std::uint64_t{0}});
    const auto at = std::lower_bound(levels.vertex.begin(), levels.vertex.end(), found->second);
    if (at == levels.vertex.end() || *at != found->second)
      throw Error(ErrorKind::storage, context.layout.unit(Phase::spill, PointId(pit.vertex).tile()) +
                                          ": a plateau's rim vertex is on no rim; delete the file and run again");
    xyz.insert(xyz.end(), {pit.representative.x, pit.representative.y, pit.height});
    level.push_back(levels.level[static_cast<std::size_t>(at - levels.vertex.begin())]);
    vertices.push_back(pit.num_vertices);
  }
  out.append("pit_xyz", xyz, "pits across tiles before lifting: smallest vertex by (x, y), and height, lattice");
  out.append("pit_level", level, "z lattice: where the pit overflows");
  out.append("pit_vertices", vertices, "vertices of the plateau");
  return decided + pits.size();
}

std::int64_t lowest_outlet(const RunContext& context) {
  std::int64_t lowest = kNoLevel;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t)
    lowest = std::min(lowest, open_spill(context, t).integer("lowest_outlet"));
  return lowest;
}

void require_outlet(const RunContext& context) {
  if (lowest_outlet(context) == kNoLevel)
    throw Error(ErrorKind::input, context.options.pits.outlet_layer +
                                      ": none of its features has a vertex of the terrain, so water could leave "
                                      "nowhere; check its CRS and place, or use pits.outlets: hull");
}

}  // namespace

void drain_tiles(const RunContext& context) {
  require_outlet(context);
  const RimLevels levels = levels_of_all(context);
  store::Writer out(context.layout.unit(Phase::drain, 0));
  out.set("recipe", context.recipe(Phase::drain));
  const RimFacts facts = write_slices(context, levels, out);
  set_lift_figures(levels, facts, out);
  out.set("pits_before", static_cast<std::int64_t>(write_shared_pits(context, levels, out)));
  out.set("lowest_outlet", lowest_outlet(context));
  std::int64_t minima = std::count(facts.has_lower.begin(), facts.has_lower.end(), std::uint8_t{0});
  std::vector<std::int32_t> bounds;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    const store::Reader in = open_spill(context, t);
    minima += in.integer("inner_minima");
    const auto box = in.read<std::int32_t>("bounds");
    if (box.size() != 4)
      throw Error(ErrorKind::storage, in.path() + ": its bounds are no box; delete the file and run again");
    bounds.insert(bounds.end(), box.begin(), box.end());
  }
  out.append("tile_bounds", bounds, "boxes of the tiles' triangles: min x, min y, max x, max y");
  out.set("minima_before", minima);
  out.set("rim_vertices", static_cast<std::int64_t>(levels.vertex.size()));
  out.commit();
}

}  // namespace hydrotin
