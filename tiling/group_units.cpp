#include "group_units.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace hydrotin {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Cuts the groups that are too large.
class GroupDivider {
 public:
  GroupDivider(std::span<const TileParts> tiles, const JoinedGroups& groups, const CutGrid& grid, std::uint64_t most)
      : tiles_(tiles), groups_(groups), grid_(grid), most_(most) {}

  void divide(GroupUnits& out) {
    for (std::uint32_t g = 0; g < groups_.size.size(); ++g) out.num_cut += is_cut(g);
    if (out.num_cut == 0) return;
    place_lakes();
    count_cells();
    number_units(out);
    find_owners(out);
  }

  [[nodiscard]] bool is_cut(std::uint32_t group) const { return groups_.size[group] > most_; }
  [[nodiscard]] std::uint32_t group_of(std::uint32_t tile, std::size_t part) const {
    return groups_.group[tiles_[tile].first_piece + tiles_[tile].parts.piece[part]];
  }

 private:
  struct Cell {
    std::uint32_t group;
    std::uint64_t cell, members;
    std::uint32_t unit;
    [[nodiscard]] auto key() const { return std::tie(group, cell); }
  };

  // The cell of each part; of a lake that of its smallest vertex in all tiles.
  void place_lakes() {
    cell_.resize(tiles_.size());
    GroupJoiner joiner;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> lake;  // tile, part: by number in the joiner
    std::vector<std::uint32_t> number;
    for (std::uint32_t t = 0; t < tiles_.size(); ++t) {
      const GroupParts& parts = tiles_[t].parts;
      number.assign(parts.size.size(), kNone);
      for (std::uint32_t p = 0; p < parts.size.size(); ++p) {
        cell_[t].push_back(grid_.cell_of(parts.place[p]));
        if (!parts.is_lake[p] || !is_cut(group_of(t, p))) continue;
        number[p] = joiner.add_piece(t, 0);
        lake.emplace_back(t, p);
      }
      for (std::size_t i = 0; i < tiles_[t].rim_point.size(); ++i) {
        const std::uint32_t p = tiles_[t].rim_part[i];
        if (p != kNone && number[p] != kNone) joiner.add_vertex(tiles_[t].rim_point[i], number[p]);
      }
    }
    const JoinedGroups lakes = joiner.join();
    std::vector<LatticePoint> first(
        lakes.owner.size(), {std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max()});
    for (std::size_t i = 0; i < lake.size(); ++i) {
      LatticePoint& p = first[lakes.group[i]];
      p = std::min(p, tiles_[lake[i].first].parts.place[lake[i].second]);
    }
    for (std::size_t i = 0; i < lake.size(); ++i)
      cell_[lake[i].first][lake[i].second] = grid_.cell_of(first[lakes.group[i]]);
  }

  // The members of each cell of each group; a vertex of several tiles counts once.
  void count_cells() {
    std::vector<std::tuple<std::uint64_t, std::uint32_t, std::uint32_t>> shared;  // point, tile, part
    for (std::uint32_t t = 0; t < tiles_.size(); ++t) {
      const TileParts& tile = tiles_[t];
      for (std::uint32_t p = 0; p < tile.parts.size.size(); ++p)
        if (is_cut(group_of(t, p))) counted_.push_back({group_of(t, p), cell_[t][p], tile.parts.size[p], 0});
      for (std::size_t i = 0; i < tile.rim_point.size(); ++i)
        if (const std::uint32_t p = tile.rim_part[i]; p != kNone && is_cut(group_of(t, p)))
          shared.emplace_back(tile.rim_point[i], t, p);
    }
    std::sort(counted_.begin(), counted_.end(), [](const Cell& a, const Cell& b) { return a.key() < b.key(); });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < counted_.size(); ++i) {
      if (kept > 0 && counted_[kept - 1].key() == counted_[i].key())
        counted_[kept - 1].members += counted_[i].members;
      else
        counted_[kept++] = counted_[i];
    }
    counted_.resize(kept);
    std::sort(shared.begin(), shared.end());
    for (std::size_t i = 1; i < shared.size(); ++i)
      if (const auto& [point, t, p] = shared[i]; point == std::get<0>(shared[i - 1])) --find(t, p).members;
  }

  Cell& find(std::uint32_t tile, std::uint32_t part) {
    const Cell wanted{group_of(tile, part), cell_[tile][part], 0, 0};
    return *std::lower_bound(counted_.begin(), counted_.end(), wanted,
                             [](const Cell& a, const Cell& b) { return a.key() < b.key(); });
  }

  void number_units(GroupUnits& out) {
    std::vector<CountedCell> cells;
    for (std::size_t first = 0; first < counted_.size();) {
      std::size_t last = first;
      cells.clear();
      for (; last < counted_.size() && counted_[last].group == counted_[first].group; ++last)
        cells.push_back({counted_[last].cell, counted_[last].members});
      const std::vector<std::uint32_t> square = squares_of(cells, most_);
      const auto base = static_cast<std::uint32_t>(out.size.size());
      out.size.resize(std::size_t{base} + square.back() + 1, 0);
      for (std::size_t i = first; i < last; ++i) {
        counted_[i].unit = base + square[i - first];
        out.size[counted_[i].unit] += counted_[i].members;
      }
      first = last;
    }
  }

  void find_owners(GroupUnits& out) {
    out.owner.resize(out.size.size(), kNone);
    std::vector<std::uint64_t> largest(out.size.size(), 0), here(out.size.size(), 0);
    for (std::uint32_t t = 0; t < tiles_.size(); ++t) {
      std::vector<std::uint32_t> met;
      for (std::uint32_t p = 0; p < out.unit[t].size(); ++p) {
        if (!is_cut(group_of(t, p))) continue;
        const std::uint32_t u = out.unit[t][p] = find(t, p).unit;
        if (here[u] == 0) met.push_back(u);
        here[u] += tiles_[t].parts.size[p];
      }
      for (const std::uint32_t u : met) {
        if (here[u] > largest[u]) {
          largest[u] = here[u];
          out.owner[u] = t;
        }
        here[u] = 0;
      }
    }
  }

  std::span<const TileParts> tiles_;
  const JoinedGroups& groups_;
  const CutGrid& grid_;
  std::uint64_t most_;
  std::vector<std::vector<std::uint64_t>> cell_;  // [tiles][parts]
  std::vector<Cell> counted_;                     // by group and cell
};

}  // namespace

GroupUnits units_of(std::span<const TileParts> tiles, const JoinedGroups& groups, const CutGrid& grid,
                    std::uint64_t most) {
  GroupUnits out;
  GroupDivider divider(tiles, groups, grid, most);
  std::vector<std::uint32_t> unit_of(groups.size.size(), kNone);
  for (std::uint32_t g = 0; g < groups.size.size(); ++g) {
    if (divider.is_cut(g)) continue;
    unit_of[g] = static_cast<std::uint32_t>(out.size.size());
    out.size.push_back(groups.size[g]);
    out.owner.push_back(groups.owner[g]);
  }
  for (std::uint32_t t = 0; t < tiles.size(); ++t) {
    auto& list = out.unit.emplace_back();
    for (std::size_t p = 0; p < tiles[t].parts.size.size(); ++p) list.push_back(unit_of[divider.group_of(t, p)]);
  }
  divider.divide(out);
  return out;
}

}  // namespace hydrotin
