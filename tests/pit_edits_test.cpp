#include "hydrotin/pit_edits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "pit_sample.h"

namespace hydrotin {
namespace {

using testing::cost_of;
using testing::kMethods;
using testing::make_outlet_terrain;
using testing::OutletTerrain;
using testing::Sample;
using testing::sample_of;

TEST(PitEdits, AccountForEveryMovedVertex) {
  std::size_t num_breaches = 0, num_regions = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    const OutletTerrain t = make_outlet_terrain(seed);
    const Sample s = sample_of(t.grid, t.is_outlet);
    for (const RemovalMethod method : kMethods) {
      SCOPED_TRACE(static_cast<int>(method));
      const Removal r = s.remove(method);
      const PitEdits edits = find_edits(s.view(ChangeMeasure::total), r.components, r.height, s.weight);
      std::vector<int> raised(r.height.size(), 0), lowered(r.height.size(), 0);
      std::int64_t displacement = 0;
      double volume = 0;
      for (std::size_t i = 0; i < edits.region.size(); ++i) {
        const std::set<std::uint32_t> vertices(edits.region_vertex.begin() + edits.region_begin[i],
                                               edits.region_vertex.begin() + edits.region_begin[i + 1]);
        EXPECT_EQ(vertices.size(), edits.region_begin[i + 1] - edits.region_begin[i]);
        std::int64_t own = 0;
        for (const std::uint32_t v : vertices) {
          ++raised[v];
          own += edits.region[i].level - s.height[v];
          EXPECT_EQ(r.height[v], edits.region[i].level);
          EXPECT_LE(s.height[edits.region[i].lowest], s.height[v]);
        }
        EXPECT_TRUE(vertices.contains(edits.region[i].lowest));
        EXPECT_EQ(own, edits.region[i].displacement);
        displacement += own;
        volume += edits.region[i].volume;
      }
      for (std::size_t i = 0; i < edits.breach.size(); ++i) {
        const std::vector<std::uint32_t> chain(edits.breach_vertex.begin() + edits.breach_begin[i],
                                               edits.breach_vertex.begin() + edits.breach_begin[i + 1]);
        ASSERT_GE(chain.size(), 2u);
        if (edits.breach[i].pit != kNoVertexNumber) {
          EXPECT_EQ(chain.front(), edits.breach[i].pit);
        }
        std::int32_t deepest = 0;
        std::int64_t own = 0;
        double length = 0;
        for (std::size_t j = 0; j < chain.size(); ++j) {
          const std::int32_t depth = std::max(0, s.height[chain[j]] - r.height[chain[j]]);
          if (j + 1 < chain.size()) {
            lowered[chain[j]] += depth > 0;
            own += depth;
            deepest = std::max(deepest, depth);
          }
          if (j == 0) continue;
          EXPECT_LE(r.height[chain[j]], r.height[chain[j - 1]]);
          EXPECT_TRUE(s.around[chain[j]].contains(chain[j - 1]));
          length += std::hypot(s.position[chain[j]].x - s.position[chain[j - 1]].x,
                               s.position[chain[j]].y - s.position[chain[j - 1]].y);
        }
        EXPECT_EQ(edits.breach[i].displacement, own);
        EXPECT_EQ(edits.breach[i].max_depth, deepest);
        EXPECT_NEAR(edits.breach[i].length, length, 1e-9);
        displacement += own;
        volume += edits.breach[i].volume;
      }
      for (std::size_t v = 0; v < r.height.size(); ++v) {
        EXPECT_EQ(raised[v], r.height[v] > s.height[v]);
        EXPECT_EQ(lowered[v], r.height[v] < s.height[v]);
      }
      EXPECT_EQ(displacement, r.cost);
      EXPECT_NEAR(volume, static_cast<double>(cost_of(s, r.height, ChangeMeasure::volume)) / 6, 1e-6);
      num_breaches += edits.breach.size();
      num_regions += edits.region.size();
    }
  }
  EXPECT_GT(num_breaches, 1000u);
  EXPECT_GT(num_regions, 1000u);
}

}  // namespace
}  // namespace hydrotin
