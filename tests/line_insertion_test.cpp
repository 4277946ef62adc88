#include "hydrotin/line_insertion.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>

#include "hydrotin/predicates.h"
#include "hydrotin/snap_rounding.h"
#include "line_terrains.h"

namespace hydrotin {
namespace {

using Integer = boost::multiprecision::cpp_int;

Integer turn(LatticePoint a, LatticePoint b, LatticePoint c) {
  return (Integer(b.x) - a.x) * (Integer(c.y) - a.y) - (Integer(b.y) - a.y) * (Integer(c.x) - a.x);
}
int sign(const Integer& i) {
  return i > 0 ? 1 : i < 0 ? -1 : 0;
}
bool cross(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d) {
  return sign(turn(a, b, c)) * sign(turn(a, b, d)) < 0 && sign(turn(c, d, a)) * sign(turn(c, d, b)) < 0;
}

// Squared distance from p to the segment ab, times |ab|^2.
bool is_within_one(LatticePoint p, LatticePoint a, LatticePoint b) {
  const Integer ux = Integer(b.x) - a.x, uy = Integer(b.y) - a.y, vx = Integer(p.x) - a.x, vy = Integer(p.y) - a.y;
  const Integer size = ux * ux + uy * uy, along = ux * vx + uy * vy, away = ux * vy - uy * vx;
  // Snap rounding moves by at most half the diagonal of a unit square.
  if (along < 0) return 2 * (vx * vx + vy * vy) <= 1;
  if (along > size)
    return 2 * ((Integer(p.x) - b.x) * (Integer(p.x) - b.x) + (Integer(p.y) - b.y) * (Integer(p.y) - b.y)) <= 1;
  return 2 * away * away <= size;
}

RiverLines dense_lines(std::uint32_t seed, std::int32_t spread) {
  std::mt19937 random(seed);
  RiverLines lines;
  for (std::uint32_t i = 0; i < 12; ++i) {
    std::vector<LatticePoint> chain;
    for (int k = 0; k < 4; ++k) {
      const auto pick = [&] { return static_cast<std::int32_t>(random() % static_cast<unsigned>(spread)); };
      const std::int32_t x = pick(), y = pick();
      chain.push_back({x, y});
    }
    lines.add(chain, i);
  }
  return without_repeats(lines);
}

TEST(SnapRounding, NothingCrossesAndNothingMovesFar) {
  std::uint64_t bent = 0;
  for (std::uint32_t seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    const std::int32_t spread = seed % 3 == 0 ? 12 : seed % 3 == 1 ? 60 : 2000000000;
    const RiverLines lines = dense_lines(seed, spread);
    const RoundedLines rounded = snap_round(lines, {});
    bent += rounded.num_bent;
    std::vector<std::pair<LatticePoint, LatticePoint>> segments;
    for (std::size_t i = 0; i < rounded.lines.size(); ++i) {
      const auto line = rounded.lines.line(i);
      for (std::size_t k = 1; k < line.size(); ++k) segments.emplace_back(line[k - 1], line[k]);
    }
    for (std::size_t a = 0; a < segments.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        ASSERT_FALSE(cross(segments[a].first, segments[a].second, segments[b].first, segments[b].second));
    // Each line is the old one with points put into its segments, all of them near.
    std::size_t r = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const auto old = lines.line(i);
      const auto line = rounded.lines.line(r);
      ASSERT_EQ(rounded.lines.source[r++], lines.source[i]);
      std::size_t at = 0;
      for (const LatticePoint p : line) {
        if (at + 1 < old.size() && p == old[at + 1]) ++at;
        const bool is_near = is_within_one(p, old[std::min(at, old.size() - 2)], old[std::min(at + 1, old.size() - 1)]);
        EXPECT_TRUE(is_near || p == old[at]);
      }
      EXPECT_EQ(line.front(), old.front());
      EXPECT_EQ(line.back(), old.back());
      EXPECT_EQ(at + 1, old.size());
    }
    const RoundedLines back = snap_round(turned(lines, std::vector<std::uint8_t>(lines.size(), 1)), {});
    const RiverLines again = turned(back.lines, std::vector<std::uint8_t>(back.lines.size(), 1));
    EXPECT_EQ(again.point, rounded.lines.point);
  }
  EXPECT_GT(bent, 1000u);
}

/// Strictly inside the circle of a, b, c (counter-clockwise), without ties.
bool is_in_circle(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d) {
  const auto row = [&](LatticePoint p) {
    const Integer x = Integer(p.x) - d.x, y = Integer(p.y) - d.y;
    return std::array<Integer, 3>{x, y, x * x + y * y};
  };
  const auto p = row(a), q = row(b), r = row(c);
  return p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0]) + p[2] * (q[0] * r[1] - q[1] * r[0]) >
         0;
}

/// The definition: no circle holds a vertex that its triangle's middle sees past the constraints and the rim.
void expect_constrained_delaunay(const LatticeTerrain& t,
                                 const std::set<std::pair<std::uint32_t, std::uint32_t>>& constraints) {
  std::vector<std::pair<LatticePoint, LatticePoint>> walls;
  const auto thrice = [](LatticePoint p) { return LatticePoint{3 * p.x, 3 * p.y}; };
  for (std::uint32_t h = 0; h < t.triangle.size(); ++h)
    if (t.twin[h] == kNoHalfedge || constraints.contains(std::minmax({t.origin(h), t.target(h)})))
      walls.emplace_back(thrice(t.position[t.origin(h)]), thrice(t.position[t.target(h)]));
  for (std::size_t i = 0; i < t.triangle.size(); i += 3) {
    const LatticePoint a = t.position[t.triangle[i]], b = t.position[t.triangle[i + 1]],
                       c = t.position[t.triangle[i + 2]];
    const LatticePoint middle{a.x + b.x + c.x, a.y + b.y + c.y};
    for (const LatticePoint d : t.position) {
      if (d == a || d == b || d == c || !is_in_circle(a, b, c, d)) continue;
      bool is_seen = true;
      for (const auto& [p, q] : walls) is_seen = is_seen && !cross(middle, thrice(d), p, q);
      // A way that runs through the end of a wall is left to the local test below.
      for (const LatticePoint v : t.position)
        if (v != d && turn(middle, thrice(d), thrice(v)) == 0) is_seen = false;
      EXPECT_FALSE(is_seen);
    }
  }
  for (std::uint32_t h = 0; h < t.triangle.size(); ++h) {
    if (t.twin[h] == kNoHalfedge || constraints.contains(std::minmax({t.origin(h), t.target(h)}))) continue;
    EXPECT_FALSE(in_circle(t.position[t.origin(h)], t.position[t.target(h)], t.position[t.apex(h)],
                           t.position[t.apex(t.twin[h])]));
  }
}

void expect_sound(const LatticeTerrain& t) {
  EXPECT_EQ(find_bad_triangle(t.position, t.triangle), t.triangle.size() / 3);
  LatticeTerrain again = t;
  link_twins(again);
  EXPECT_EQ(again.twin, t.twin);
}

Integer area(const LatticeTerrain& t) {
  Integer sum = 0;
  for (std::size_t i = 0; i < t.triangle.size(); i += 3)
    sum += turn(t.position[t.triangle[i]], t.position[t.triangle[i + 1]], t.position[t.triangle[i + 2]]);
  return sum;
}

TEST(LineInsertion, IsTheConstrainedDelaunayTriangulation) {
  std::uint64_t crossings = 0, rim = 0, segments = 0;
  for (std::uint32_t seed = 0; seed < 160; ++seed) {
    SCOPED_TRACE(seed);
    const bool grid = seed % 3 == 0, holes = seed % 8 == 5;
    const std::int32_t spread = seed % 2 == 0 ? 100 : 1000000;
    const LatticeTerrain terrain = testing::lattice_terrain(seed, 8 + seed % 30, spread, grid, holes);
    if (terrain.triangle.empty()) continue;
    const TerrainLocator locator(terrain);
    const RiverLines lines = split_at_nodes(without_repeats(testing::random_lines(terrain, seed, 5, spread)));
    const InsertedLines inserted = insert_lines(locator, lines);
    const LatticeTerrain& t = inserted.terrain;
    expect_sound(t);
    crossings += inserted.counts.crossings;
    rim += inserted.counts.rim_vertices;
    EXPECT_TRUE(holes || spread == 100 || inserted.counts.lost_segments == 0);
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges, constraints;
    for (std::uint32_t h = 0; h < t.triangle.size(); ++h) edges.insert(std::minmax({t.origin(h), t.target(h)}));
    for (std::size_t i = 0; i < inserted.paths.size(); ++i) {
      const auto path = inserted.paths.path(i);
      for (std::size_t k = 1; k < path.size(); ++k) {
        constraints.insert(std::minmax({path[k - 1], path[k]}));
        ASSERT_TRUE(edges.contains(std::minmax({path[k - 1], path[k]})));
      }
    }
    segments += constraints.size();
    for (std::size_t v = 0; v < terrain.position.size(); ++v) {
      ASSERT_EQ(t.position[v], terrain.position[v]);
      ASSERT_EQ(t.height[v], terrain.height[v]);
    }
    if (!holes) expect_constrained_delaunay(t, constraints);
    // The rim gives way by less than a unit at each new vertex.
    EXPECT_LE(area(t), area(terrain));
    EXPECT_LE(area(terrain) - area(t), Integer(4) * spread * inserted.counts.rim_vertices);
    // The order and the direction of the lines do not matter.
    RiverLines other;
    for (std::size_t i = lines.size(); i-- > 0;) {
      std::vector<LatticePoint> chain(lines.line(i).rbegin(), lines.line(i).rend());
      other.add(chain, lines.source[i]);
    }
    if (!holes) {
      EXPECT_EQ(insert_lines(locator, other).terrain.triangle, t.triangle);
    }
  }
  EXPECT_GT(crossings, 300u);
  EXPECT_GT(rim, 100u);
  EXPECT_GT(segments, 2000u);
}

TEST(LineInsertion, HeightsAreThoseOfTheTerrain) {
  LatticeTerrain terrain = testing::lattice_terrain(7, 60, 1000, false, false);
  for (std::size_t v = 0; v < terrain.height.size(); ++v)
    terrain.height[v] = 5 + 0.25 * terrain.position[v].x - 0.5 * terrain.position[v].y;
  const TerrainLocator locator(terrain);
  const InsertedLines inserted = insert_lines(locator, without_repeats(testing::random_lines(terrain, 7, 8, 1000)));
  ASSERT_GT(inserted.counts.new_vertices, 10u);
  for (std::size_t v = 0; v < inserted.terrain.height.size(); ++v)
    EXPECT_NEAR(inserted.terrain.height[v],
                5 + 0.25 * inserted.terrain.position[v].x - 0.5 * inserted.terrain.position[v].y, 1e-9);
}

}  // namespace
}  // namespace hydrotin
