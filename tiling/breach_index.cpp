#include "breach_index.h"

#include <algorithm>
#include <numeric>

#include "store.h"

namespace hydrotin {
namespace {

// Calls back with each tile of one output and its range.
template <class Visit>
void for_each_range(const store::Reader& in, std::uint32_t unit, std::uint32_t num_tiles, Visit visit) {
  const auto tile = in.read<std::uint32_t>("member_tile");
  const auto begin = in.read<std::uint64_t>("member_tile_begin");
  const bool fits = begin.size() == tile.size() + 1 && begin.front() == 0 && begin.back() == in.size("member_point") &&
                    std::is_sorted(begin.begin(), begin.end()) && std::is_sorted(tile.begin(), tile.end()) &&
                    (tile.empty() || tile.back() <= num_tiles);  // vertices that rivers added have a tile of their own
  if (!fits)
    throw Error(ErrorKind::storage,
                in.path() + ": its lists of tiles contradict each other; delete the file and run again");
  for (std::size_t i = 0; i < tile.size(); ++i) visit(tile[i], MemberRange{begin[i], begin[i + 1] - begin[i], unit});
}

}  // namespace

void BreachIndex::build(const Layout& layout, std::uint32_t num_tiles) {
  std::vector<std::pair<std::uint32_t, MemberRange>> found;
  for (std::uint32_t unit = 0; unit < num_tiles; ++unit)
    for_each_range(store::Reader(layout.unit(Phase::breach, unit)), unit, num_tiles,
                   [&](std::uint32_t tile, const MemberRange& range) { found.emplace_back(tile, range); });
  begin_.assign(std::size_t{num_tiles} + 2, 0);
  for (const auto& [tile, range] : found) ++begin_[tile + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  range_.resize(found.size());
  std::vector<std::uint64_t> next(begin_.begin(), begin_.end() - 1);
  for (const auto& [tile, range] : found) range_[next[tile]++] = range;
}

std::span<const MemberRange> BreachIndex::ranges_of(std::uint32_t tile, const Layout& layout, std::uint32_t num_tiles) {
  std::call_once(once_, [&] { build(layout, num_tiles); });
  return std::span(range_).subspan(begin_[tile], begin_[tile + 1] - begin_[tile]);
}

}  // namespace hydrotin
