#include "hydrotin/polygon_batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "clouds.h"
#include "executors.h"
#include "hydrotin/point_set.h"
#include "order_k_scene.h"

namespace hydrotin {
namespace {

using Triangles = std::set<std::array<std::uint32_t, 3>>;

std::array<std::uint32_t, 3> sorted(std::array<std::uint32_t, 3> t) {
  std::sort(t.begin(), t.end());
  return t;
}

// All that comes before polygons are solved.
using Scene = testing::OrderKScene;

struct Answer {
  std::vector<std::array<VertexId, 3>> triangles;
  std::uint32_t max_order = 0;

  [[nodiscard]] Triangles ids() const {
    Triangles out;
    for (const auto& t : triangles) out.insert(sorted({t[0].value, t[1].value, t[2].value}));
    return out;
  }
};

// Solves the chosen polygons in ranges, backwards.
Answer solve(const Scene& s, Objective objective, const std::vector<std::uint8_t>& to_solve,
             const OrderKTriangles& triangles, std::uint32_t range) {
  const PolygonCandidates candidates = candidates_by_polygon(s.subdivision, triangles);
  const PolygonSource source{s.tri(),
                             s.height,
                             s.crossings,
                             s.subdivision,
                             triangles,
                             candidates,
                             objective == Objective::local_minima ? &s.assignment : nullptr};
  PolygonExtractor extractor(source);
  PolygonSolver solver({.objectives = {objective}});
  Answer out;
  out.triangles.resize(s.tri().num_triangles());
  for (std::uint32_t end = s.subdivision.size(); end > 0;) {
    const std::uint32_t begin = end > range ? end - range : 0;
    const BatchFigures figures = solve_polygons(source, to_solve, begin, end, extractor, solver, out.triangles);
    out.max_order = std::max(out.max_order, figures.max_order);
    end = begin;
  }
  return out;
}

// Those of some polygons only.
OrderKTriangles triangles_of(const Scene& s, const std::vector<std::uint8_t>& wanted) {
  const OrderKTriangleFinder finder(s.tri(), s.edges);
  const EdgesByPolygon edges = edges_by_polygon(s.subdivision, s.edges, wanted);
  OrderKTriangles out;
  for (std::uint32_t f = 0; f < wanted.size(); ++f)
    edges.for_each(f, s.subdivision, s.edges, [&](std::uint32_t e) { finder.visit(e, out); });
  return out;
}

// The same with triangles made one polygon at a time.
Answer solve_by_edges(const Scene& s, Objective objective, const std::vector<std::uint8_t>& to_solve) {
  const OrderKTriangles no_triangles;
  const PolygonCandidates no_candidates;
  const PolygonSource source{s.tri(),
                             s.height,
                             s.crossings,
                             s.subdivision,
                             no_triangles,
                             no_candidates,
                             objective == Objective::local_minima ? &s.assignment : nullptr};
  PolygonExtractor extractor(source);
  PolygonSolver solver({.objectives = {objective}});
  Answer out;
  out.triangles.resize(s.tri().num_triangles());
  out.max_order = solve_polygons(source, to_solve, s.edges, edges_by_polygon(s.subdivision, s.edges, to_solve), 0,
                                 s.subdivision.size(), extractor, solver, out.triangles)
                      .max_order;
  return out;
}

std::vector<std::vector<LatticePoint>> clouds(std::uint64_t seed) {
  std::vector<std::vector<LatticePoint>> out;
  for (const auto kind : {testing::CloudKind::uniform, testing::CloudKind::lattice, testing::CloudKind::jittered,
                          testing::CloudKind::scanlines, testing::CloudKind::clustered}) {
    auto points = testing::distinct(testing::make_cloud(kind, seed, 150, seed % 2 ? 6 : 300));
    testing::shuffle(seed, points);
    out.push_back(std::move(points));
  }
  return out;
}

TEST(PolygonBatch, LeavingPolygonsOutChangesNothing) {
  std::size_t left_out = 0, solved = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed)
    for (const auto& points : clouds(seed))
      for (const int k : {1, 2, 3, 4, 5}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " k " << k);
        const Scene s(points, k, testing::random_heights(seed, points.size(), seed % 3 ? 1000 : 4));
        const OrderKTriangles all = order_k_triangles(s.tri(), s.edges);
        for (const auto objective : {Objective::delaunay, Objective::min_weight, Objective::local_minima}) {
          const auto to_solve =
              polygons_to_solve(s.tri(), s.links, s.height, s.crossings, s.subdivision, objective, &s.assignment);
          const std::vector<std::uint8_t> every(s.subdivision.size(), 1);
          const Answer expected = solve(s, objective, every, all, s.subdivision.size());
          const OrderKTriangles wanted = triangles_of(s, to_solve);
          for (const std::uint32_t range : {1U, 7U, 1000U}) {
            const Answer found = solve(s, objective, to_solve, wanted, range);
            EXPECT_EQ(found.ids(), expected.ids());
            EXPECT_EQ(found.ids().size(), s.tri().num_triangles());
            EXPECT_EQ(found.max_order, expected.max_order);
          }
          const Answer by_edges = solve_by_edges(s, objective, to_solve);
          EXPECT_EQ(by_edges.ids(), expected.ids());
          EXPECT_EQ(by_edges.max_order, expected.max_order);
          if (objective == Objective::local_minima) {
            const auto count = static_cast<std::size_t>(std::count(to_solve.begin(), to_solve.end(), 1));
            solved += count;
            left_out += s.subdivision.size() - count;
          }
        }
      }
  EXPECT_GT(solved, 1000U);
  EXPECT_GT(left_out, 1000U);
}

// A piece of a polygon is given triangles with corners in other pieces: here one polygon is given all triangles.
TEST(PolygonBatch, TakesTrianglesWithCornersElsewhere) {
  const auto points = testing::distinct(testing::make_cloud(testing::CloudKind::uniform, 1, 400, 300));
  const Scene s(points, 3, testing::random_heights(1, points.size(), 1000));
  const OrderKTriangles all = order_k_triangles(s.tri(), s.edges);
  PolygonCandidates candidates;
  candidates.begin.assign(s.subdivision.size() + 1, all.size());
  candidates.begin[0] = 0;
  for (std::uint32_t c = 0; c < all.size(); ++c) candidates.candidate.push_back(c);
  const PolygonSource source{s.tri(), s.height, s.crossings, s.subdivision, all, candidates, &s.assignment};
  PolygonExtractor extractor(source);
  for (int round = 0; round < 2; ++round) {
    const PolygonProblem& problem = extractor.extract(0);
    ASSERT_EQ(problem.others.size(), all.size());
    std::set<std::uint32_t> met;
    for (const VertexId v : extractor.vertices()) EXPECT_TRUE(met.insert(v.value).second);
    for (std::uint32_t c = 0; c < all.size(); ++c)
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(extractor.vertices()[problem.others[c][i]], all.vertices[c][i]);
    EXPECT_EQ(extractor.extract(s.subdivision.size() - 1).others.size(), 0U);
  }
}

TEST(PolygonBatch, EqualsTheTriangulationOfThePointSet) {
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    for (const auto& points : clouds(seed)) {
      SCOPED_TRACE(seed);
      const Scene s(points, 3, testing::random_heights(seed, points.size(), 50));
      const auto to_solve = polygons_to_solve(s.tri(), s.links, s.height, s.crossings, s.subdivision,
                                              Objective::local_minima, &s.assignment);
      const Answer found = solve(s, Objective::local_minima, to_solve, order_k_triangles(s.tri(), s.edges), 10);
      Triangles expected;
      for (const auto& t : triangulate(points, s.height, 3, Objective::local_minima).triangles)
        expected.insert(sorted(t));
      EXPECT_EQ(found.ids(), expected);
    }
}

TEST(OrderKTriangles, OfPolygonsAreThoseOfTheWhole) {
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    for (const auto& points : clouds(seed)) {
      SCOPED_TRACE(seed);
      const Scene s(points, 4, std::vector<std::int32_t>(points.size()));
      const OrderKTriangles whole = order_k_triangles(s.tri(), s.edges);
      std::vector<std::uint8_t> odd(s.subdivision.size());
      for (std::size_t f = 1; f < odd.size(); f += 2) odd[f] = 1;
      std::set<std::array<VertexId, 3>> expected;
      for (std::uint32_t c = 0; c < whole.size(); ++c)
        if (odd[s.subdivision.polygon[triangle_of(whole.entry[c]).value]]) expected.insert(whole.vertices[c]);
      const OrderKTriangles some = triangles_of(s, odd);
      EXPECT_EQ(std::set(some.vertices.begin(), some.vertices.end()), expected);
      EXPECT_EQ(some.size(), expected.size());
    }
}

// Parts carried out in another order, and by several threads, give the same.
TEST(OrderK, IsTheSameForEveryExecutor) {
  const auto points = testing::distinct(testing::make_cloud(testing::CloudKind::scanlines, 5, 60'000, 60));
  const Scene s(points, 3, testing::random_heights(5, points.size(), 50));
  for (const Executor& executor : {Executor(testing::backwards), Executor(testing::on_four_threads)}) {
    const UsefulEdges edges = useful_edges(s.tri(), s.links, 3, executor);
    EXPECT_EQ(edges.begin, s.edges.begin);
    EXPECT_EQ(edges.b, s.edges.b);
    EXPECT_EQ(edges.left, s.edges.left);
    EXPECT_EQ(edges.right, s.edges.right);
    EXPECT_EQ(edges.num_left, s.edges.num_left);
    EXPECT_EQ(edges.num_right, s.edges.num_right);
    EXPECT_EQ(edges.entry, s.edges.entry);
    EXPECT_EQ(edges.apex, s.edges.apex);
    const Crossings crossings = find_crossings(s.tri(), edges, executor);
    EXPECT_EQ(crossings.crossed, s.crossings.crossed);
    EXPECT_EQ(crossings.exit, s.crossings.exit);
    const Subdivision subdivision = subdivide(s.tri(), crossings.crossed, executor);
    EXPECT_EQ(subdivision.polygon, s.subdivision.polygon);
    EXPECT_EQ(subdivision.triangle, s.subdivision.triangle);
    EXPECT_EQ(subdivision.components, s.subdivision.components);
    const OrderKTriangles triangles = order_k_triangles(s.tri(), edges, executor);
    EXPECT_EQ(triangles.vertices, s.triangles.vertices);
    EXPECT_EQ(triangles.order, s.triangles.order);
    const MinimaAssignment assignment = assign_minima(s.tri(), s.links, edges, crossings, s.height, executor);
    EXPECT_EQ(assignment.fate, s.assignment.fate);
    EXPECT_EQ(assignment.where, s.assignment.where);
    const auto choose = [&](const Executor& how) {
      return polygons_to_solve(s.tri(), s.links, s.height, crossings, subdivision, Objective::local_minima, &assignment,
                               how);
    };
    EXPECT_EQ(choose(executor), choose(serially));
  }
}

}  // namespace
}  // namespace hydrotin
