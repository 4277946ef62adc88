#include <algorithm>
#include <map>
#include <numeric>

#include "phases.h"
#include "store.h"
#include "surface.h"
#include "tiled_groups.h"

namespace hydrotin {
namespace {

struct LakePieces {
  std::vector<std::uint64_t> seed, size, rim_begin, rim, cell_begin;
  std::vector<std::int32_t> cell;
};

LakePieces read_lakes(const RunContext& context, std::uint32_t tile) {
  const store::Reader in(context.layout.unit(Phase::pools, tile));
  LakePieces out{in.read<std::uint64_t>("lake_seed"),       in.read<std::uint64_t>("lake_size"),
                 in.read<std::uint64_t>("lake_rim_begin"),  in.read<std::uint64_t>("lake_rim"),
                 in.read<std::uint64_t>("lake_cell_begin"), in.read<std::int32_t>("lake_cell")};
  const std::size_t n = out.seed.size();
  if (out.size.size() != n || out.rim_begin.size() != n + 1 || out.cell_begin.size() != n + 1 ||
      out.rim_begin.back() != out.rim.size() || out.cell_begin.back() * 2 != out.cell.size() ||
      !std::is_sorted(out.rim_begin.begin(), out.rim_begin.end()) ||
      !std::is_sorted(out.cell_begin.begin(), out.cell_begin.end()))
    throw Error(ErrorKind::storage, in.path() + ": its lakes contradict each other; delete the file and run again");
  return out;
}

}  // namespace

void join_lakes(const RunContext& context) {
  std::vector<LakePieces> tiles;
  GroupJoiner joiner;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    const LakePieces& lakes = tiles.emplace_back(read_lakes(context, t));
    for (std::size_t i = 0; i < lakes.seed.size(); ++i) {
      const std::uint32_t piece = joiner.add_piece(t, lakes.size[i]);
      for (std::uint64_t r = lakes.rim_begin[i]; r < lakes.rim_begin[i + 1]; ++r)
        joiner.add_vertex(lakes.rim[r], piece);
    }
  }
  const JoinedGroups groups = joiner.join();
  store::Writer out(context.layout.unit(Phase::lakes, 0));
  out.set("recipe", context.recipe(Phase::lakes));
  // The owner's groups, with the cells of all their pieces.
  std::vector<std::uint64_t> begin{0}, seed, cell_begin{0}, filled_begin{0}, filled_seed;
  std::vector<std::int32_t> cell;
  const std::uint64_t max_lake = context.options.pits.largest_lake;
  std::size_t next_piece = 0;
  for (std::uint32_t t = 0; t < tiles.size(); ++t) {
    for (; next_piece < groups.tile.size() && groups.tile[next_piece] == t; ++next_piece)
      if (groups.size[groups.group[next_piece]] > max_lake)
        filled_seed.push_back(tiles[t].seed[groups.index[next_piece]]);
    filled_begin.push_back(filled_seed.size());
    for (const std::uint32_t group : groups.owned_by(t)) {
      if (groups.size[group] > max_lake) continue;
      std::vector<Cell> cells;
      for (const std::uint32_t piece : groups.pieces_of(group)) {
        const LakePieces& lakes = tiles[groups.tile[piece]];
        const std::size_t i = groups.index[piece];
        for (std::uint64_t c = lakes.cell_begin[i]; c < lakes.cell_begin[i + 1]; ++c)
          cells.emplace_back(lakes.cell[2 * c], lakes.cell[2 * c + 1]);
      }
      std::sort(cells.begin(), cells.end());
      cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
      for (const Cell& c : cells) cell.insert(cell.end(), {c.first, c.second});
      cell_begin.push_back(cell.size() / 2);
      const std::uint32_t first = groups.pieces_of(group).front();
      seed.push_back(tiles[groups.tile[first]].seed[groups.index[first]]);
    }
    begin.push_back(seed.size());
  }
  out.append("lake_begin", begin, "offsets of the tiles into lake_seed, one more than tiles");
  out.append("lake_seed", seed, "a vertex of each lake that the tile breaches: tile << 32 | index");
  out.append("lake_cell_begin", cell_begin, "offsets of the lakes into lake_cell, one more than lakes");
  out.append("lake_cell", cell, "cells of the grid in which they lie: x, y");
  out.append("filled_begin", filled_begin, "offsets of the tiles into filled_seed, one more than tiles");
  out.append("filled_seed", filled_seed, "a vertex of each piece that the tile has of a lake too large to be breached");
  out.set("filled", static_cast<std::int64_t>(std::count_if(groups.size.begin(), groups.size.end(),
                                                            [&](std::uint64_t size) { return size > max_lake; })));
  out.commit();
}

}  // namespace hydrotin
