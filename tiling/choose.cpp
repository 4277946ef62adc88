#include <algorithm>

#include "hydrotin/lifting.h"
#include "hydrotin/nested_pools.h"
#include "hydrotin/pit_choice.h"
#include "hydrotin/pit_units.h"
#include "kept_pits.h"
#include "nested_store.h"
#include "phases.h"
#include "reduced_store.h"
#include "tiled_groups.h"

namespace hydrotin {
namespace {

store::Reader open_nest(const RunContext& context, std::uint32_t tile) {
  return store::Reader(context.layout.unit(Phase::nest, tile));
}

void require_outlet(const RunContext& context) {
  std::int64_t lowest = kNoLevel;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t)
    lowest = std::min(lowest, open_nest(context, t).integer("lowest_outlet"));
  if (lowest == kNoLevel)
    throw Error(ErrorKind::input, context.options.pits.outlet_layer +
                                      ": none of its features has a vertex of the terrain, so water could leave "
                                      "nowhere; check its CRS and place, or use pits.outlets: hull");
}

// A rim vertex counts for the first tile that has it.
void write_rim_counts(const RunContext& context, store::Writer& out) {
  std::vector<std::uint64_t> met, begin{0};
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    const auto rim = open_nest(context, t).read<std::uint64_t>("rim");
    std::vector<std::uint8_t> counts;
    for (const std::uint64_t id : rim) counts.push_back(!std::binary_search(met.begin(), met.end(), id));
    std::vector<std::uint64_t> both;
    std::set_union(met.begin(), met.end(), rim.begin(), rim.end(), std::back_inserter(both));
    met.swap(both);
    out.append("rim_counts", counts, "1: the vertex counts for this tile; for each entry of its rim");
    begin.push_back(begin.back() + counts.size());
  }
  out.append("count_begin", begin, "offsets of the tiles into rim_counts, one more than tiles");
}

struct Plateaus {
  std::vector<Pit> pit;                                      // of all tiles
  std::vector<std::pair<LatticePoint, std::uint64_t>> seed;  // representative of the pit, a vertex in the tile
  std::vector<std::uint32_t> tile;                           // of each seed
};

// Pits of the terrain as measured, with their shares of tiles.
Plateaus read_all_plateaus(const RunContext& context) {
  Plateaus out;
  std::vector<PlateauSummary> open;
  GroupJoiner joiner;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    const store::Reader in = open_nest(context, t);
    for (const Pit& pit : read_pits(in, "")) {
      out.pit.push_back(pit);
      out.seed.emplace_back(pit.representative, pit.vertex);
      out.tile.push_back(t);
    }
    const PlateauSummary& part = open.emplace_back(read_open_plateaus(in, ""));
    for (std::size_t i = 0; i < part.num_open(); ++i) {
      const std::uint32_t piece = joiner.add_piece(t, 0);
      for (std::uint32_t r = part.rim_begin[i]; r < part.rim_begin[i + 1]; ++r)
        joiner.add_vertex(part.rim_vertex[r], piece);
    }
  }
  const std::vector<Pit> across = resolve_plateaus(open);
  out.pit.insert(out.pit.end(), across.begin(), across.end());
  const JoinedGroups groups = joiner.join();
  for (std::uint32_t g = 0; g < groups.owner.size(); ++g) {
    const auto pieces = groups.pieces_of(g);
    LatticePoint representative = open[groups.tile[pieces[0]]].representative[groups.index[pieces[0]]];
    for (const std::uint32_t p : pieces)
      representative = std::min(representative, open[groups.tile[p]].representative[groups.index[p]]);
    for (const std::uint32_t p : pieces) {
      const PlateauSummary& part = open[groups.tile[p]];
      out.seed.emplace_back(representative, part.rim_vertex[part.rim_begin[groups.index[p]]]);
      out.tile.push_back(groups.tile[p]);
    }
  }
  return out;
}

std::vector<std::uint8_t> pits_kept(const RunContext& context, const std::vector<PitBasin>& pits) {
  const PitOptions& options = context.options.pits;
  if (options.cheapest) return keep_all_but_cheapest(pits, *options.cheapest);
  std::vector<std::uint8_t> is_inside, is_listed;
  if (!options.keep.ids.empty()) is_listed = listed_pits(options.keep.ids, pits.size(), "pits.keep.ids");
  if (!options.keep.inside.empty())
    for (const PitBasin& pit : pits) is_inside.push_back(context.places->keep.covers(pit.pit.representative));
  return pits_to_keep(
      pits, keep_conditions(options.keep, context.plan.lattice, context.plan.metres_per_unit, is_inside, is_listed));
}

void write_table(store::Writer& out, const std::vector<PitBasin>& pits, const std::vector<std::uint8_t>& is_kept) {
  std::vector<std::int32_t> xyz, spill;
  std::vector<std::uint64_t> plateau, vertices;
  std::vector<std::uint32_t> parent;
  std::vector<std::int64_t> displacement, area;
  std::vector<double> volume;
  for (const PitBasin& b : pits) {
    xyz.insert(xyz.end(), {b.pit.representative.x, b.pit.representative.y, b.pit.height});
    spill.insert(spill.end(), {b.spill_position.x, b.spill_position.y, b.spill_level});
    plateau.push_back(b.pit.num_vertices);
    parent.push_back(b.parent);
    vertices.push_back(b.num_vertices);
    displacement.push_back(b.displacement);
    area.push_back(b.doubled_area);
    volume.push_back(b.volume);
  }
  out.append("pit_xyz", xyz, "smallest vertex by (x, y) of each pit, and height, lattice; pits ascend by it");
  out.append("pit_plateau", plateau, "vertices of its plateau");
  out.append("pit_parent", parent, "the pit it overflows into; 4294967295: for good");
  out.append("spill_xyz", spill, "where it overflows, and the level, lattice");
  out.append("basin_vertices", vertices, "vertices lower than the level");
  out.append("basin_displacement", displacement, "z lattice: sum of level - height over them");
  out.append("basin_doubled_area", area, "of the water at the level, squared lattice units");
  out.append("basin_volume", volume, "of that water, cubed lattice units");
  out.append("kept", is_kept, "1: stays");
}

}  // namespace

void rank_pools_of_all(const RunContext& context) {
  require_outlet(context);
  std::vector<ReducedPools> parts;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    parts.push_back(read_pools(open_nest(context, t)));
    parts.back().pit = {};  // decided already
  }
  const RankedPools ranked = rank_pools(parts, context.options.pits.cheapest.has_value());
  if (!ranked.all_drain)
    throw Error(ErrorKind::storage, context.layout.unit(Phase::nest, 0) +
                                        ": some triangles are joined to no others; delete the scratch folder and run "
                                        "again");
  store::Writer out(context.layout.unit(Phase::rank, 0));
  out.set("recipe", context.recipe(Phase::rank));
  write_ranking(out, ranked);
  write_rim_counts(context, out);
  out.commit();
}

void choose_pits(const RunContext& context) {
  RankedPools ranked = read_ranking(store::Reader(context.layout.unit(Phase::rank, 0)));
  std::vector<DecidedPit> decided;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    add_answers(store::Reader(context.layout.unit(Phase::weigh, t)), ranked);
    const std::vector<DecidedPit> own = read_pools(open_nest(context, t)).pit;
    decided.insert(decided.end(), own.begin(), own.end());
  }
  const Plateaus plateaus = read_all_plateaus(context);
  const std::vector<PitBasin> pits = nested_pits(std::move(decided), ranked, plateaus.pit);
  std::vector<std::uint8_t> is_kept(pits.size(), 0);
  const PitOptions& options = context.options.pits;
  if (options.method != PitMethod::none && (options.keep.any() || options.cheapest)) is_kept = pits_kept(context, pits);
  std::vector<std::vector<std::uint64_t>> seeds(context.plan.num_tiles());
  for (std::size_t i = 0; i < plateaus.seed.size(); ++i) {
    const auto at = std::lower_bound(pits.begin(), pits.end(), plateaus.seed[i].first,
                                     [](const PitBasin& pit, LatticePoint p) { return pit.pit.representative < p; });
    if (at != pits.end() && at->pit.representative == plateaus.seed[i].first &&
        is_kept[static_cast<std::size_t>(at - pits.begin())])
      seeds[plateaus.tile[i]].push_back(plateaus.seed[i].second);
  }
  store::Writer out(context.layout.unit(Phase::choose, 0));
  out.set("recipe", context.recipe(Phase::choose));
  write_table(out, pits, is_kept);
  std::vector<std::uint64_t> begin{0};
  for (const auto& own : seeds) {
    out.append("kept_seed", own, "a vertex of each kept pit in the tile: tile << 32 | index");
    begin.push_back(begin.back() + own.size());
  }
  out.append("kept_begin", begin, "offsets of the tiles into kept_seed, one more than tiles");
  out.commit();
}

}  // namespace hydrotin
