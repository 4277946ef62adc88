#include "hydrotin/group_cut.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>

namespace hydrotin {
namespace {

// Puts a zero bit before each bit.
std::uint64_t spread(std::uint32_t value) {
  std::uint64_t bits = value;
  bits = (bits | bits << 16) & 0x0000ffff0000ffffu;
  bits = (bits | bits << 8) & 0x00ff00ff00ff00ffu;
  bits = (bits | bits << 4) & 0x0f0f0f0f0f0f0f0fu;
  bits = (bits | bits << 2) & 0x3333333333333333u;
  return (bits | bits << 1) & 0x5555555555555555u;
}

/// Squares of one component; keeps its memory from one to the next.
class GroupCutter {
 public:
  GroupCutter(const ChangeableTerrain& terrain, std::span<const std::int32_t> level, const CutGrid& grid)
      : terrain_(terrain),
        level_(level),
        grid_(grid),
        square_(level.size(), kNoVertexNumber),
        is_in_lake_(level.size(), 0) {}

  [[nodiscard]] std::span<const std::uint32_t> square() const { return square_; }

  void add(std::span<const std::uint32_t> group, std::uint64_t most) {
    place_.clear();
    for (const std::uint32_t v : group) {
      if (level_[v] == terrain_.height[v]) {
        place_.emplace_back(grid_.cell_of(terrain_.position[v]), v);
        continue;
      }
      if (is_in_lake_[v]) continue;
      collect_lake(terrain_, level_, v, is_in_lake_, lake_);
      LatticePoint first = terrain_.position[v];
      for (const std::uint32_t w : lake_) first = std::min(first, terrain_.position[w]);
      for (const std::uint32_t w : lake_) place_.emplace_back(grid_.cell_of(first), w);
    }
    std::sort(place_.begin(), place_.end());
    cells_.clear();
    for (const auto& [cell, v] : place_) {
      if (cells_.empty() || cells_.back().cell != cell) cells_.push_back({cell, 0});
      ++cells_.back().members;
    }
    const std::vector<std::uint32_t> number = squares_of(cells_, most);
    std::size_t at = 0;
    for (const auto& [cell, v] : place_) {
      if (cells_[at].cell != cell) ++at;
      square_[v] = number[at];
    }
  }

 private:
  const ChangeableTerrain& terrain_;
  std::span<const std::int32_t> level_;
  const CutGrid& grid_;
  std::vector<std::uint32_t> square_;                           // [n]
  std::vector<std::uint8_t> is_in_lake_;                        // [n]
  std::vector<std::pair<std::uint64_t, std::uint32_t>> place_;  // cell, vertex
  std::vector<CountedCell> cells_;
  std::vector<std::uint32_t> lake_;
};

}  // namespace

std::uint64_t CutGrid::cell_of(LatticePoint p) const {
  // The lattice is no wider than 32 bits can tell.
  const auto column = static_cast<std::uint32_t>((std::int64_t{p.x} - origin.x) >> shift);
  const auto row = static_cast<std::uint32_t>((std::int64_t{p.y} - origin.y) >> shift);
  return spread(row) << 1 | spread(column);
}

CutGrid cut_grid(const LatticeBox& bounds, std::uint64_t num_vertices) {
  constexpr double kVertices = 256;
  const double area =
      (static_cast<double>(bounds.max.x) - bounds.min.x + 1) * (static_cast<double>(bounds.max.y) - bounds.min.y + 1);
  const double wanted = area / static_cast<double>(std::max<std::uint64_t>(num_vertices, 1)) * kVertices;
  CutGrid grid{bounds.min, 0};
  for (double side2 = 4; grid.shift < 31 && side2 <= wanted; side2 *= 4) ++grid.shift;
  return grid;
}

std::vector<std::uint32_t> squares_of(std::span<const CountedCell> cells, std::uint64_t most) {
  std::vector<std::uint32_t> number(cells.size());
  std::vector<std::uint64_t> members{0};  // of the cells before
  for (const CountedCell& cell : cells) members.push_back(members.back() + cell.members);
  std::uint32_t next = 0;
  struct Run {
    std::size_t first, last;
    int bit;  // cells differ below it
  };
  std::vector<Run> open;
  if (!cells.empty()) open.push_back({0, cells.size(), 64});
  while (!open.empty()) {
    const auto [first, last, bit] = open.back();
    open.pop_back();
    if (members[last] - members[first] <= most || last - first == 1) {
      std::fill(number.begin() + static_cast<std::ptrdiff_t>(first), number.begin() + static_cast<std::ptrdiff_t>(last),
                next++);
      continue;
    }
    assert(bit > 0 && "distinct cells differ in some bit");
    const std::uint64_t half = std::uint64_t{1} << (bit - 1);
    const auto middle =
        static_cast<std::size_t>(std::partition_point(cells.begin() + static_cast<std::ptrdiff_t>(first),
                                                      cells.begin() + static_cast<std::ptrdiff_t>(last),
                                                      [&](const CountedCell& c) { return (c.cell & half) == 0; }) -
                                 cells.begin());
    if (middle < last) open.push_back({middle, last, bit - 1});
    if (first < middle) open.push_back({first, middle, bit - 1});
  }
  return number;
}

void hold_borders(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
                  std::span<const std::uint32_t> square, std::span<std::uint8_t> is_member) {
  const auto is_raised = [&](std::uint32_t v) { return level[v] != terrain.height[v]; };
  for (std::uint32_t v = 0; v < is_member.size(); ++v) {
    if (!is_member[v] || square[v] == kNoVertexNumber || is_raised(v)) continue;
    for (const std::uint32_t w : terrain.graph->neighbors(v)) {
      if (square[w] == kNoVertexNumber || square[w] == square[v]) continue;
      if (is_raised(w) || square[w] < square[v]) is_member[v] = 0;
    }
  }
}

void collect_lake(const ChangeableTerrain& terrain, std::span<const std::int32_t> level, std::uint32_t seed,
                  std::span<std::uint8_t> is_seen, std::vector<std::uint32_t>& lake) {
  lake.assign(1, seed);
  is_seen[seed] = 1;
  for (std::size_t next = 0; next < lake.size(); ++next)
    for (const std::uint32_t w : terrain.graph->neighbors(lake[next])) {
      if (is_seen[w] || level[w] == terrain.height[w] || level[w] == kNoLevel) continue;
      is_seen[w] = 1;
      lake.push_back(w);
    }
}

std::uint64_t cut_large_groups(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
                               const CutGrid& grid, std::uint64_t most, std::span<std::uint8_t> is_member) {
  const auto num_members = static_cast<std::uint64_t>(
      std::count_if(is_member.begin(), is_member.end(), [](std::uint8_t f) { return f != 0; }));
  if (num_members <= most) return 0;
  std::uint64_t num_cut = 0;
  std::vector<std::uint8_t> is_seen(is_member.size(), 0);
  std::vector<std::uint32_t> group;
  std::optional<GroupCutter> cutter;  // once there is something to cut
  for (std::uint32_t seed = 0; seed < is_member.size(); ++seed) {
    if (!is_member[seed] || is_seen[seed]) continue;
    group.assign(1, seed);
    is_seen[seed] = 1;
    for (std::size_t next = 0; next < group.size(); ++next)
      for (const std::uint32_t w : terrain.graph->neighbors(group[next])) {
        if (!is_member[w] || is_seen[w]) continue;
        is_seen[w] = 1;
        group.push_back(w);
      }
    if (group.size() <= most) continue;
    ++num_cut;
    if (!cutter) cutter.emplace(terrain, level, grid);
    cutter->add(group, most);
  }
  if (cutter) hold_borders(terrain, level, cutter->square(), is_member);
  return num_cut;
}

}  // namespace hydrotin
