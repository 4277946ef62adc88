#include "hydrotin/group_cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <vector>

#include "grid_terrain.h"

namespace hydrotin {
namespace {

using testing::Random;

TEST(GroupCut, SquaresAreTheLargestWithFewEnoughMembers) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const CutGrid grid{{static_cast<std::int32_t>(random.below(100)) - 50, -2'000'000'000}, 3};
    std::vector<LatticePoint> place;
    const std::uint64_t wide = std::uint64_t{1} << (4 + random.below(28));
    for (std::uint64_t i = 0; i < 1 + random.below(200); ++i)
      place.push_back({static_cast<std::int32_t>(grid.origin.x + static_cast<std::int64_t>(random.below(
                                                                     std::min(wide, std::uint64_t{2'000'000'000})))),
                       static_cast<std::int32_t>(grid.origin.y + static_cast<std::int64_t>(random.below(wide)))});
    const std::uint64_t most = 1 + random.below(20);
    std::map<std::uint64_t, std::uint64_t> members;
    for (const LatticePoint p : place) ++members[grid.cell_of(p)];
    std::vector<CountedCell> cells;
    for (const auto& [cell, n] : members) cells.push_back({cell, n});
    const std::vector<std::uint32_t> square = squares_of(cells, most);
    const auto number_of = [&](LatticePoint p) {
      return square[static_cast<std::size_t>(std::distance(members.begin(), members.find(grid.cell_of(p))))];
    };
    std::uint32_t next = 0;
    const std::function<void(const std::vector<LatticePoint>&, int, bool)> divide =
        [&](const std::vector<LatticePoint>& all, int bit, bool by_x) {
          if (all.empty()) return;
          if (all.size() <= most || bit < 0) {
            for (const LatticePoint p : all) EXPECT_EQ(number_of(p), next);
            ++next;
            return;
          }
          std::vector<LatticePoint> low, high;
          for (const LatticePoint p : all) {
            const std::int64_t cell =
                (by_x ? std::int64_t{p.x} - grid.origin.x : std::int64_t{p.y} - grid.origin.y) / 8;
            ((cell >> bit) % 2 == 0 ? low : high).push_back(p);
          }
          divide(low, by_x ? bit - 1 : bit, !by_x);
          divide(high, by_x ? bit - 1 : bit, !by_x);
        };
    divide(place, 31, false);
    EXPECT_EQ(next, square.back() + 1);
  }
}

}  // namespace
}  // namespace hydrotin
