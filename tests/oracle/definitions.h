#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "hydrotin/lattice.h"

/// The definitions of the thesis, chapter 2, written down as slowly and plainly as possible.

namespace hydrotin::oracle {

using Big = boost::multiprecision::cpp_int;
using Points = std::vector<LatticePoint>;
using Edge = std::pair<int, int>;     ///< indices, smaller first
using Triangle = std::array<int, 3>;  ///< indices, ascending
using Triangles = std::set<Triangle>;

inline Edge edge(int a, int b) {
  return {std::min(a, b), std::max(a, b)};
}

inline Triangle triangle(int a, int b, int c) {
  Triangle t{a, b, c};
  std::sort(t.begin(), t.end());
  return t;
}

inline int side(LatticePoint a, LatticePoint b, LatticePoint c) {
  const Big area = (Big{b.x} - a.x) * (Big{c.y} - a.y) - (Big{b.y} - a.y) * (Big{c.x} - a.x);
  return area > 0 ? 1 : area < 0 ? -1 : 0;
}

/// Points are lifted to x^2 + y^2 plus infinitesimals that grow in (x, y) order, here as huge integers.
inline bool in_disc(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d) {
  if (side(a, b, c) < 0) std::swap(b, c);
  std::array<LatticePoint, 4> order{a, b, c, d};
  std::sort(order.begin(), order.end());
  const auto lifted = [&](LatticePoint p) -> Big {
    const auto rank = std::find(order.begin(), order.end(), p) - order.begin();
    const auto power = [](unsigned exponent) -> Big { return boost::multiprecision::pow(Big{2}, exponent); };
    return (Big{p.x} * p.x + Big{p.y} * p.y) * power(2000) + power(static_cast<unsigned>(400 * rank));
  };
  std::array<std::array<Big, 3>, 3> m;
  const std::array<LatticePoint, 3> rows{a, b, c};
  for (std::size_t i = 0; i < 3; ++i) m[i] = {Big{rows[i].x} - d.x, Big{rows[i].y} - d.y, lifted(rows[i]) - lifted(d)};
  const Big det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                  m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return det > 0;
}

inline bool on_segment(LatticePoint a, LatticePoint b, LatticePoint p) {
  return p != a && p != b && side(a, b, p) == 0 && std::min(a, b) < p && p < std::max(a, b);
}

inline bool cross(LatticePoint a, LatticePoint b, LatticePoint c, LatticePoint d) {
  return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

/// Definition 2.1: points inside the circumcircle.
inline int order_of(const Points& p, const Triangle& t) {
  int order = 0;
  for (int i = 0; i < static_cast<int>(p.size()); ++i)
    if (i != t[0] && i != t[1] && i != t[2])
      order += in_disc(p[static_cast<std::size_t>(t[0])], p[static_cast<std::size_t>(t[1])],
                       p[static_cast<std::size_t>(t[2])], p[static_cast<std::size_t>(i)]);
  return order;
}

/// Triangles that have no point inside or on their boundary, with their orders.
inline std::map<Triangle, int> empty_triangles(const Points& p) {
  const int n = static_cast<int>(p.size());
  const auto at = [&](int i) { return p[static_cast<std::size_t>(i)]; };
  std::map<Triangle, int> out;
  for (int a = 0; a < n; ++a)
    for (int b = a + 1; b < n; ++b)
      for (int c = b + 1; c < n; ++c) {
        const int turn = side(at(a), at(b), at(c));
        if (turn == 0) continue;
        bool empty = true;
        for (int i = 0; i < n && empty; ++i)
          if (i != a && i != b && i != c)
            empty = !(turn * side(at(a), at(b), at(i)) >= 0 && turn * side(at(b), at(c), at(i)) >= 0 &&
                      turn * side(at(c), at(a), at(i)) >= 0);
        if (empty) out[{a, b, c}] = order_of(p, {a, b, c});
      }
  return out;
}

/// All order-k triangulations of a small point set (up to about nine points), or of a polygon given by its directed
/// sides with the inside on their left.
class AllTriangulations {
 public:
  AllTriangulations(const Points& points, int k) : p_(points) {
    for (const auto& [t, order] : empty_triangles(points))
      if (order <= k) usable_.push_back(t);
    for (const auto& [a, b] : hull()) open_.insert({a, b});
    if (!open_.empty()) extend();
  }

  AllTriangulations(const Points& points, int k, const std::vector<std::pair<int, int>>& sides) : p_(points) {
    for (const auto& [t, order] : empty_triangles(points)) {
      bool cut = order > k;
      for (const auto& [a, b] : sides)
        for (std::size_t i = 0; i < 3; ++i) cut = cut || cross(at(a), at(b), at(t[i]), at(t[(i + 1) % 3]));
      if (!cut) usable_.push_back(t);
    }
    open_.insert(sides.begin(), sides.end());
    extend();
  }

  [[nodiscard]] const std::vector<Triangles>& all() const { return found_; }

 private:
  [[nodiscard]] LatticePoint at(int i) const { return p_[static_cast<std::size_t>(i)]; }

  // Directed edges with all points on the left or behind each other on the line.
  [[nodiscard]] std::vector<std::pair<int, int>> hull() const {
    std::vector<std::pair<int, int>> out;
    const int n = static_cast<int>(p_.size());
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b) {
        if (a == b) continue;
        bool is_hull = true, all_on_line = true;
        for (int i = 0; i < n && is_hull; ++i) {
          is_hull = side(at(a), at(b), at(i)) >= 0 && !on_segment(at(a), at(b), at(i));
          all_on_line = all_on_line && side(at(a), at(b), at(i)) == 0;
        }
        if (is_hull && !all_on_line) out.push_back({a, b});
      }
    return out;
  }

  [[nodiscard]] bool fits(const Triangle& t) const {
    for (const Triangle& other : chosen_)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          if (cross(at(t[static_cast<std::size_t>(i)]), at(t[static_cast<std::size_t>((i + 1) % 3)]),
                    at(other[static_cast<std::size_t>(j)]), at(other[static_cast<std::size_t>((j + 1) % 3)])))
            return false;
    return !chosen_.contains(t);
  }

  void extend() {
    if (open_.empty()) {
      found_.push_back(chosen_);
      return;
    }
    const auto [a, b] = *open_.begin();
    for (const Triangle& t : usable_) {
      if (std::find(t.begin(), t.end(), a) == t.end() || std::find(t.begin(), t.end(), b) == t.end()) continue;
      const int c = t[0] + t[1] + t[2] - a - b;
      if (side(at(a), at(b), at(c)) <= 0 || !fits(t)) continue;
      const auto saved = open_;
      chosen_.insert(t);
      open_.erase({a, b});
      // A triangle closes the open sides that it has and opens the others towards its outside.
      for (const auto& [from, to] : {std::pair{b, c}, std::pair{c, a}})
        if (open_.erase({from, to}) == 0) open_.insert({to, from});
      extend();
      open_ = saved;
      chosen_.erase(t);
    }
  }

  const Points& p_;
  std::vector<Triangle> usable_;
  std::set<std::pair<int, int>> open_;
  Triangles chosen_;
  std::vector<Triangles> found_;
};

inline std::set<Edge> edges_of(const Triangles& triangles) {
  std::set<Edge> out;
  for (const Triangle& t : triangles) out.insert({{t[0], t[1]}, {t[0], t[2]}, {t[1], t[2]}});
  return out;
}

/// Lemma 2.1 for every pair: useful order of every edge that has one of at most k; O(n^4).
inline std::map<Edge, int> useful_orders(const Points& p, int k) {
  const int n = static_cast<int>(p.size());
  const auto at = [&](int i) { return p[static_cast<std::size_t>(i)]; };
  std::map<Edge, int> out;
  for (int a = 0; a < n; ++a)
    for (int b = a + 1; b < n; ++b) {
      bool admissible = true;
      int worst = 0;
      bool has_side = false;
      for (int i = 0; i < n; ++i) admissible = admissible && !on_segment(at(a), at(b), at(i));
      if (!admissible) continue;
      for (const int s : {1, -1}) {
        int apex = -1;  // the point of this side whose circle holds no other point of this side
        for (int i = 0; i < n; ++i)
          if (i != a && i != b && side(at(a), at(b), at(i)) == s &&
              (apex < 0 || in_disc(at(a), at(b), at(apex), at(i))))
            apex = i;
        if (apex < 0) continue;
        has_side = true;
        worst = std::max(worst, order_of(p, triangle(a, b, apex)));
      }
      if (has_side && worst <= k) out[{a, b}] = worst;
    }
  return out;
}

}  // namespace hydrotin::oracle
