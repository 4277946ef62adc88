#include <algorithm>
#include <limits>

#include "group_units.h"
#include "phases.h"
#include "store.h"
#include "tiled_groups.h"

namespace hydrotin {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint64_t kMemberBytes = 450;  // of a group that is solved, with all around it

struct TilePieces {
  std::uint32_t num_pieces = 0;  // then come its flats
  std::vector<std::uint64_t> size;
  TileParts own;
  std::vector<std::uint8_t> touches, drains;
  std::vector<std::uint32_t> rim_label, contact_flat, contact_piece;
};

TilePieces read_pieces(const RunContext& context, std::uint32_t tile) {
  const store::Reader in(context.layout.unit(Phase::members, tile));
  TilePieces out;
  out.num_pieces = static_cast<std::uint32_t>(in.integer("pieces"));
  out.size = in.read<std::uint64_t>("piece_size");
  out.own.parts = read_parts(in, out.size.size());
  out.own.rim_point = in.read<std::uint64_t>("rim_point");
  out.own.rim_part = in.read<std::uint32_t>("rim_part");
  out.touches = in.read<std::uint8_t>("flat_touches");
  out.drains = in.read<std::uint8_t>("flat_drains");
  out.rim_label = in.read<std::uint32_t>("rim_label");
  out.contact_flat = in.read<std::uint32_t>("contact_flat");
  out.contact_piece = in.read<std::uint32_t>("contact_piece");
  const auto beyond = [&](std::uint32_t label) { return label >= out.size.size(); };
  const auto no_part = [&](std::uint32_t p) { return p != kNone && p >= out.own.parts.size.size(); };
  if (out.size.size() != out.num_pieces + out.drains.size() || out.touches.size() != out.drains.size() ||
      out.rim_label.size() != out.own.rim_point.size() || out.own.rim_part.size() != out.own.rim_point.size() ||
      std::any_of(out.own.rim_part.begin(), out.own.rim_part.end(), no_part) ||
      out.contact_flat.size() != out.contact_piece.size() ||
      std::any_of(out.rim_label.begin(), out.rim_label.end(), beyond) ||
      std::any_of(out.contact_flat.begin(), out.contact_flat.end(), beyond) ||
      std::any_of(out.contact_piece.begin(), out.contact_piece.end(), beyond))
    throw Error(ErrorKind::storage, in.path() + ": its groups contradict each other; delete the file and run again");
  return out;
}

// Which flats are members: those that touch members somewhere and drain nowhere.
std::vector<std::vector<std::uint8_t>> member_flats(const std::vector<TilePieces>& tiles) {
  GroupJoiner joiner;
  for (std::uint32_t t = 0; t < tiles.size(); ++t) {
    std::uint32_t first = kNone;
    for (std::size_t f = 0; f < tiles[t].drains.size(); ++f) first = std::min(first, joiner.add_piece(t, 0));
    for (std::size_t i = 0; i < tiles[t].own.rim_point.size(); ++i)
      if (tiles[t].rim_label[i] >= tiles[t].num_pieces)
        joiner.add_vertex(tiles[t].own.rim_point[i], first + tiles[t].rim_label[i] - tiles[t].num_pieces);
  }
  const JoinedGroups flats = joiner.join();
  std::vector<std::uint8_t> touches(flats.owner.size(), 0), drains(flats.owner.size(), 0);
  for (std::size_t p = 0; p < flats.group.size(); ++p) {
    touches[flats.group[p]] |= tiles[flats.tile[p]].touches[flats.index[p]];
    drains[flats.group[p]] |= tiles[flats.tile[p]].drains[flats.index[p]];
  }
  std::vector<std::vector<std::uint8_t>> is_member(tiles.size());
  for (std::size_t p = 0; p < flats.group.size(); ++p)
    is_member[flats.tile[p]].push_back(touches[flats.group[p]] && !drains[flats.group[p]]);
  return is_member;
}

void require_memory(const RunContext& context, const GroupUnits& units) {
  if (units.size.empty() || context.options.pits.method == PitMethod::lift) return;
  const auto largest = *std::max_element(units.size.begin(), units.size.end());
  if (largest * kMemberBytes <= context.options.run.memory_bytes) return;
  throw Error(ErrorKind::resource,
              "around some pits " + std::to_string(largest) + " vertices hang together and need about " +
                  std::to_string(largest * kMemberBytes >> 20) + " MiB to be solved, but run.memory is " +
                  std::to_string(context.options.run.memory_bytes >> 20) +
                  " MiB; raise run.memory, lower pits.largest_group or pits.largest_lake, or use pits.method: lift");
}

// The units with the tiles that have parts of them.
void write_units(const RunContext& context, const GroupUnits& units, store::Writer& out) {
  // A flat that stays is a unit of size 0; a lake too large to be drawn (lifting needs no more) is left out as well.
  std::vector<std::uint8_t> is_left_out(units.size.size());
  std::int64_t num_units = 0, num_undrawn = 0;
  for (std::size_t u = 0; u < units.size.size(); ++u) {
    const bool is_too_large = units.size[u] * kMemberBytes > context.options.run.memory_bytes;
    is_left_out[u] = units.size[u] == 0 || is_too_large;
    num_units += units.size[u] != 0;
    num_undrawn += is_too_large;
  }
  std::vector<std::uint32_t> unit_of, owner, tile_list;
  std::vector<std::uint64_t> begin{0}, tile_begin{0};
  std::vector<std::vector<std::uint32_t>> tiles_of(units.unit.size());
  for (std::uint32_t t = 0; t < units.unit.size(); ++t) {
    for (const std::uint32_t u : units.unit[t]) {
      unit_of.push_back(is_left_out[u] ? kNone : u);
      owner.push_back(is_left_out[u] ? kNone : units.owner[u]);
      if (is_left_out[u]) continue;
      auto& list = tiles_of[units.owner[u]];
      if (list.empty() || list.back() != t) list.push_back(t);
    }
    begin.push_back(unit_of.size());
  }
  for (const auto& list : tiles_of) {
    tile_list.insert(tile_list.end(), list.begin(), list.end());
    tile_begin.push_back(tile_list.size());
  }
  out.append("part_begin", begin, "offsets of the tiles into part_unit, one more than tiles");
  out.append("part_unit", unit_of,
             "for each entry of the tile's part_size what it is solved with; 4294967295: nothing");
  out.append("part_owner", owner, "the tile that solves it");
  out.append("tile_begin", tile_begin, "offsets of the tiles into tile_list, one more than tiles");
  out.append("tile_list", tile_list, "tiles with parts of what a tile solves");
  out.set("groups", num_units);
  out.set("undrawn", num_undrawn);
  out.set("cut", static_cast<std::int64_t>(units.num_cut));
  out.set("largest_group",
          static_cast<std::int64_t>(units.size.empty() ? 0 : *std::max_element(units.size.begin(), units.size.end())));
}

}  // namespace

void join_groups(const RunContext& context) {
  std::vector<TilePieces> tiles;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) tiles.push_back(read_pieces(context, t));
  const auto is_member_flat = member_flats(tiles);
  GroupJoiner joiner;
  for (std::uint32_t t = 0; t < tiles.size(); ++t) {
    TilePieces& tile = tiles[t];
    const auto stays = [&](std::uint32_t label) {
      return label >= tile.num_pieces && !is_member_flat[t][label - tile.num_pieces];
    };
    for (std::uint32_t i = 0; i < tile.size.size(); ++i) {
      const std::uint32_t piece = joiner.add_piece(t, stays(i) ? 0 : tile.size[i]);
      if (i == 0) tile.own.first_piece = piece;
    }
    for (std::size_t i = 0; i < tile.own.rim_point.size(); ++i)
      if (!stays(tile.rim_label[i])) joiner.add_vertex(tile.own.rim_point[i], tile.own.first_piece + tile.rim_label[i]);
    for (std::size_t i = 0; i < tile.contact_flat.size(); ++i)
      if (!stays(tile.contact_flat[i]))
        joiner.unite(tile.own.first_piece + tile.contact_flat[i], tile.own.first_piece + tile.contact_piece[i]);
  }
  const JoinedGroups groups = joiner.join();
  const bool cuts = context.options.pits.method != PitMethod::lift;
  std::vector<TileParts> parts;
  for (TilePieces& tile : tiles) parts.push_back(std::move(tile.own));
  const GroupUnits units = units_of(parts, groups, cut_grid(context.outline.bounds(), context.outline.vertices),
                                    cuts ? context.options.pits.largest_group : ~std::uint64_t{0});
  require_memory(context, units);
  store::Writer out(context.layout.unit(Phase::groups, 0));
  out.set("recipe", context.recipe(Phase::groups));
  write_units(context, units, out);
  out.commit();
}

}  // namespace hydrotin
