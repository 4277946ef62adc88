#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "clouds.h"
#include "hydrotin/evaluate.h"
#include "hydrotin/hull_heuristic.h"
#include "hydrotin/point_set.h"
#include "oracle/measures.h"

// Every objective over point sets, against the enumeration of all order-k triangulations.

namespace hydrotin {
namespace {

using oracle::Terrain;
using oracle::Triangles;

constexpr double kZPerXy = 0.5;

Triangles as_set(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  Triangles out;
  for (const auto& t : triangles)
    out.insert(oracle::triangle(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])));
  EXPECT_EQ(out.size(), triangles.size());
  return out;
}

bool near(double a, double b) {
  return std::abs(a - b) <= 1e-7 * std::max({1.0, std::abs(a), std::abs(b)});
}

// Small sets of every degenerate kind, with heights and reference points, some of them on edges, corners and outside.
std::vector<Terrain> small_terrains(std::uint64_t seed, std::size_t n) {
  std::vector<Terrain> out;
  const std::int32_t extents[] = {1 << 16, 6, 40, 1 << 27};
  for (int kind = 0; kind < 4; ++kind) {
    Terrain terrain;
    terrain.p = testing::distinct(kind == 2 ? testing::lattice_points(seed, n, 10)
                                            : testing::random_points(seed, n, extents[kind]));
    testing::shuffle(seed, terrain.p);
    terrain.z = testing::random_heights(seed + 1, terrain.p.size(), seed % 2 ? 4 : 1000);
    const auto places = testing::random_points(seed + 2, 12, extents[kind]);
    const auto heights = testing::random_heights(seed + 3, places.size(), 1000);
    for (std::size_t i = 0; i < places.size(); ++i) terrain.reference.push_back({places[i], heights[i]});
    terrain.order = oracle::empty_triangles(terrain.p);
    out.push_back(std::move(terrain));
  }
  return out;
}

PointSetTriangulation solve(const Terrain& terrain, int k, PolygonOptions polygon) {
  polygon.z_per_xy = kZPerXy;
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  for (const auto& r : terrain.reference) {
    position.push_back(r.position);
    height.push_back(r.height);
  }
  return triangulate(terrain.p, terrain.z, PointSetOptions{.order = k, .polygon = std::move(polygon)},
                     {position, height});
}

struct Best {
  std::map<std::string, double> value;
  void take(const std::map<std::string, double>& measured) {
    for (const auto& [key, v] : measured) {
      const auto objective = objective_named(key);
      const auto [found, fresh] = value.try_emplace(key, v);
      if (!fresh) found->second = is_maximised(*objective) ? std::max(found->second, v) : std::min(found->second, v);
    }
  }
};

bool is_exact(Objective objective) {
  const ObjectiveKind kind = kind_of(objective);
  return kind == ObjectiveKind::sum || kind == ObjectiveKind::bottleneck || kind == ObjectiveKind::none;
}

TEST(Objectives, Definition_EveryObjectiveOverAllOrderKTriangulations) {
  std::map<std::string, std::pair<int, int>> missed;  // instances, above the best
  for (std::uint64_t seed = 0; seed < 25; ++seed)
    for (const Terrain& terrain : small_terrains(seed, 5 + seed % 5))
      for (int k = 0; k <= 5; ++k) {
        const oracle::AllTriangulations all(terrain.p, k);
        if (all.all().empty()) continue;
        Best best;
        for (const Triangles& t : all.all()) best.take(oracle::measures(terrain, t, kZPerXy));
        for (const std::string_view name_of_it : kObjectiveNames) {
          const std::string key(name_of_it);
          const Objective objective = *objective_named(key);
          SCOPED_TRACE(::testing::Message() << key << " seed " << seed << " n " << terrain.p.size() << " k " << k);
          const auto result = solve(terrain, k, {.objectives = {objective}});
          const Triangles triangles = as_set(result.triangles);
          ASSERT_NE(std::find(all.all().begin(), all.all().end(), triangles), all.all().end());
          ASSERT_EQ(result.values.size(), 1U);
          EXPECT_TRUE(near(result.value(), oracle::measures(terrain, triangles, kZPerXy).at(key)))
              << result.value() << " is not " << oracle::measures(terrain, triangles, kZPerXy).at(key);
          const double least = best.value.at(key);
          if (objective == Objective::delaunay) continue;
          const double sign = is_maximised(objective) ? -1 : 1;
          EXPECT_LE(sign * result.bound, sign * least + 1e-7 * std::max(1.0, std::abs(least))) << "a false bound";
          if (is_exact(objective)) {
            EXPECT_TRUE(near(result.value(), least)) << result.value() << " but " << least << " is possible";
            EXPECT_TRUE(result.optimal);
          } else if (result.optimal) {
            EXPECT_TRUE(near(result.value(), least)) << "not optimal";
          }
          auto& [instances, above] = missed[key];
          ++instances;
          above += !near(result.value(), least);
        }
      }
  for (const auto& [key, counts] : missed)
    std::printf("%-26s above the best in %d of %d instances\n", key.c_str(), counts.second, counts.first);
  for (const auto& [key, counts] : missed) EXPECT_LE(counts.second * 10, counts.first) << key;
}

TEST(Objectives, ListsAreLexicographic) {
  const std::vector<Objectives> lists{
      {Objective::min_squared_error, Objective::min_weight},
      {Objective::local_minima, Objective::min_squared_error},
      {Objective::local_minima, Objective::max_sum_inradius, Objective::min_weight},
      {Objective::min_weight, Objective::max_min_angle},
      {Objective::local_minima, Objective::min_max_edge, Objective::min_absolute_error},
      {Objective::min_max_order, Objective::local_minima},
  };
  int followed = 0, instances = 0;
  for (std::uint64_t seed = 100; seed < 125; ++seed)
    for (const Terrain& terrain : small_terrains(seed, 5 + seed % 5))
      for (const int k : {1, 3, 5}) {
        const oracle::AllTriangulations all(terrain.p, k);
        if (all.all().empty()) continue;
        for (const Objectives& list : lists) {
          SCOPED_TRACE(::testing::Message()
                       << name(list) << " seed " << seed << " n " << terrain.p.size() << " k " << k);
          const auto result = solve(terrain, k, {.objectives = list});
          ASSERT_EQ(result.values.size(), list.size());
          std::vector<double> least;
          for (const Triangles& t : all.all()) {
            const auto measured = oracle::measures(terrain, t, kZPerXy);
            std::vector<double> values;
            for (const Objective o : list)
              values.push_back((is_maximised(o) ? -1 : 1) * measured.at(std::string(name(o))));
            // Nearly equal values count as equal.
            bool smaller = least.empty();
            for (std::size_t i = 0; i < values.size() && !smaller; ++i) {
              if (near(values[i], least[i])) continue;
              smaller = values[i] < least[i];
              break;
            }
            if (smaller) least = values;
          }
          ++instances;
          bool equal = true;
          for (std::size_t i = 0; i < list.size(); ++i)
            equal = equal && near(result.values[i] * (is_maximised(list[i]) ? -1 : 1), least[i]);
          followed += equal;
          // Sums are lexicographic over the whole set; a bottleneck that is not the first is so polygon by polygon.
          const bool sums_only =
              std::all_of(list.begin(), list.end(), [](Objective o) { return kind_of(o) == ObjectiveKind::sum; });
          if (sums_only) {
            EXPECT_TRUE(equal);
          }
        }
      }
  std::printf("lexicographic over the whole set in %d of %d instances\n", followed, instances);
  EXPECT_GE(followed * 10, instances * 8);
}

TEST(Objectives, LimitOnErrorsIsKeptExactlyWherePossible) {
  int kept = 0, impossible = 0;
  for (std::uint64_t seed = 200; seed < 260; ++seed)
    for (Terrain terrain : small_terrains(seed, 5 + seed % 5))
      for (const int k : {1, 2, 4}) {
        terrain.reference.resize(2);
        const oracle::AllTriangulations all(terrain.p, k);
        if (all.all().empty()) continue;
        std::vector<double> errors;
        for (const Triangles& t : all.all())
          errors.push_back(oracle::measures(terrain, t, kZPerXy).at("min-max-error"));
        std::sort(errors.begin(), errors.end());
        const double least = errors.front(), limit = std::ceil(errors[errors.size() / 2]) + (seed % 3 ? 1 : -200);
        if (limit < 0 || std::abs(limit - least) < 1e-3) continue;
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " n " << terrain.p.size() << " k " << k);
        const auto result = solve(terrain, k,
                                  {.objectives = {Objective::local_minima, Objective::min_weight},
                                   .max_error = ErrorLimit{static_cast<std::int64_t>(limit) * 1'000'000}});
        const double worst = oracle::measures(terrain, as_set(result.triangles), kZPerXy).at("min-max-error");
        const bool missed = result.limit_missed > 0 || result.vertices_beyond_limit > 0;
        EXPECT_EQ(missed, least > limit);
        EXPECT_EQ(worst > limit + 1e-6, missed);
        (missed ? impossible : kept) += 1;
        if (missed) continue;
        double fewest = 1e9;
        for (const Triangles& t : all.all()) {
          const auto measured = oracle::measures(terrain, t, kZPerXy);
          if (measured.at("min-max-error") <= limit + 1e-6) fewest = std::min(fewest, measured.at("local-minima"));
        }
        EXPECT_GE(result.value(), fewest);
        EXPECT_LE(result.bound, fewest);
        if (result.optimal) {
          EXPECT_EQ(result.value(), fewest);
        }
      }
  std::printf("limit kept in %d, impossible in %d instances\n", kept, impossible);
  EXPECT_GE(kept, 100);
  EXPECT_GE(impossible, 20);
}

// T3.3's ties and the linear program are two ways to the same optimum.
TEST(Objectives, TiesAndLinearProgramAgree) {
  int compared = 0, with_many = 0;
  for (std::uint64_t seed = 300; seed < 700 && (compared < 150 || with_many < 40); ++seed) {
    Terrain terrain;
    terrain.p = testing::distinct(testing::random_points(seed, 10 + seed % 30, 1 << 10));
    testing::shuffle(seed, terrain.p);
    terrain.z = testing::random_heights(seed, terrain.p.size(), 1000);
    for (const int k : {4, 5, 6, 7})
      for (const Objective objective :
           {Objective::min_weight, Objective::local_minima, Objective::max_min_angle, Objective::max_sum_inradius}) {
        SCOPED_TRACE(::testing::Message() << name(objective) << " seed " << seed << " k " << k);
        const auto ties = solve(terrain, k, {.objectives = {objective}, .method = ComponentMethod::ties});
        if (ties.components == 0 || ties.max_components > 5) continue;
        ++compared;
        with_many += ties.max_components > 2;
        const auto linear = solve(terrain, k, {.objectives = {objective}, .method = ComponentMethod::linear_program});
        EXPECT_TRUE(linear.optimal || objective == Objective::local_minima);
        if (objective == Objective::local_minima) {
          EXPECT_LE(linear.value(), ties.value());
        } else {
          EXPECT_TRUE(near(ties.value(), linear.value())) << ties.value() << " and " << linear.value();
        }
        EXPECT_EQ(linear.fallbacks, 0U);
      }
  }
  EXPECT_GE(compared, 100);
  EXPECT_GE(with_many, 40);
}

TEST(Objectives, FallbackIsNeverWorseThanDelaunayAndBounded) {
  for (std::uint64_t seed = 800; seed < 820; ++seed) {
    Terrain terrain;
    terrain.p = testing::distinct(testing::random_points(seed, 200, 1 << 12));
    terrain.z = testing::random_heights(seed, terrain.p.size(), 1000);
    for (const auto& place : testing::random_points(seed + 1, 300, 1 << 12)) terrain.reference.push_back({place, 500});
    for (const std::string_view key : kObjectiveNames) {
      const Objective objective = *objective_named(key);
      if (objective == Objective::delaunay) continue;
      SCOPED_TRACE(::testing::Message() << key << " seed " << seed);
      const double sign = is_maximised(objective) ? -1 : 1;
      const auto kept = solve(terrain, 3, {.objectives = {objective}, .budget = {.max_triangles = 2}});
      const auto exact = solve(terrain, 3, {.objectives = {objective}});
      const auto plain = solve(terrain, 0, {.objectives = {objective}});
      // Flips that serve every vertex are an optimum, and no fallback.
      EXPECT_TRUE(kept.fallbacks > 0 || (objective == Objective::local_minima && kept.optimal));
      EXPECT_LE(sign * kept.value(), sign * plain.value() + 1e-7 * std::abs(plain.value()));
      EXPECT_LE(sign * kept.bound, sign * exact.value() + 1e-7 * std::abs(exact.value())) << "a false bound";
      if (is_exact(objective)) {
        EXPECT_LE(sign * exact.value(), sign * kept.value() + 1e-7 * std::abs(kept.value()));
      }
    }
  }
}

TEST(Objectives, SameForEveryOrderOfPoints) {
  for (std::uint64_t seed = 900; seed < 904; ++seed)
    for (const std::string_view key : kObjectiveNames) {
      const Objective objective = *objective_named(key);
      Terrain terrain;
      terrain.p = testing::distinct(testing::random_points(seed, 300, seed % 2 ? 30 : 1 << 20));
      const auto heights = [](const oracle::Points& p) {
        std::vector<std::int32_t> z;
        for (const auto& q : p) z.push_back(static_cast<std::int32_t>((q.x * 7LL + q.y * 13LL) % 101));
        return z;
      };
      for (const auto& place : testing::random_points(seed + 1, 200, seed % 2 ? 30 : 1 << 20))
        terrain.reference.push_back({place, 50});
      const auto coordinates = [&] {
        terrain.z = heights(terrain.p);
        std::vector<std::array<LatticePoint, 3>> out;
        for (const auto& t : solve(terrain, 4, {.objectives = {objective}}).triangles) {
          out.push_back({terrain.p[t[0]], terrain.p[t[1]], terrain.p[t[2]]});
          std::sort(out.back().begin(), out.back().end());
        }
        std::sort(out.begin(), out.end());
        return out;
      };
      const auto expected = coordinates();
      testing::shuffle(seed, terrain.p);
      EXPECT_TRUE(coordinates() == expected) << key << " seed " << seed;
    }
}

// De Kok et al.'s heuristics stay between the Delaunay triangulation and the best.
TEST(Objectives, HeuristicsKeepTheOrderAndNeverAddMinima) {
  int fewer = 0;
  for (std::uint64_t seed = 1000; seed < 1040; ++seed)
    for (const Terrain& terrain : small_terrains(seed, 9 + seed % 20))
      for (const int k : {1, 2, 4}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " n " << terrain.p.size() << " k " << k);
        const auto best = solve(terrain, k, {});
        const auto delaunay = solve(terrain, 0, {});
        const auto hull = hull_heuristic(terrain.p, terrain.z, k);
        const auto flip = solve(terrain, k, {.method = ComponentMethod::flips});
        EXPECT_EQ(hull.triangles.size(), best.triangles.size());
        EXPECT_EQ(hull.bound, best.bound);
        if (best.triangles.empty()) continue;
        for (const auto* result : {&hull, &flip}) {
          const Triangles triangles = as_set(result->triangles);
          const auto measured = oracle::measures(terrain, triangles, kZPerXy);
          EXPECT_EQ(result->value(), measured.at("local-minima"));
          EXPECT_LE(result->value(), delaunay.value());
          EXPECT_GE(result->value(), result->bound);
          EXPECT_LE(measured.at("min-max-order"), k);
          EXPECT_EQ(result->max_order, measured.at("min-max-order"));
        }
        fewer += hull.value() < delaunay.value();
      }
  EXPECT_GE(fewer, 100);
}

TEST(Objectives, ImpossibleListsAreNamed) {
  EXPECT_TRUE(objection_to({}));
  EXPECT_TRUE(objection_to({Objective::min_weight, Objective::min_weight}));
  EXPECT_TRUE(objection_to({Objective::min_weight, Objective::min_max_degree}));
  EXPECT_TRUE(objection_to({Objective::delaunay, Objective::min_weight}));
  EXPECT_FALSE(objection_to({Objective::local_minima, Objective::min_weight}));
  for (const std::string_view key : kObjectiveNames) EXPECT_FALSE(objection_to({*objective_named(key)}));
}

}  // namespace
}  // namespace hydrotin
