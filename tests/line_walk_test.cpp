#include "hydrotin/line_walk.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>

#include "hydrotin/flow_direction.h"
#include "hydrotin/line_snapping.h"
#include "line_terrains.h"

namespace hydrotin {
namespace {

using Rational = boost::multiprecision::cpp_rational;
struct Spot {
  Rational x, y;
};

Spot spot(LatticePoint p) {
  return {p.x, p.y};
}
Rational turn(const Spot& a, const Spot& b, const Spot& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Everything from the definition: each edge and vertex against each segment, each spot against each triangle.
class SlowWalk {
 public:
  struct Stop {
    Rational at;                 ///< segment + share
    std::set<std::uint32_t> on;  ///< vertices of the smallest cell that holds it
    friend bool operator==(const Stop&, const Stop&) = default;
  };

  SlowWalk(const LatticeTerrain& terrain, std::span<const LatticePoint> line) : t_(terrain), line_(line) {}

  std::vector<std::vector<Stop>> run() {
    std::map<Rational, std::set<std::uint32_t>> stops;
    for (std::size_t s = 0; s < line_.size(); ++s) offer(stops, Rational(static_cast<int>(s)));
    for (std::size_t s = 0; s + 1 < line_.size(); ++s) {
      const Spot p = spot(line_[s]), q = spot(line_[s + 1]);
      for (std::uint32_t h = 0; h < t_.triangle.size(); ++h) {
        const Spot a = spot(t_.position[t_.origin(h)]), b = spot(t_.position[t_.target(h)]);
        const Rational pa = turn(a, b, p), pb = turn(a, b, q);
        if (pa != pb) {
          const Rational share = pa / (pa - pb);
          if (share < 0 || share > 1) continue;
          const Spot c{p.x + share * (q.x - p.x), p.y + share * (q.y - p.y)};
          if ((c.x - a.x) * (c.x - b.x) + (c.y - a.y) * (c.y - b.y) <= 0)
            offer(stops, Rational(static_cast<int>(s)) + share);
        } else if (pa == 0) {
          const Rational size = (q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y);
          const Rational share = ((a.x - p.x) * (q.x - p.x) + (a.y - p.y) * (q.y - p.y)) / size;
          if (share >= 0 && share <= 1) offer(stops, Rational(static_cast<int>(s)) + share);
        }
      }
    }
    std::vector<std::vector<Stop>> pieces;
    const Stop* last = nullptr;
    std::vector<Stop> list;
    for (const auto& [at, on] : stops) list.push_back({at, on});
    for (const Stop& stop : list) {
      if (last == nullptr || cell_of((last->at + stop.at) / 2).empty()) pieces.emplace_back();
      pieces.back().push_back(stop);
      last = &stop;
    }
    std::erase_if(pieces, [](const auto& piece) { return piece.size() < 2; });
    return pieces;
  }

 private:
  [[nodiscard]] Spot spot_at(const Rational& at) const {
    auto s = static_cast<std::size_t>(static_cast<int>(numerator(at) / denominator(at)));
    s = std::min(s, line_.size() - 2);
    const Spot p = spot(line_[s]), q = spot(line_[s + 1]);
    const Rational share = at - Rational(static_cast<int>(s));
    return {p.x + share * (q.x - p.x), p.y + share * (q.y - p.y)};
  }

  [[nodiscard]] std::set<std::uint32_t> cell_of(const Rational& at) const {
    const Spot c = spot_at(at);
    for (std::size_t t = 0; t < t_.triangle.size(); t += 3) {
      std::set<std::uint32_t> on;
      bool inside = true;
      std::array<Rational, 3> sides;
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t h = static_cast<std::uint32_t>(t) + i;
        sides[i] = turn(spot(t_.position[t_.origin(h)]), spot(t_.position[t_.target(h)]), c);
        inside = inside && sides[i] >= 0;
      }
      if (!inside) continue;
      for (std::uint32_t i = 0; i < 3; ++i)  // a corner counts unless the spot is on the opposite side
        if (sides[(i + 1) % 3] != 0) on.insert(t_.triangle[t + i]);
      return on;
    }
    return {};
  }

  void offer(std::map<Rational, std::set<std::uint32_t>>& stops, const Rational& at) const {
    if (auto on = cell_of(at); !on.empty()) stops[at] = std::move(on);
  }

  const LatticeTerrain& t_;
  std::span<const LatticePoint> line_;
};

/// The walk in the oracle's words.
std::vector<std::vector<SlowWalk::Stop>> in_words(const LatticeTerrain& t, std::span<const LatticePoint> line,
                                                  const LineWalk& walk) {
  std::vector<std::vector<SlowWalk::Stop>> pieces(walk.num_pieces());
  for (std::size_t i = 0; i < walk.num_pieces(); ++i)
    for (const WalkStop& stop : walk.piece(i)) {
      SlowWalk::Stop out;
      const std::uint32_t id = stop.place.id;
      const Spot p = spot(line[stop.segment]), q = spot(line[stop.segment + 1]);
      Rational share;
      if (stop.place.kind == PlaceKind::vertex) {
        out.on = {id};
        const Spot v = spot(t.position[id]);
        share = q.x != p.x ? (v.x - p.x) / (q.x - p.x) : (v.y - p.y) / (q.y - p.y);
      } else if (stop.place.kind == PlaceKind::edge) {
        out.on = {t.origin(id), t.target(id)};
        const Spot a = spot(t.position[t.origin(id)]), b = spot(t.position[t.target(id)]);
        if (stop.point == kNoPoint) share = turn(a, b, p) / (turn(a, b, p) - turn(a, b, q));
      } else {
        for (std::uint32_t k = 0; k < 3; ++k) out.on.insert(t.triangle[3 * id + k]);
        EXPECT_NE(stop.point, kNoPoint);
      }
      out.at = stop.point != kNoPoint ? Rational(stop.point) : Rational(stop.segment) + share;
      pieces[i].push_back(out);
    }
  return pieces;
}

TEST(LineWalk, EqualsAllIntersectionsFromTheDefinition) {
  std::size_t stops = 0, pieces = 0;
  for (std::uint32_t seed = 0; seed < 240; ++seed) {
    const bool grid = seed % 3 == 0, holes = seed % 4 == 1, far = seed % 5 == 2;
    const LatticePoint origin = far ? LatticePoint{-1000000000, 1100000000} : LatticePoint{0, 0};
    const std::int32_t spread = far ? 300000000 : 80;
    const LatticeTerrain terrain = testing::lattice_terrain(seed, 5 + seed % 30, spread, grid, holes, origin);
    if (terrain.triangle.empty()) continue;
    const TerrainLocator locator(terrain);
    const RiverLines lines = without_repeats(testing::random_lines(terrain, seed, 4, spread, origin));
    for (std::size_t i = 0; i < lines.size(); ++i) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << " line " << i);
      const LineWalk walk = walk_line(locator, lines.line(i));
      const auto expected = SlowWalk(terrain, lines.line(i)).run();
      ASSERT_EQ(in_words(terrain, lines.line(i), walk), expected);
      pieces += expected.size();
      for (const auto& piece : expected) stops += piece.size();
    }
  }
  EXPECT_GT(pieces, 500u);
  EXPECT_GT(stops, 3000u);
}

TEST(LineSnapping, PathsRunAlongEdgesAndEndsAreShared) {
  std::size_t paths = 0;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    const LatticeTerrain terrain = testing::lattice_terrain(seed, 10 + seed % 40, 100, seed % 3 == 0, seed % 4 == 1);
    if (terrain.triangle.empty()) continue;
    const TerrainLocator locator(terrain);
    const RiverLines reaches = split_at_nodes(without_repeats(testing::random_lines(terrain, seed, 5, 100)));
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::uint32_t h = 0; h < terrain.triangle.size(); ++h)
      edges.insert(std::minmax({terrain.origin(h), terrain.target(h)}));
    const SnappedLines snapped = snap_lines(locator, reaches);
    for (std::size_t i = 0; i < snapped.paths.size(); ++i) {
      const auto path = snapped.paths.path(i);
      ASSERT_GE(path.size(), 2u);
      for (std::size_t k = 1; k < path.size(); ++k) ASSERT_TRUE(edges.contains(std::minmax({path[k - 1], path[k]})));
      ++paths;
    }
    // Turned round, every line snaps to the same vertices.
    const SnappedLines back = snap_lines(locator, turned(reaches, std::vector<std::uint8_t>(reaches.size(), 1)));
    ASSERT_EQ(back.paths.size(), snapped.paths.size());
    const auto sorted = [](const RiverPaths& p) {
      std::multiset<std::vector<std::uint32_t>> all;
      for (std::size_t i = 0; i < p.size(); ++i) {
        std::vector<std::uint32_t> path(p.path(i).begin(), p.path(i).end());
        std::vector<std::uint32_t> other(path.rbegin(), path.rend());
        all.insert(std::min(path, other));
      }
      return all;
    };
    EXPECT_EQ(sorted(back.paths), sorted(snapped.paths));
  }
  EXPECT_GT(paths, 500u);
}

TEST(RiverLines, ReachesAreTheLinesCutAtNodes) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    const LatticeTerrain terrain = testing::lattice_terrain(seed, 10, 100, false, false);
    const RiverLines lines = without_repeats(testing::random_lines(terrain, seed, 6, 100));
    const RiverLines reaches = split_at_nodes(lines);
    std::set<LatticePoint> nodes;
    for (std::size_t i = 0; i < lines.size(); ++i) nodes.insert({lines.line(i).front(), lines.line(i).back()});
    std::size_t r = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      std::vector<LatticePoint> whole{lines.line(i)[0]};
      while (r < reaches.size() && reaches.source[r] == lines.source[i]) {
        const auto reach = reaches.line(r++);
        EXPECT_EQ(reach.front(), whole.back());
        EXPECT_TRUE(nodes.contains(reach.front()) && nodes.contains(reach.back()));
        for (std::size_t k = 1; k + 1 < reach.size(); ++k) EXPECT_FALSE(nodes.contains(reach[k]));
        whole.insert(whole.end(), reach.begin() + 1, reach.end());
      }
      EXPECT_TRUE(std::equal(whole.begin(), whole.end(), lines.line(i).begin(), lines.line(i).end()));
    }
    EXPECT_EQ(r, reaches.size());
  }
}

TEST(FlowDirection, NetworksVoteAndDisagreeingLinesAreListed) {
  // A slope falling to the east.
  LatticeTerrain terrain = testing::lattice_terrain(4, 200, 1000, false, false);
  for (std::size_t v = 0; v < terrain.height.size(); ++v) terrain.height[v] = 1000 - terrain.position[v].x;
  const TerrainLocator locator(terrain);
  RiverLines lines;
  const auto add = [&](std::vector<LatticePoint> chain) { lines.add(chain, static_cast<std::uint32_t>(lines.size())); };
  add({{800, 500}, {500, 500}});  // drawn upstream, as its network
  add({{500, 500}, {300, 600}});
  add({{450, 525}, {500, 400}});              // starts at a point inside no line: a network of its own, right
  add({{500, 500}, {520, 450}});              // disagrees with its network
  add({{200, 100}, {700, 150}, {900, 100}});  // right
  add({{5000, 5000}, {6000, 5000}});          // outside
  const FlowVote vote = vote_on_flow(locator, lines);
  EXPECT_EQ(vote.is_turned, (std::vector<std::uint8_t>{1, 1, 0, 1, 0, 0}));
  EXPECT_EQ(vote.disagrees, (std::vector<std::uint32_t>{3}));
  EXPECT_EQ(vote.num_networks, 4u);
  EXPECT_EQ(vote.num_turned, 1u);
  EXPECT_NEAR(vote.drop[0], 300, 1e-9);
  EXPECT_NEAR(vote.drop[3], -20, 1e-9);
  const RiverLines right = turned(lines, vote.is_turned);
  EXPECT_EQ(right.line(1).front(), (LatticePoint{300, 600}));
  const FlowVote again = vote_on_flow(locator, right);
  EXPECT_EQ(again.num_turned, 0u);
}

}  // namespace
}  // namespace hydrotin
