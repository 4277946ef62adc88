#include "hydrotin/simple_polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "clouds.h"
#include "hydrotin/error.h"
#include "oracle/measures.h"

// Simple polygons: against Klincsek's recursion over all pairs of vertices, and against the enumeration of all
// triangulations where points and edges lie inside.

namespace hydrotin {
namespace {

using oracle::Terrain;
using oracle::Triangle;
using oracle::Triangles;

// Vertices sorted by angle around their mean: star-shaped, so simple unless two lie on one ray.
std::vector<LatticePoint> star(std::uint64_t seed, std::size_t n, std::int32_t extent) {
  auto points = testing::distinct(testing::random_points(seed, n, extent));
  double x = 0, y = 0;
  for (const LatticePoint p : points) {
    x += p.x;
    y += p.y;
  }
  x /= static_cast<double>(points.size());
  y /= static_cast<double>(points.size());
  std::sort(points.begin(), points.end(), [&](LatticePoint a, LatticePoint b) {
    return std::atan2(a.y - y, a.x - x) < std::atan2(b.y - y, b.x - x);
  });
  return points;
}

bool is_simple(const std::vector<LatticePoint>& p) {
  const std::size_t n = p.size();
  if (n < 3) return false;
  bool flat = true;
  for (std::size_t i = 0; i < n; ++i) {
    flat = flat && oracle::side(p[0], p[1], p[i]) == 0;
    for (std::size_t j = 0; j < n; ++j) {
      const LatticePoint a = p[i], b = p[(i + 1) % n], c = p[j], d = p[(j + 1) % n];
      if (oracle::cross(a, b, c, d) || oracle::on_segment(a, b, c)) return false;
    }
  }
  return !flat;
}

double signed_area(const std::vector<LatticePoint>& p) {
  double area = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const LatticePoint a = p[i], b = p[(i + 1) % p.size()];
    area += static_cast<double>(a.x) * b.y - static_cast<double>(a.y) * b.x;
  }
  return area;
}

// Klincsek 1980 over a counter-clockwise polygon: L[i][j] of the part between vertices i and j, by growing length.
class Klincsek {
 public:
  using Measure = std::function<double(const Triangle&)>;
  using Combine = std::function<double(double, double)>;

  Klincsek(const std::vector<LatticePoint>& p, int k) : p_(p) {
    for (const auto& [t, order] : oracle::empty_triangles(p))
      if (order <= k && is_inside(t)) usable_.insert({t, order});
  }

  double solve(const Measure& measure, const Combine& combine, double neutral) const {
    const int n = static_cast<int>(p_.size());
    const double none = std::numeric_limits<double>::infinity();
    std::vector<std::vector<double>> best(p_.size(), std::vector<double>(p_.size(), none));
    for (int i = 0; i + 1 < n; ++i) at(best, i, i + 1) = neutral;
    for (int length = 2; length < n; ++length)
      for (int i = 0; i + length < n; ++i)
        for (int q = i + 1; q < i + length; ++q) {
          const Triangle t{i, q, i + length};
          if (!usable_.contains(t) || at(best, i, q) == none || at(best, q, i + length) == none) continue;
          double& entry = at(best, i, i + length);
          entry = std::min(entry, combine(measure(t), combine(at(best, i, q), at(best, q, i + length))));
        }
    return at(best, 0, n - 1);
  }
  [[nodiscard]] int order_of(const Triangle& t) const { return usable_.at(t); }

 private:
  static double& at(std::vector<std::vector<double>>& m, int i, int j) {
    return m[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  }
  [[nodiscard]] LatticePoint at(int i) const { return p_[static_cast<std::size_t>(i)]; }

  // Cut by no side, and counter-clockwise in the order of the vertices, and inside at its middle.
  [[nodiscard]] bool is_inside(const Triangle& t) const {
    if (oracle::side(at(t[0]), at(t[1]), at(t[2])) <= 0) return false;
    const int n = static_cast<int>(p_.size());
    for (int i = 0; i < n; ++i)
      for (std::size_t s = 0; s < 3; ++s)
        if (oracle::cross(at(i), at((i + 1) % n), at(t[s]), at(t[(s + 1) % 3]))) return false;
    int winding = 0;  // of three times the centroid among three times the vertices
    const std::int64_t x = std::int64_t{at(t[0]).x} + at(t[1]).x + at(t[2]).x,
                       y = std::int64_t{at(t[0]).y} + at(t[1]).y + at(t[2]).y;
    for (int i = 0; i < n; ++i) {
      const oracle::Big ax = 3 * oracle::Big{at(i).x}, ay = 3 * oracle::Big{at(i).y},
                        bx = 3 * oracle::Big{at((i + 1) % n).x}, by = 3 * oracle::Big{at((i + 1) % n).y};
      const oracle::Big turn = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
      if (ay <= y && by > y && turn > 0) ++winding;
      if (ay > y && by <= y && turn < 0) --winding;
    }
    return winding == 1;
  }

  std::vector<LatticePoint> p_;
  std::map<Triangle, int> usable_;
};

SimplePolygonTriangulation solve(const std::vector<LatticePoint>& p, const std::vector<std::int32_t>& z,
                                 std::uint32_t boundary, int k, Objective objective,
                                 std::span<const std::array<std::uint32_t, 2>> edges = {}) {
  return triangulate_polygon({p, z, boundary, edges}, {.order = k, .polygon = {.objectives = {objective}}});
}

bool near(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max({1.0, std::abs(a), std::abs(b)});
}

TEST(SimplePolygon, Definition_EqualsKlincsek) {
  using namespace oracle::detail;
  const auto add = [](double a, double b) { return a + b; };
  const auto most = [](double a, double b) { return std::max(a, b); };
  int solved = 0, impossible = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    const std::size_t n = seed < 149 ? 3 + seed % 17 : 60;
    auto p = star(seed, n, seed % 3 == 0 ? 12 : seed % 3 == 1 ? 1 << 12 : 1 << 28);
    if (!is_simple(p)) continue;
    if (signed_area(p) < 0) std::reverse(p.begin(), p.end());
    Terrain terrain{p, testing::random_heights(seed, p.size(), 1000), {}, {}};
    for (const int k : {0, 1, 2, 4, 60}) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << " n " << p.size() << " k " << k);
      const Klincsek klincsek(p, k);
      const auto corners = [&](const Triangle& t) {
        return std::array{corner(terrain, t[0]), corner(terrain, t[1]), corner(terrain, t[2])};
      };
      // Twice the inner edges and the sides once.
      const double perimeters = klincsek.solve(
          [&](const Triangle& t) {
            const auto [a, b, c] = corners(t);
            return static_cast<double>(distance(a, b) + distance(b, c) + distance(c, a));
          },
          add, 0);
      auto given = p;
      auto heights = terrain.z;
      if (seed % 2) {  // the direction of the boundary is free
        std::reverse(given.begin(), given.end());
        std::reverse(heights.begin(), heights.end());
      }
      const auto m = static_cast<std::uint32_t>(p.size());
      const auto by_weight = solve(given, heights, m, k, Objective::min_weight);
      EXPECT_EQ(by_weight.found, std::isfinite(perimeters));
      if (!by_weight.found) {
        ++impossible;
        const auto least = by_weight.smallest_order;
        EXPECT_GT(static_cast<int>(least), k);
        const auto exists = [&](int order) {
          return std::isfinite(Klincsek(p, order).solve([](const Triangle&) { return 0.0; }, add, 0));
        };
        EXPECT_TRUE(exists(static_cast<int>(least)));
        EXPECT_FALSE(exists(static_cast<int>(least) - 1));
        continue;
      }
      ++solved;
      double ring = 0;
      for (std::size_t i = 0; i < p.size(); ++i)
        ring += std::hypot(static_cast<double>(p[i].x) - p[(i + 1) % p.size()].x,
                           static_cast<double>(p[i].y) - p[(i + 1) % p.size()].y);
      EXPECT_TRUE(near(by_weight.best.value(), (perimeters + ring) / 2));
      EXPECT_TRUE(by_weight.best.optimal);
      const double angle_score = klincsek.solve(
          [&](const Triangle& t) {
            const auto [a, b, c] = corners(t);
            return -static_cast<double>(std::min({angle(a, b, c), angle(b, c, a), angle(c, a, b)}));
          },
          most, -1000);
      const auto by_angle = solve(given, heights, m, k, Objective::max_min_angle);
      EXPECT_NEAR(by_angle.best.value(), -angle_score, 1e-6);
      const double order = klincsek.solve([&](const Triangle& t) { return klincsek.order_of(t); }, most, 0);
      EXPECT_EQ(solve(given, heights, m, k, Objective::min_max_order).best.value(), order);
    }
  }
  std::printf("%d polygons solved, %d without a triangulation of the order\n", solved, impossible);
  EXPECT_GE(solved, 300);
  EXPECT_GE(impossible, 60);
}

struct Filled {
  Terrain terrain;
  std::uint32_t boundary = 0;
  std::vector<std::array<std::uint32_t, 2>> edges;
};

// A polygon with some points inside, some of them joined.
std::optional<Filled> filled(std::uint64_t seed) {
  Filled out;
  const std::int32_t extent = seed % 2 ? 14 : 1 << 12;
  auto ring = star(seed, 4 + seed % 4, extent);
  if (!is_simple(ring)) return std::nullopt;
  if (signed_area(ring) < 0) std::reverse(ring.begin(), ring.end());
  out.boundary = static_cast<std::uint32_t>(ring.size());
  out.terrain.p = ring;
  for (const LatticePoint p : testing::random_points(seed + 5000, 12, extent)) {
    if (out.terrain.p.size() >= ring.size() + 1 + seed % 3) break;
    if (std::find(out.terrain.p.begin(), out.terrain.p.end(), p) != out.terrain.p.end()) continue;
    bool inside = false, on = false;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const LatticePoint a = ring[i], b = ring[(i + 1) % ring.size()];
      on = on || oracle::on_segment(a, b, p);
      if ((a.y > p.y) != (b.y > p.y) && (oracle::side(a, b, p) > 0) == (b.y > a.y)) inside = !inside;
    }
    if (inside && !on) out.terrain.p.push_back(p);
  }
  const auto n = static_cast<std::uint32_t>(out.terrain.p.size());
  if (seed % 4 >= 2 && n >= out.boundary + 2) out.edges.push_back({out.boundary, out.boundary + 1});
  for (const auto& e : out.edges)
    for (std::size_t i = 0; i < n; ++i) {
      const LatticePoint a = out.terrain.p[e[0]], b = out.terrain.p[e[1]];
      const LatticePoint c = out.terrain.p[i], d = i < ring.size() ? ring[(i + 1) % ring.size()] : c;
      if (oracle::on_segment(a, b, c) || oracle::cross(a, b, c, d)) return std::nullopt;
    }
  out.terrain.z = testing::random_heights(seed, n, 1000);
  out.terrain.order = oracle::empty_triangles(out.terrain.p);
  return out;
}

TEST(SimplePolygon, Definition_PointsAndEdgesInside) {
  int instances = 0;
  std::map<std::string, int> above;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const auto polygon = filled(seed);
    if (!polygon) continue;
    std::vector<std::pair<int, int>> sides;
    for (std::uint32_t i = 0; i < polygon->boundary; ++i)
      sides.emplace_back(static_cast<int>(i), static_cast<int>((i + 1) % polygon->boundary));
    for (const auto& e : polygon->edges) {
      sides.emplace_back(static_cast<int>(e[0]), static_cast<int>(e[1]));
      sides.emplace_back(static_cast<int>(e[1]), static_cast<int>(e[0]));
    }
    for (const int k : {1, 3, 9}) {
      const oracle::AllTriangulations all(polygon->terrain.p, k, sides);
      for (const std::string_view key_of_it : kObjectiveNames) {
        const std::string key(key_of_it);
        const Objective objective = *objective_named(key);
        if (needs_reference(objective)) continue;
        SCOPED_TRACE(::testing::Message() << key << " seed " << seed << " k " << k << " n " << polygon->terrain.p.size()
                                          << " m " << polygon->boundary << " edges " << polygon->edges.size());
        const auto result =
            solve(polygon->terrain.p, polygon->terrain.z, polygon->boundary, k, objective, polygon->edges);
        ASSERT_EQ(result.found, !all.all().empty());
        if (!result.found) continue;
        ++instances;
        Triangles triangles;
        for (const auto& t : result.best.triangles)
          triangles.insert(oracle::triangle(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])));
        ASSERT_NE(std::find(all.all().begin(), all.all().end(), triangles), all.all().end());
        const double sign = is_maximised(objective) ? -1 : 1;
        double least = std::numeric_limits<double>::infinity();
        for (const Triangles& t : all.all())
          least = std::min(least, sign * oracle::measures(polygon->terrain, t, 1).at(key));
        if (objective == Objective::delaunay) continue;
        const double value = sign * result.best.value();
        EXPECT_NEAR(value, sign * oracle::measures(polygon->terrain, triangles, 1).at(key),
                    1e-6 * std::abs(value) + 1e-9);
        EXPECT_LE(sign * result.best.bound, least + 1e-6 * std::abs(least) + 1e-9) << "a false bound";
        const bool best = value <= least + 1e-6 * std::abs(least) + 1e-9;
        above[key] += !best;
        if (result.best.optimal || kind_of(objective) == ObjectiveKind::sum ||
            kind_of(objective) == ObjectiveKind::bottleneck) {
          EXPECT_TRUE(best) << value << " but " << least << " is possible";
        }
      }
    }
  }
  std::printf("%d instances\n", instances);
  for (const auto& [key, count] : above) std::printf("%-26s above the best: %d\n", key.c_str(), count);
  EXPECT_GE(instances, 1000);
}

// Without components every objective of T3.2 is exact.
TEST(SimplePolygon, NonDecomposableObjectivesAreOptimalWithoutComponents) {
  int instances = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    const auto p = star(seed, 4 + seed % 5, seed % 2 ? 12 : 1 << 12);
    if (!is_simple(p)) continue;
    Terrain terrain{p, testing::random_heights(seed, p.size(), seed % 3 ? 1000 : 4), {}, oracle::empty_triangles(p)};
    std::vector<std::pair<int, int>> sides;
    const int m = static_cast<int>(p.size());
    const bool ccw = signed_area(p) > 0;
    for (int i = 0; i < m; ++i) sides.emplace_back(ccw ? i : (i + 1) % m, ccw ? (i + 1) % m : i);
    for (const int k : {2, 9}) {
      const oracle::AllTriangulations all(p, k, sides);
      if (all.all().empty()) continue;
      for (const Objective objective :
           {Objective::min_max_degree, Objective::local_minima, Objective::min_max_area_ratio,
            Objective::min_max_normal_angle, Objective::max_convex_edges}) {
        const std::string key(name(objective));
        SCOPED_TRACE(::testing::Message() << key << " seed " << seed << " k " << k << " m " << m);
        const auto result = solve(p, terrain.z, static_cast<std::uint32_t>(m), k, objective);
        const double sign = is_maximised(objective) ? -1 : 1;
        double least = std::numeric_limits<double>::infinity();
        for (const Triangles& t : all.all()) least = std::min(least, sign * oracle::measures(terrain, t, 1).at(key));
        EXPECT_NEAR(sign * result.best.value(), least, 1e-6 * (1 + std::abs(least)));
        EXPECT_TRUE(result.best.optimal);
        ++instances;
      }
    }
  }
  EXPECT_GE(instances, 300);
}

TEST(SimplePolygon, GivenDiagonalsAreCompletedWithTheLowestOrder) {
  int instances = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    auto p = star(seed, 6 + seed % 3, 1 << 10);
    if (!is_simple(p)) continue;
    if (signed_area(p) < 0) std::reverse(p.begin(), p.end());
    Terrain terrain{p, std::vector<std::int32_t>(p.size(), 0), {}, oracle::empty_triangles(p)};
    const int m = static_cast<int>(p.size());
    const std::array<std::uint32_t, 2> diagonal{0, static_cast<std::uint32_t>(2 + seed % 3)};
    std::vector<std::pair<int, int>> sides;
    for (int i = 0; i < m; ++i) sides.emplace_back(i, (i + 1) % m);
    sides.emplace_back(static_cast<int>(diagonal[0]), static_cast<int>(diagonal[1]));
    sides.emplace_back(static_cast<int>(diagonal[1]), static_cast<int>(diagonal[0]));
    const std::vector<std::array<std::uint32_t, 2>> edges{diagonal};
    SCOPED_TRACE(::testing::Message() << "seed " << seed << " m " << m);
    try {
      const auto result = solve(p, terrain.z, static_cast<std::uint32_t>(m), m, Objective::min_max_order, edges);
      const oracle::AllTriangulations all(p, m, sides);
      ASSERT_TRUE(result.found);
      double least = 1e9;
      for (const Triangles& t : all.all()) least = std::min(least, oracle::measures(terrain, t, 1).at("min-max-order"));
      EXPECT_EQ(result.best.value(), least);
      ++instances;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
    }
  }
  EXPECT_GE(instances, 50);
}

TEST(SimplePolygon, UnsoundPolygonsAreRefused) {
  const std::vector<std::int32_t> z(6, 0);
  const auto refuses = [&](std::vector<LatticePoint> p, std::uint32_t boundary,
                           std::vector<std::array<std::uint32_t, 2>> edges, const std::string& what) {
    try {
      solve(p, std::vector<std::int32_t>(p.size(), 0), boundary, 2, Objective::min_weight, edges);
      ADD_FAILURE() << "not refused: " << what;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
  };
  refuses({{0, 0}, {1, 1}}, 2, {}, "three vertices");
  refuses({{0, 0}, {1, 1}, {2, 2}}, 3, {}, "touch");
  refuses({{0, 0}, {4, 4}, {4, 0}, {0, 4}}, 4, {}, "cross or touch");
  refuses({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}, 5, {}, "cross or touch");
  refuses({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {9, 9}}, 4, {}, "outside");
  refuses({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 0}}, 4, {}, "lies on the side");
  refuses({{0, 0}, {4, 0}, {4, 4}, {0, 4}}, 4, {{0, 1}}, "given twice");
  refuses({{0, 0}, {4, 0}, {4, 4}, {0, 4}}, 4, {{0, 2}, {1, 3}}, "cross or touch");
  refuses({{0, 0}, {4, 0}, {4, 4}, {0, 4}}, 4, {{0, 7}}, "does not join");
  refuses({{0, 0}, {8, 0}, {2, 2}, {0, 8}}, 4, {{1, 3}}, "runs outside");
}

}  // namespace
}  // namespace hydrotin
