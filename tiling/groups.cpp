#include <algorithm>
#include <limits>

#include "phases.h"
#include "store.h"
#include "tiled_groups.h"

namespace hydrotin {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint64_t kMemberBytes = 450;  // of a group that is solved, with all around it

struct TilePieces {
  std::uint32_t first = 0, num_pieces = 0;  // number of its first piece in the joiner; then come its flats
  std::vector<std::uint64_t> size, rim_point;
  std::vector<std::uint8_t> touches, drains;
  std::vector<std::uint32_t> rim_label, contact_flat, contact_piece;
};

TilePieces read_pieces(const RunContext& context, std::uint32_t tile) {
  const store::Reader in(context.layout.unit(Phase::members, tile));
  TilePieces out;
  out.num_pieces = static_cast<std::uint32_t>(in.integer("pieces"));
  out.size = in.read<std::uint64_t>("piece_size");
  out.rim_point = in.read<std::uint64_t>("rim_point");
  out.touches = in.read<std::uint8_t>("flat_touches");
  out.drains = in.read<std::uint8_t>("flat_drains");
  out.rim_label = in.read<std::uint32_t>("rim_label");
  out.contact_flat = in.read<std::uint32_t>("contact_flat");
  out.contact_piece = in.read<std::uint32_t>("contact_piece");
  const auto beyond = [&](std::uint32_t label) { return label >= out.size.size(); };
  if (out.size.size() != out.num_pieces + out.drains.size() || out.touches.size() != out.drains.size() ||
      out.rim_label.size() != out.rim_point.size() || out.contact_flat.size() != out.contact_piece.size() ||
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
    for (std::size_t i = 0; i < tiles[t].rim_point.size(); ++i)
      if (tiles[t].rim_label[i] >= tiles[t].num_pieces)
        joiner.add_vertex(tiles[t].rim_point[i], first + tiles[t].rim_label[i] - tiles[t].num_pieces);
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

void require_memory(const RunContext& context, const JoinedGroups& groups) {
  if (groups.size.empty() || context.options.pits.method == PitMethod::lift) return;
  const auto largest = *std::max_element(groups.size.begin(), groups.size.end());
  if (largest * kMemberBytes <= context.options.run.memory_bytes) return;
  throw Error(ErrorKind::resource,
              "around some pits " + std::to_string(largest) + " vertices hang together and need about " +
                  std::to_string(largest * kMemberBytes >> 20) + " MiB to be solved, but run.memory is " +
                  std::to_string(context.options.run.memory_bytes >> 20) +
                  " MiB; raise run.memory, limit pits.max_breach_length_m, or use pits.method: lift");
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
      if (i == 0) tile.first = piece;
    }
    for (std::size_t i = 0; i < tile.rim_point.size(); ++i)
      if (!stays(tile.rim_label[i])) joiner.add_vertex(tile.rim_point[i], tile.first + tile.rim_label[i]);
    for (std::size_t i = 0; i < tile.contact_flat.size(); ++i)
      if (!stays(tile.contact_flat[i]))
        joiner.unite(tile.first + tile.contact_flat[i], tile.first + tile.contact_piece[i]);
  }
  const JoinedGroups groups = joiner.join();
  require_memory(context, groups);
  // A flat that stays is a group of size 0; a lake too large to be drawn (lifting needs no more) is left out as well.
  std::vector<std::uint32_t> group_of, owner;
  std::int64_t num_groups = 0, num_undrawn = 0;
  std::vector<std::uint8_t> is_left_out(groups.owner.size());
  for (std::size_t g = 0; g < groups.owner.size(); ++g) {
    const bool is_too_large = groups.size[g] * kMemberBytes > context.options.run.memory_bytes;
    is_left_out[g] = groups.size[g] == 0 || is_too_large;
    num_groups += groups.size[g] != 0;
    num_undrawn += is_too_large;
  }
  std::vector<std::uint64_t> begin{0}, tile_begin{0};
  std::vector<std::vector<std::uint32_t>> tiles_of(tiles.size());
  for (std::uint32_t t = 0; t < tiles.size(); ++t) {
    for (std::uint32_t i = 0; i < tiles[t].size.size(); ++i) {
      const std::uint32_t g = groups.group[tiles[t].first + i];
      group_of.push_back(is_left_out[g] ? kNone : g);
      owner.push_back(is_left_out[g] ? kNone : groups.owner[g]);
      if (is_left_out[g]) continue;
      auto& list = tiles_of[groups.owner[g]];
      if (list.empty() || list.back() != t) list.push_back(t);
    }
    begin.push_back(group_of.size());
  }
  std::vector<std::uint32_t> tile_list;
  for (const auto& list : tiles_of) {
    tile_list.insert(tile_list.end(), list.begin(), list.end());
    tile_begin.push_back(tile_list.size());
  }
  store::Writer out(context.layout.unit(Phase::groups, 0));
  out.set("recipe", context.recipe(Phase::groups));
  out.append("label_begin", begin, "offsets of the tiles into label_group, one more than tiles");
  out.append("label_group", group_of, "for each entry of the tile's piece_size its group; 4294967295: none");
  out.append("label_owner", owner, "the tile that solves it");
  out.append("tile_begin", tile_begin, "offsets of the tiles into tile_list, one more than tiles");
  out.append("tile_list", tile_list, "tiles with pieces of the groups that a tile solves");
  out.set("groups", num_groups);
  out.set("undrawn", num_undrawn);
  out.set("largest_group", static_cast<std::int64_t>(
                               groups.size.empty() ? 0 : *std::max_element(groups.size.begin(), groups.size.end())));
  out.commit();
}

}  // namespace hydrotin
