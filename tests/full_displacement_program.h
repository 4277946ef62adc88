#pragma once

#include <Clp_C_Interface.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "hydrotin/river_constraints.h"

/// The whole program of Theorem 7.1 with limits of slopes, in displacements: all rows and all vertices at once.
namespace hydrotin::testing {

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// All rows and all vertices; the time is that of the simplex alone.
inline double full_program(const RiverTerrain& t, std::span<const RiverEdge> rivers, const RiverConstraints& c,
                           double& seconds) {
  constexpr double kInfinity = std::numeric_limits<double>::max();
  std::vector<int> begin{0}, column;
  std::vector<double> value, lower, upper;
  const auto close = [&](double lo, double up) {
    begin.push_back(static_cast<int>(column.size()));
    lower.push_back(lo);
    upper.push_back(up);
  };
  const auto add = [&](std::uint32_t v, double a) {
    column.push_back(static_cast<int>(2 * v));
    value.push_back(a);
    column.push_back(static_cast<int>(2 * v + 1));
    value.push_back(-a);
  };
  double drop = 0, length = 0;
  std::vector<char> river(t.height.size(), 0);
  std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>> edges;
  for (const auto& [a, b] : rivers) {
    drop += t.height[a] - t.height[b];
    length += std::hypot(t.position[a][0] - t.position[b][0], t.position[a][1] - t.position[b][1]);
    river[a] = river[b] = 1;
  }
  const double slope =
      c.decline_measure == DeclineMeasure::slope ? c.decline : std::max(0.0, c.decline * drop / length);
  for (std::size_t i = 0; i < t.triangle.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k)
      edges.push_back({std::minmax(t.triangle[i + k], t.triangle[i + (k + 1) % 3]), t.triangle[i + (k + 2) % 3]});
  std::sort(edges.begin(), edges.end());
  for (const auto& [a, b] : rivers) {
    const double x = t.position[b][0] - t.position[a][0], y = t.position[b][1] - t.position[a][1];
    add(a, 1);
    add(b, -1);
    close(slope * std::hypot(x, y) - (t.height[a] - t.height[b]), kInfinity);
    const std::pair<std::uint32_t, std::uint32_t> key = std::minmax(a, b);
    for (auto e = std::lower_bound(edges.begin(), edges.end(), std::pair(key, 0u)); e != edges.end() && e->first == key;
         ++e) {
      const std::uint32_t w = e->second;
      const double s =
          ((t.position[w][0] - t.position[a][0]) * x + (t.position[w][1] - t.position[a][1]) * y) / (x * x + y * y);
      add(w, 1);
      add(a, s - 1);
      add(b, -s);
      close(-(t.height[w] - t.height[a] - s * (t.height[b] - t.height[a])), kInfinity);
    }
  }
  for (std::size_t e = 0; c.limit_edge_slope && e < edges.size(); ++e) {
    const auto [a, b] = edges[e].first;
    if ((e > 0 && edges[e - 1].first == edges[e].first) || river[a] || river[b]) continue;
    const double width = c.edge_slope_change * std::abs(t.height[a] - t.height[b]);
    if (width == 0) continue;  // flat edges are exempt
    add(a, 1);
    add(b, -1);
    close(-width, width);
  }
  // By columns.
  const std::size_t n = 2 * t.height.size();
  std::vector<CoinBigIndex> start(n + 1, 0);
  for (const int j : column) ++start[static_cast<std::size_t>(j) + 1];
  for (std::size_t j = 0; j < n; ++j) start[j + 1] += start[j];
  std::vector<int> row(column.size());
  std::vector<double> element(column.size()), zero(n, 0), free(n, kInfinity), one(n, 1);
  std::vector<CoinBigIndex> next(start.begin(), start.end() - 1);
  for (std::size_t r = 0; r + 1 < begin.size(); ++r)
    for (auto i = static_cast<std::size_t>(begin[r]); i < static_cast<std::size_t>(begin[r + 1]); ++i) {
      const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(column[i])]++);
      row[at] = static_cast<int>(r);
      element[at] = value[i];
    }
  Clp_Simplex* model = Clp_newModel();
  Clp_setLogLevel(model, 0);
  Clp_loadProblem(model, static_cast<int>(n), static_cast<int>(lower.size()), start.data(), row.data(), element.data(),
                  zero.data(), free.data(), one.data(), lower.data(), upper.data());
  Clp_setPrimalTolerance(model, 1e-9);
  Clp_setDualTolerance(model, 1e-9);
  const auto begun = std::chrono::steady_clock::now();
  Clp_dual(model, 0);
  seconds = seconds_since(begun);
  const double objective = Clp_objectiveValue(model);
  Clp_deleteModel(model);
  return objective;
}

}  // namespace hydrotin::testing
