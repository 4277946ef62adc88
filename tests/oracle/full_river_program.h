#pragma once

#include <Clp_C_Interface.h>

#include <array>
#include <cfloat>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "hydrotin/river_constraints.h"
#include "river_terrains.h"

/// The linear program as the thesis writes it: all vertices, all rows, h = h0 + rise - fall, valleys by determinants.
namespace hydrotin::oracle {

using testing::TestTerrain;

/// The determinant of Section 7.1.1, with the three heights as given.
inline double thesis_determinant(const std::array<double, 2>& i, const std::array<double, 2>& j,
                                 const std::array<double, 2>& w, double h_i, double h_j, double h_w) {
  const std::array<double, 2> u = {i[0] + (j[1] - i[1]), i[1] - (j[0] - i[0])};  // (v_j - v_i) x k + v_i
  double m[4][4] = {{1, i[0], i[1], h_i}, {1, j[0], j[1], h_j}, {1, u[0], u[1], h_i}, {1, w[0], w[1], h_w}};
  double det = 1;
  for (int c = 0; c < 4; ++c) {
    int pivot = c;
    for (int r = c + 1; r < 4; ++r)
      if (std::abs(m[r][c]) > std::abs(m[pivot][c])) pivot = r;
    if (m[pivot][c] == 0) return 0;
    if (pivot != c) {
      std::swap(m[pivot], m[c]);
      det = -det;
    }
    det *= m[c][c];
    for (int r = c + 1; r < 4; ++r) {
      const double f = m[r][c] / m[c][c];
      for (int k = c; k < 4; ++k) m[r][k] -= f * m[c][k];
    }
  }
  return det;
}

class FullProgram {
 public:
  FullProgram(const TestTerrain& terrain, const RiverConstraints& constraints) : t_(terrain), c_(constraints) {
    for (const auto& [from, to] : t_.rivers) river_[from] = river_[to] = true;
    add_river_rows();
    if (c_.limit_edge_slope) add_slope_rows();
  }

  /// How far heights are outside the rows.
  [[nodiscard]] double violation(const std::vector<double>& height) const {
    double most = 0;
    for (const auto& row : rows_) {
      double sum = 0;
      for (const auto& [i, a] : row.entry) sum += a * height[static_cast<std::size_t>(i / 3)];
      most = std::max({most, row.lower - sum, sum - row.upper});
    }
    return most;
  }

  /// The least total change; nothing if the rows contradict each other.
  [[nodiscard]] std::optional<double> solve() const {
    const int n = static_cast<int>(t_.height.size());
    Clp_Simplex* model = Clp_newModel();
    Clp_setLogLevel(model, 0);
    Clp_setPrimalTolerance(model, 1e-9);
    Clp_setDualTolerance(model, 1e-9);
    Clp_resize(model, 0, 3 * n);
    std::vector<double> lower, upper, cost;
    for (int v = 0; v < n; ++v) {
      double most = c_.max_change > 0 ? c_.max_change : DBL_MAX;
      if (c_.river_only && !river_.contains(static_cast<std::uint32_t>(v))) most = 0;
      lower.insert(lower.end(), {-DBL_MAX, 0, 0});
      upper.insert(upper.end(), {DBL_MAX, most, most});
      cost.insert(cost.end(), {0, 1, 1});
    }
    Clp_chgColumnLower(model, lower.data());
    Clp_chgColumnUpper(model, upper.data());
    Clp_chgObjCoefficients(model, cost.data());
    const auto add = [&](const std::map<int, double>& row, double lo, double up) {
      std::vector<int> index;
      std::vector<double> value;
      for (const auto& [i, a] : row) {
        if (std::abs(a) < 1e-12) continue;  // rounding in the determinant: the simplex would scale it up
        index.push_back(i);
        value.push_back(a);
      }
      const int starts[] = {0, static_cast<int>(index.size())};
      Clp_addRows(model, 1, &lo, &up, starts, index.data(), value.data());
    };
    for (int v = 0; v < n; ++v) {
      const double h = t_.height[static_cast<std::size_t>(v)];
      add({{3 * v, 1}, {3 * v + 1, -1}, {3 * v + 2, 1}}, h, h);
    }
    for (const auto& row : rows_) add(row.entry, row.lower, row.upper);
    Clp_dual(model, 0);
    Clp_primal(model, 0);
    std::optional<double> value;
    if (Clp_status(model) == 0) value = Clp_objectiveValue(model);
    Clp_deleteModel(model);
    return value;
  }

 private:
  struct Row {
    std::map<int, double> entry;
    double lower, upper;
  };

  double slope_of(const RiverEdge& edge) const {
    if (c_.decline_measure == DeclineMeasure::none) return 0;
    if (c_.decline_measure == DeclineMeasure::slope) return c_.decline;
    // The network of the edge, by growing it.
    std::vector<bool> in(t_.height.size(), false);
    in[edge.from] = true;
    for (bool grows = true; grows;) {
      grows = false;
      for (const auto& [a, b] : t_.rivers)
        if (in[a] != in[b]) in[a] = in[b] = grows = true;
    }
    double drop = 0, length = 0;
    for (const auto& [a, b] : t_.rivers) {
      if (!in[a]) continue;
      drop += t_.height[a] - t_.height[b];
      length += std::hypot(t_.position[a][0] - t_.position[b][0], t_.position[a][1] - t_.position[b][1]);
    }
    return std::max(0.0, c_.decline * drop / length);
  }

  void add_river_rows() {
    for (const RiverEdge& edge : t_.rivers) {
      const auto &p = t_.position[edge.from], &q = t_.position[edge.to];
      const int a = 3 * static_cast<int>(edge.from), b = 3 * static_cast<int>(edge.to);
      const double length = std::hypot(p[0] - q[0], p[1] - q[1]);
      if (c_.flow) rows_.push_back({{{a, 1}, {b, -1}}, slope_of(edge) * length, DBL_MAX});
      if (!c_.valley) continue;
      for (std::size_t t = 0; t < t_.triangle.size(); t += 3) {
        const std::set<std::uint32_t> corners(t_.triangle.begin() + static_cast<long>(t),
                                              t_.triangle.begin() + static_cast<long>(t) + 3);
        if (!corners.contains(edge.from) || !corners.contains(edge.to)) continue;
        for (const std::uint32_t w : corners) {
          if (w == edge.from || w == edge.to) continue;
          const auto& r = t_.position[w];
          const double weight = thesis_determinant(p, q, r, 0, 0, 1);
          const double distance = std::abs((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])) / length;
          rows_.push_back({{{a, thesis_determinant(p, q, r, 1, 0, 0) / weight},
                            {b, thesis_determinant(p, q, r, 0, 1, 0) / weight},
                            {3 * static_cast<int>(w), 1}},
                           c_.side_slope * distance,
                           DBL_MAX});
        }
      }
    }
  }

  void add_slope_rows() {
    const auto links = testing::neighbors_of(t_);
    for (std::uint32_t a = 0; a < links.size(); ++a)
      for (const std::uint32_t b : links[a]) {
        if (b < a || river_.contains(a) || river_.contains(b) || t_.height[a] == t_.height[b]) continue;
        const double old = t_.height[a] - t_.height[b], width = c_.edge_slope_change * std::abs(old);
        rows_.push_back({{{3 * static_cast<int>(a), 1}, {3 * static_cast<int>(b), -1}}, old - width, old + width});
      }
  }

  const TestTerrain& t_;
  const RiverConstraints& c_;
  std::map<std::uint32_t, bool> river_;
  std::vector<Row> rows_;
};

}  // namespace hydrotin::oracle
