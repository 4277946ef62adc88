#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <numeric>
#include <random>

#include "executors.h"
#include "hydrotin/river_burning.h"
#include "hydrotin/river_embedding.h"
#include "hydrotin/river_statistics.h"
#include "oracle/full_river_program.h"
#include "river_terrains.h"

namespace hydrotin {
namespace {

using testing::add_rivers;
using testing::random_terrain;
using testing::TestTerrain;

std::vector<RiverConstraints> variants() {
  std::vector<RiverConstraints> list;
  RiverConstraints vf;
  vf.decline_measure = DeclineMeasure::none;
  vf.limit_edge_slope = false;
  list.push_back(vf);
  for (const bool slope : {false, true}) {
    RiverConstraints c;
    c.limit_edge_slope = slope;
    list.push_back(c);
    c.decline_measure = DeclineMeasure::slope;
    c.decline = std::tan(std::acos(-1.0) / 180);
    list.push_back(c);
    c.side_slope = 0.01;
    list.push_back(c);
  }
  RiverConstraints only = list[1];
  only.river_only = true;
  list.push_back(only);
  RiverConstraints capped = list[4];
  capped.max_change = 3;
  list.push_back(capped);
  return list;
}

double total_change(const TestTerrain& terrain, const std::vector<double>& height) {
  double sum = 0;
  for (std::size_t v = 0; v < height.size(); ++v) sum += std::abs(height[v] - terrain.height[v]);
  return sum;
}

TEST(RiverEmbedding, Objective_EqualsThatOfTheFullProgramInEveryVariant) {
  int solved = 0, contradictory = 0;
  for (std::uint32_t seed = 0; seed < 150; ++seed) {
    TestTerrain terrain = random_terrain(seed, 12 + seed % 30, seed % 3 == 0);
    add_rivers(terrain, seed, 1 + seed % 4, 6, seed % 2 == 0);
    if (terrain.rivers.empty()) continue;
    ASSERT_EQ(check_network(terrain.view(), terrain.rivers).fault, NetworkFault::none);
    int variant = 0;
    for (const RiverConstraints& constraints : variants()) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << " variant " << variant++);
      EmbeddingOptions options;
      options.constraints = constraints;
      const Embedding embedding = embed_rivers(terrain.view(), terrain.rivers, options);
      const oracle::FullProgram program(terrain, constraints);
      const auto full = program.solve();
      ASSERT_EQ(full.has_value(), embedding.broken.empty());
      EXPECT_TRUE(embedding.optimal);
      EXPECT_NEAR(embedding.objective, total_change(terrain, embedding.height), 1e-9);
      if (!full) {
        ++contradictory;
        continue;
      }
      ++solved;
      EXPECT_LE(program.violation(embedding.height), 1e-5);
      EXPECT_NEAR(embedding.objective, *full, 1e-6 * std::max(1.0, *full));
      EXPECT_NEAR(embedding.bound, *full, 1e-6 * std::max(1.0, *full));
      const auto after = river_statistics(terrain.view(), terrain.rivers, embedding.height, 1e-6);
      EXPECT_EQ(after.wrong_flow, 0u);
      EXPECT_EQ(after.not_valley, 0u);
    }
  }
  EXPECT_GT(solved, 700);
  EXPECT_GT(contradictory, 20);
}

TEST(RiverEmbedding, IsTheSameForEveryExecutor) {
  std::uint32_t components = 0;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    TestTerrain terrain = random_terrain(seed, 400, false);
    add_rivers(terrain, seed, 12, 6, true);
    EmbeddingOptions options;
    options.quantum = 0.01;
    const Embedding one = embed_rivers(terrain.view(), terrain.rivers, options);
    components = std::max(components, one.components);
    for (const Executor& executor : {Executor(testing::backwards), Executor(testing::on_four_threads)}) {
      options.executor = executor;
      const Embedding other = embed_rivers(terrain.view(), terrain.rivers, options);
      EXPECT_EQ(other.height, one.height);
      EXPECT_EQ(other.objective, one.objective);
      EXPECT_EQ(other.bound, one.bound);
      EXPECT_EQ(other.rows, one.rows);
      EXPECT_EQ(other.iterations, one.iterations);
    }
  }
  EXPECT_GT(components, 3u);
}

TEST(RiverEmbedding, Quantum_EveryEdgeIsValidInExactArithmetic) {
  using Rational = boost::multiprecision::cpp_rational;
  for (std::uint32_t seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE(seed);
    TestTerrain terrain = random_terrain(seed, 20 + seed % 40, false);
    add_rivers(terrain, seed, 3, 8, true);
    for (const RiverConstraints& constraints : {variants()[0], variants()[1], variants()[4]}) {
      EmbeddingOptions options;
      options.constraints = constraints;
      options.quantum = seed % 2 == 0 ? 0.01 : 0.001;
      const Embedding embedding = embed_rivers(terrain.view(), terrain.rivers, options);
      EXPECT_TRUE(embedding.broken.empty());
      const auto& h = embedding.height;
      for (std::size_t v = 0; v < h.size(); ++v)
        if (h[v] != terrain.height[v]) {
          EXPECT_EQ(h[v], std::round(h[v] / options.quantum) * options.quantum);
        }
      for (const auto& [a, b] : terrain.rivers) {
        EXPECT_GE(h[a], h[b]);
        for (std::size_t t = 0; t < terrain.triangle.size(); t += 3) {
          const std::uint32_t* c = terrain.triangle.data() + t;
          if (std::count(c, c + 3, a) == 0 || std::count(c, c + 3, b) == 0) continue;
          const std::uint32_t w = c[0] + c[1] + c[2] - a - b;
          const auto at = [&](std::uint32_t v, std::size_t axis) { return Rational(terrain.position[v][axis]); };
          const Rational x = at(b, 0) - at(a, 0), y = at(b, 1) - at(a, 1);
          const Rational share = ((at(w, 0) - at(a, 0)) * x + (at(w, 1) - at(a, 1)) * y) / (x * x + y * y);
          EXPECT_GE(Rational(h[w]), (1 - share) * Rational(h[a]) + share * Rational(h[b]));
        }
      }
    }
  }
}

TEST(RiverEmbedding, NumberingAndPlace_DoNotMatter) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    TestTerrain terrain = random_terrain(seed, 40, seed % 2 == 0);
    add_rivers(terrain, seed, 4, 8, false);
    if (terrain.rivers.empty()) continue;
    std::mt19937 random(seed);
    std::vector<std::uint32_t> name(terrain.height.size());
    std::iota(name.begin(), name.end(), 0u);
    std::shuffle(name.begin(), name.end(), random);
    TestTerrain other = terrain, far = terrain;
    for (std::uint32_t v = 0; v < name.size(); ++v) {
      other.position[name[v]] = terrain.position[v];
      other.height[name[v]] = terrain.height[v];
      far.position[v] = {terrain.position[v][0] + 431234.0, terrain.position[v][1] + 5412345.0};
    }
    for (auto& v : other.triangle) v = name[v];
    for (auto& [from, to] : other.rivers) {
      from = name[from];
      to = name[to];
    }
    std::shuffle(other.rivers.begin(), other.rivers.end(), random);
    EmbeddingOptions options;
    const Embedding a = embed_rivers(terrain.view(), terrain.rivers, options);
    const Embedding b = embed_rivers(other.view(), other.rivers, options);
    for (std::uint32_t v = 0; v < name.size(); ++v) ASSERT_EQ(a.height[v], b.height[name[v]]);
    EXPECT_EQ(a.objective, b.objective);
    EXPECT_EQ(a.rows, b.rows);
    const Embedding c = embed_rivers(far.view(), far.rivers, options);
    if (a.broken.empty()) {
      EXPECT_NEAR(a.objective, c.objective, 1e-6 * std::max(1.0, a.objective));
    }
  }
}

// Two triangles on both sides of the edge from 0 (0, 0) to 1 (10, 0); wingtips 2 above and 3 below.
TestTerrain one_edge(double tip_x, double h0, double h1, double h2, double h3) {
  return {{{0, 0}, {10, 0}, {tip_x, 8}, {5, -8}}, {h0, h1, h2, h3}, {0, 1, 2, 0, 3, 1}, {{0, 1}}};
}

Embedding embed(const TestTerrain& terrain, const RiverConstraints& constraints) {
  EmbeddingOptions options;
  options.constraints = constraints;
  return embed_rivers(terrain.view(), terrain.rivers, options);
}

TEST(RiverEmbedding, OneEdge_ByHand) {
  const RiverConstraints vf = variants()[0];
  EXPECT_EQ(embed(one_edge(5, 10, 9, 20, 20), vf).objective, 0);
  EXPECT_NEAR(embed(one_edge(5, 9, 10, 20, 20), vf).objective, 1, 1e-9);  // flow alone
  EXPECT_NEAR(embed(one_edge(5, 10, 10, 7, 20), vf).objective, 3, 1e-9);  // lift one wingtip
  // Behind: the foot is at t = 2, H is there at 2 * 8 - 10 = 6; at 5.5 the wingtip lacks 0.5, h1 only half of it.
  EXPECT_NEAR(embed(one_edge(20, 10, 8, 5.5, 20), vf).objective, 0.25, 1e-9);
  EXPECT_EQ(embed(one_edge(20, 10, 8, 6, 20), vf).objective, 0);
  RiverConstraints steep = vf;
  steep.decline_measure = DeclineMeasure::slope;
  steep.decline = 0.2;
  EXPECT_NEAR(embed(one_edge(5, 10, 9, 20, 20), steep).objective, 1, 1e-9);
  // The average slope is negative: clamped, as VF.
  const Embedding clamped = embed(one_edge(5, 9, 10, 20, 20), variants()[1]);
  EXPECT_EQ(clamped.clamped_networks.size(), 1u);
  EXPECT_NEAR(clamped.objective, 1, 1e-9);
}

TEST(RiverEmbedding, Lake_IsLevelAndMayHaveALevel) {
  int cases = 0;
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    TestTerrain terrain = random_terrain(seed, 60, false);
    add_rivers(terrain, seed, 3, 6, true);
    if (terrain.rivers.empty()) continue;
    // The lake at the first mouth: its neighbours that no river edge into it sees.
    std::vector<std::uint8_t> flows(terrain.height.size(), 0);
    for (const auto& edge : terrain.rivers) flows[edge.from] = 1;
    const auto links = testing::neighbors_of(terrain);
    const auto [from, mouth] = *std::find_if(terrain.rivers.begin(), terrain.rivers.end(),
                                             [&](const RiverEdge& edge) { return flows[edge.to] == 0; });
    Lake lake;
    lake.vertex = {mouth};
    for (const std::uint32_t v : links[mouth])
      if (v != from && std::count(links[from].begin(), links[from].end(), v) == 0) lake.vertex.push_back(v);
    EmbeddingOptions options;
    options.constraints = variants()[1];
    for (const double quantum : {0.0, 0.01})
      for (const bool has_level : {false, true}) {
        lake.has_level = has_level;
        lake.level = 2.34;
        options.constraints.lakes = {lake};
        options.quantum = quantum;
        const Embedding e = embed_rivers(terrain.view(), terrain.rivers, options);
        if (!e.broken.empty()) continue;
        ++cases;
        for (const std::uint32_t v : lake.vertex) EXPECT_EQ(e.height[v], e.height[mouth]);
        if (has_level) {
          EXPECT_EQ(e.height[mouth], 2.34);
        }
      }
  }
  EXPECT_GT(cases, 60);
}

TEST(RiverEmbedding, Contiguous_LeavesNoLeak) {
  int leaks = 0, cases = 0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    TestTerrain terrain = random_terrain(seed, 50, false);
    add_rivers(terrain, seed, 2, 8, true);
    if (terrain.rivers.empty()) continue;
    RiverConstraints c = variants()[1];
    const Embedding plain = embed(terrain, c);
    leaks += static_cast<int>(river_statistics(terrain.view(), terrain.rivers, plain.height, 1e-6).leak_vertices);
    c.contiguity = Contiguity::exact;
    const Embedding exact = embed(terrain, c);
    if (!exact.broken.empty()) continue;
    EXPECT_EQ(river_statistics(terrain.view(), terrain.rivers, exact.height, 1e-5).leak_vertices, 0u);
    EXPECT_GE(exact.objective, plain.objective - 1e-6);
    c.contiguity = Contiguity::imaginary_points;
    for (const std::uint32_t points : {0u, 3u, 20u}) {
      c.imaginary_points = points;
      const Embedding many = embed(terrain, c);
      if (!many.broken.empty()) continue;
      ++cases;
      EXPECT_EQ(river_statistics(terrain.view(), terrain.rivers, many.height, 1e-5).leak_vertices, 0u);
      EXPECT_GE(many.objective, exact.objective - 1e-5);  // T's rows are stronger than needed
    }
  }
  EXPECT_GT(leaks, 20);
  EXPECT_GT(cases, 60);
}

// The side of each wingtip and the bend of an edge, by plane equations.
TEST(RiverEmbedding, PreservedEdges_AndTriangleSlopes_StayAsTheyWere) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    TestTerrain terrain = random_terrain(seed, 50, false);
    add_rivers(terrain, seed, 2, 6, true);
    if (terrain.rivers.empty()) continue;
    std::vector<bool> river(terrain.height.size(), false);
    for (const auto& [a, b] : terrain.rivers) river[a] = river[b] = true;
    RiverConstraints c = variants()[1];
    c.directions = {0, 1, 2};
    const auto links = testing::neighbors_of(terrain);
    for (std::uint32_t a = 0; a < links.size(); ++a)
      for (const std::uint32_t b : links[a])
        if (a < b && !river[a] && !river[b]) c.preserve.push_back({a, b, true, true});
    const Embedding e = embed(terrain, c);
    const auto gradient = [&](std::size_t t, const std::vector<double>& h) {
      const auto &p = terrain.position[terrain.triangle[t]], &q = terrain.position[terrain.triangle[t + 1]],
                 &r = terrain.position[terrain.triangle[t + 2]];
      const double hp = h[terrain.triangle[t]], hq = h[terrain.triangle[t + 1]], hr = h[terrain.triangle[t + 2]];
      const double det = (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
      return std::array<double, 2>{((hq - hp) * (r[1] - p[1]) - (hr - hp) * (q[1] - p[1])) / det,
                                   ((q[0] - p[0]) * (hr - hp) - (r[0] - p[0]) * (hq - hp)) / det};
    };
    if (e.broken.empty())
      for (std::size_t t = 0; t < terrain.triangle.size(); t += 3) {
        if (river[terrain.triangle[t]] || river[terrain.triangle[t + 1]] || river[terrain.triangle[t + 2]]) continue;
        const auto before = gradient(t, terrain.height), after = gradient(t, e.height);
        for (const double angle : c.directions) {
          const double s0 = before[0] * std::cos(angle) + before[1] * std::sin(angle);
          const double s1 = after[0] * std::cos(angle) + after[1] * std::sin(angle);
          EXPECT_LE(std::abs(s1 - s0), 0.5 * std::abs(s0) + 1e-4);
        }
        for (std::size_t i = 0; i < 3; ++i) {  // inflow and outflow edges stay what they are
          const auto &p = terrain.position[terrain.triangle[t + i]],
                     &q = terrain.position[terrain.triangle[t + (i + 1) % 3]];
          const double b0 = before[0] * (q[1] - p[1]) - before[1] * (q[0] - p[0]);
          const double b1 = after[0] * (q[1] - p[1]) - after[1] * (q[0] - p[0]);
          EXPECT_FALSE(b0 * b1 < 0 && std::abs(b1) > 1e-4 && std::abs(b0) > 1e-9) << b0 << " " << b1;
        }
      }
  }
}

TEST(RiverEmbedding, Limits_EndWithFeasibleHeightsAndABound) {
  int stopped = 0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    TestTerrain terrain = random_terrain(seed, 60, false);
    add_rivers(terrain, seed, 4, 8, true);
    EmbeddingOptions options;
    const Embedding best = embed_rivers(terrain.view(), terrain.rivers, options);
    for (const std::uint64_t limit : {0, 3, 10}) {
      options.max_iterations = limit;
      const Embedding e = embed_rivers(terrain.view(), terrain.rivers, options);
      if (!e.optimal) ++stopped;
      EXPECT_TRUE(e.broken.empty());
      EXPECT_LE(e.bound, best.objective + 1e-6);
      EXPECT_GE(e.objective, best.objective - 1e-6);
      const auto after = river_statistics(terrain.view(), terrain.rivers, e.height, 1e-6);
      EXPECT_EQ(after.wrong_flow + after.not_valley, 0u);
    }
  }
  EXPECT_GT(stopped, 60);
}

TEST(RiverBurning, Objective_EqualsTheProgramWithRiverVerticesOnly) {
  int solved = 0, infeasible = 0;
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    TestTerrain terrain = random_terrain(seed, 15 + seed % 90, seed % 3 == 0 && seed % 90 < 40);
    add_rivers(terrain, seed, 1 + seed % 6, 4 + seed % 14, true);
    if (terrain.rivers.empty()) continue;
    EmbeddingOptions options;
    options.constraints = variants()[seed % 2];
    options.constraints.river_only = true;
    options.constraints.side_slope = seed % 5 == 0 ? 0.02 : 0;
    const auto decline = fractional_declines(terrain.view(), terrain.rivers, seed % 2 == 0 ? 0 : 0.1);
    const Burning burning = burn_rivers(terrain.view(), terrain.rivers, {decline, options.constraints.side_slope});
    const Embedding program = embed_rivers(terrain.view(), terrain.rivers, options);
    if (burning.fault == BurningFault::infeasible) {
      ++infeasible;
      EXPECT_FALSE(program.broken.empty());
      continue;
    }
    ASSERT_EQ(burning.fault, BurningFault::none);
    EXPECT_TRUE(program.broken.empty());
    ++solved;
    EXPECT_NEAR(burning.objective, program.objective, 1e-6 * std::max(1.0, program.objective));
    EXPECT_NEAR(burning.objective, total_change(terrain, burning.height), 1e-9);
    const auto after = river_statistics(terrain.view(), terrain.rivers, burning.height, 1e-9);
    EXPECT_EQ(after.wrong_flow + after.not_valley, 0u);
  }
  EXPECT_GT(solved, 200);
}

// Chains ask for less than rivers; margins of a quantum are those of the program.
TEST(RiverBurning, ChainsAndQuantum_EqualTheProgramWithRiverVerticesOnly) {
  int solved = 0, with_chains = 0;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    TestTerrain terrain = random_terrain(seed, 15 + seed % 90, false);
    add_rivers(terrain, seed, 1 + seed % 6, 4 + seed % 14, true);
    EmbeddingOptions options;
    options.constraints = variants()[seed % 2];
    options.constraints.river_only = true;
    options.quantum = seed % 4 == 0 ? 0 : 0.01;
    for (double& h : terrain.height)
      if (options.quantum > 0) h = std::round(h / options.quantum) * options.quantum;
    std::vector<std::uint32_t> has_down(terrain.height.size(), 0);
    for (const auto& edge : terrain.rivers) has_down[edge.from] = 1;
    std::vector<RiverEdge> rivers;
    for (const auto& edge : terrain.rivers)
      (has_down[edge.to] == 0 && seed % 3 != 0 ? options.constraints.chain : rivers).push_back(edge);
    if (rivers.empty()) continue;
    const BurnedEmbedding burned = embed_by_burning(terrain.view(), rivers, options);
    if (burned.fault != BurningFault::none) continue;
    const Embedding program = embed_rivers(terrain.view(), rivers, options);
    ++solved;
    with_chains += options.constraints.chain.empty() ? 0 : 1;
    EXPECT_NEAR(burned.embedding.bound, program.bound, 1e-5 * std::max(1.0, program.bound));
    EXPECT_EQ(burned.embedding.columns, burned.embedding.touched.size());
    const auto after =
        river_statistics(terrain.view(), rivers, burned.embedding.height, options.quantum > 0 ? 0 : 1e-9);
    EXPECT_EQ(after.wrong_flow + after.not_valley, 0u);
    for (const auto& [from, to] : options.constraints.chain)
      EXPECT_GE(burned.embedding.height[from], burned.embedding.height[to] - (options.quantum > 0 ? 0 : 1e-9));
    // A part without all triangles says so.
    std::vector<std::uint8_t> complete(terrain.height.size(), 1);
    complete[rivers[0].to] = 0;
    options.is_complete = complete;
    EXPECT_EQ(embed_by_burning(terrain.view(), rivers, options).embedding.incomplete,
              std::vector<std::uint32_t>{rivers[0].to});
  }
  EXPECT_GT(solved, 120);
  EXPECT_GT(with_chains, 40);
}

TEST(RiverBurning, Faults_AreNamed) {
  TestTerrain terrain = one_edge(5, 1, 2, 3, 4);
  const auto fault = [&](const std::vector<RiverEdge>& rivers) {
    return burn_rivers(terrain.view(), rivers, {std::vector<double>(rivers.size(), 0.0)}).fault;
  };
  EXPECT_EQ(fault({{0, 1}}), BurningFault::none);
  EXPECT_EQ(fault({{0, 1}, {0, 2}}), BurningFault::not_a_forest);
  EXPECT_EQ(fault({{0, 1}, {1, 2}}), BurningFault::river_at_wingtip);
}

TEST(RiverNetwork, Faults_AreNamed) {
  const TestTerrain terrain = one_edge(5, 1, 2, 3, 4);
  const auto check = [&](const std::vector<RiverEdge>& rivers) { return check_network(terrain.view(), rivers); };
  EXPECT_EQ(check({{0, 1}, {0, 2}}).fault, NetworkFault::none);
  EXPECT_EQ(check({{0, 4}}).fault, NetworkFault::no_vertex);
  EXPECT_EQ(check({{1, 1}}).fault, NetworkFault::no_vertex);
  EXPECT_EQ(check({{0, 1}, {2, 3}}).edge, std::vector<std::uint32_t>{1});
  EXPECT_EQ(check({{2, 3}}).fault, NetworkFault::no_edge);
  EXPECT_EQ(check({{0, 1}, {0, 1}}).fault, NetworkFault::repeated);
  const auto both = check({{0, 1}, {1, 0}});
  EXPECT_EQ(both.fault, NetworkFault::directed_cycle);
  EXPECT_EQ(both.edge.size(), 2u);
  const auto cycle = check({{3, 0}, {2, 0}, {1, 2}, {0, 1}});
  EXPECT_EQ(cycle.fault, NetworkFault::directed_cycle);
  ASSERT_EQ(cycle.edge.size(), 3u);
  EXPECT_EQ(std::set<std::uint32_t>(cycle.edge.begin(), cycle.edge.end()), (std::set<std::uint32_t>{1, 2, 3}));
}

}  // namespace
}  // namespace hydrotin
