#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "hydrotin/predicates.h"
#include "hydrotin/thinning.h"

/// Thinning from its definition: every round starts from nothing, with all triples of points kept. For few points with
/// coordinates below 2^10.
namespace hydrotin::oracle {

__extension__ using ThinWide = __int128;

class NaiveThinning {
 public:
  NaiveThinning(std::vector<LatticePoint> position, std::vector<std::int32_t> height, std::set<int> hull,
                const ThinningOptions& options)
      : p_(std::move(position)), z_(std::move(height)), options_(options), kept_(seeds()) {
    kept_.insert(hull.begin(), hull.end());
    fate.assign(p_.size(), PointFate::removed);
    for (const int v : kept_) fate[at(v)] = PointFate::seed;
    insert(kPoliteRounds, kEagerRounds, kLastRounds, PointFate::inserted);
    if (options.prune) prune();
  }

  /// Settling from given fates.
  NaiveThinning(std::vector<LatticePoint> position, std::vector<std::int32_t> height, const std::set<int>& hull,
                const ThinningOptions& options, std::vector<PointFate> start)
      : fate(std::move(start)), p_(std::move(position)), z_(std::move(height)), options_(options) {
    for (const int v : hull)
      if (!is_kept(fate[at(v)])) fate[at(v)] = PointFate::seed;
    for (int i = 0; i < size(); ++i)
      if (is_kept(fate[at(i)])) kept_.insert(i);
    insert(0, kSettlingRounds / 2, kSettlingRounds / 2, PointFate::settled);
  }

  std::vector<PointFate> fate;
  int rounds = 0, pruning_rounds = 0;

  /// Whether all points removed are within the limit.
  [[nodiscard]] bool is_within() const {
    const auto tri = delaunay_of(kept_);
    for (int q = 0; q < size(); ++q)
      if (!kept_.contains(q) && is_beyond(tri[holder(tri, q)], q)) return false;
    return true;
  }

 private:
  using Tri = std::array<int, 3>;
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] int size() const { return static_cast<int>(p_.size()); }

  [[nodiscard]] std::set<int> seeds() const {
    std::map<std::array<std::int64_t, 2>, int> best;
    const auto cell_of = [&](int i) {
      const auto down = [&](std::int64_t v) {
        std::int64_t c = v / options_.cell;
        while (c * options_.cell > v) --c;
        while ((c + 1) * options_.cell <= v) ++c;
        return c;
      };
      return std::array{down(p_[at(i)].x - options_.grid_x), down(p_[at(i)].y - options_.grid_y)};
    };
    const auto distance = [&](int i) {
      const auto c = cell_of(i);
      const std::int64_t dx = 2 * (p_[at(i)].x - options_.grid_x) - (2 * c[0] + 1) * options_.cell;
      const std::int64_t dy = 2 * (p_[at(i)].y - options_.grid_y) - (2 * c[1] + 1) * options_.cell;
      return dx * dx + dy * dy;
    };
    for (int i = 0; i < size(); ++i) {
      const auto [found, is_new] = best.emplace(cell_of(i), i);
      if (!is_new && std::pair{distance(i), p_[at(i)]} < std::pair{distance(found->second), p_[at(found->second)]})
        found->second = i;
    }
    std::set<int> out;
    for (const auto& [cell, i] : best) out.insert(i);
    return out;
  }

  [[nodiscard]] std::vector<Tri> delaunay_of(const std::set<int>& points) const {
    const std::vector<int> v(points.begin(), points.end());
    std::vector<Tri> out;
    for (std::size_t i = 0; i < v.size(); ++i)
      for (std::size_t j = i + 1; j < v.size(); ++j)
        for (std::size_t k = j + 1; k < v.size(); ++k) {
          Tri t{v[i], v[j], v[k]};
          const int turn = orientation(p_[at(t[0])], p_[at(t[1])], p_[at(t[2])]);
          if (turn == 0) continue;
          if (turn < 0) std::swap(t[1], t[2]);
          const bool is_empty = std::none_of(v.begin(), v.end(), [&](int q) {
            return q != t[0] && q != t[1] && q != t[2] &&
                   in_circle(p_[at(t[0])], p_[at(t[1])], p_[at(t[2])], p_[at(q)]);
          });
          if (is_empty) out.push_back(t);
        }
    return out;
  }

  // Whether p + (e, e^2), e = 2^-20, lies inside.
  [[nodiscard]] bool holds_moved(const Tri& t, LatticePoint p) const {
    constexpr std::int64_t kOne = std::int64_t{1} << 40, kE = std::int64_t{1} << 20;
    const ThinWide x = static_cast<ThinWide>(p.x) * kOne + kE, y = static_cast<ThinWide>(p.y) * kOne + 1;
    for (std::size_t i = 0; i < 3; ++i) {
      const LatticePoint a = p_[at(t[i])], b = p_[at(t[(i + 1) % 3])];
      const ThinWide turn = (ThinWide{b.x} - a.x) * (y - static_cast<ThinWide>(a.y) * kOne) -
                            (ThinWide{b.y} - a.y) * (x - static_cast<ThinWide>(a.x) * kOne);
      if (turn <= 0) return false;
    }
    return true;
  }
  [[nodiscard]] bool holds_closed(const Tri& t, LatticePoint p) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (orientation(p_[at(t[i])], p_[at(t[(i + 1) % 3])], p) < 0) return false;
    return true;
  }
  [[nodiscard]] std::size_t holder(const std::vector<Tri>& tri, int q) const {
    for (std::size_t t = 0; t < tri.size(); ++t)
      if (holds_moved(tri[t], p_[at(q)])) return t;
    for (std::size_t t = 0; t < tri.size(); ++t)
      if (holds_closed(tri[t], p_[at(q)])) return t;
    std::abort();
  }

  // Twice the area, and that times the distance.
  [[nodiscard]] std::array<ThinWide, 2> distance(const Tri& t, int q) const {
    const auto x = [&](int i) { return ThinWide{p_[at(i)].x}; };
    const auto y = [&](int i) { return ThinWide{p_[at(i)].y}; };
    const auto area = [&](int a, int b, int c) {
      return x(a) * (y(b) - y(c)) + x(b) * (y(c) - y(a)) + x(c) * (y(a) - y(b));
    };
    const ThinWide whole = area(t[0], t[1], t[2]);
    const ThinWide plane =
        z_[at(t[0])] * area(q, t[1], t[2]) + z_[at(t[1])] * area(t[0], q, t[2]) + z_[at(t[2])] * area(t[0], t[1], q);
    const ThinWide num = z_[at(q)] * whole - plane;
    return {whole, num < 0 ? -num : num};
  }
  [[nodiscard]] bool is_beyond(const Tri& t, int q) const {
    const auto [den, num] = distance(t, q);
    return num * 1'000'000 > den * options_.limit_millionths;
  }
  [[nodiscard]] double error(const Tri& t, int q) const {
    const auto [den, num] = distance(t, q);
    return static_cast<double>(num) / static_cast<double>(den);
  }

  // Circumradius at most two cells: products of the squared sides against the area.
  [[nodiscard]] bool is_local(const Tri& t) const {
    const auto side2 = [&](std::size_t i) {
      const LatticePoint a = p_[at(t[i])], b = p_[at(t[(i + 1) % 3])];
      const long double dx = static_cast<long double>(a.x) - b.x, dy = static_cast<long double>(a.y) - b.y;
      return dx * dx + dy * dy;
    };
    const auto whole = static_cast<long double>(distance(t, t[0])[0]);
    const long double radius = 2.0L * options_.cell;
    return side2(0) * side2(1) * side2(2) <= 4 * radius * radius * whole * whole;
  }

  void insert(std::uint32_t polite, std::uint32_t eager, std::uint32_t last, PointFate as) {
    for (std::uint32_t round = 1; round <= polite + eager + last; ++round) {
      const auto tri = delaunay_of(kept_);
      std::vector<std::vector<int>> in(tri.size());
      for (int q = 0; q < size(); ++q)
        if (!kept_.contains(q)) in[holder(tri, q)].push_back(q);
      std::vector<std::optional<int>> proposal(tri.size());
      std::set<int> accepted;
      for (std::size_t t = 0; t < tri.size(); ++t) {
        for (const int q : in[t]) {
          if (!is_local(tri[t])) accepted.insert(q);
          if (!is_local(tri[t]) || !is_beyond(tri[t], q)) continue;
          if (round > polite + eager) accepted.insert(q);
          if (!proposal[t] || comes_before(tri[t], q, tri[t], *proposal[t])) proposal[t] = q;
        }
      }
      for (std::size_t t = 0; t < tri.size(); ++t) {
        if (!proposal[t]) continue;
        bool is_best = true;
        for (std::size_t n = 0; n < tri.size() && round <= polite; ++n)
          if (n != t && proposal[n] && share_edge(tri[t], tri[n]))
            is_best = is_best && comes_before(tri[t], *proposal[t], tri[n], *proposal[n]);
        if (is_best) accepted.insert(*proposal[t]);
      }
      if (accepted.empty()) return;
      rounds = static_cast<int>(round);
      for (const int q : accepted) {
        kept_.insert(q);
        fate[at(q)] = as;
      }
    }
  }

  [[nodiscard]] bool comes_before(const Tri& s, int p, const Tri& t, int q) const {
    const double a = error(s, p), b = error(t, q);
    return a != b ? a > b : p_[at(p)] < p_[at(q)];
  }

  static bool share_edge(const Tri& s, const Tri& t) {
    int shared = 0;
    for (const int a : s) shared += std::count(t.begin(), t.end(), a) > 0;
    return shared == 2;
  }

  void prune() {
    for (std::uint32_t round = 1; round <= kPruningRounds; ++round) {
      const auto tri = delaunay_of(kept_);
      std::map<int, double> may_go;
      for (const int v : kept_)
        if (const auto worst = error_without(tri, v)) may_go[v] = *worst;
      std::set<int> chosen;
      for (const auto& [v, worst] : may_go) {
        bool is_first = true;
        for (const auto& [w, other] : may_go)
          if (w != v && std::any_of(tri.begin(), tri.end(), [&](const Tri& t) { return has(t, v) && has(t, w); }))
            is_first = is_first && (worst != other ? worst < other : number(p_[at(v)]) < number(p_[at(w)]));
        if (is_first) chosen.insert(v);
      }
      if (chosen.empty()) return;
      pruning_rounds = static_cast<int>(round);
      for (const int v : chosen) {
        kept_.erase(v);
        fate[at(v)] = PointFate::pruned;
      }
    }
  }

  static bool has(const Tri& t, int v) { return std::count(t.begin(), t.end(), v) > 0; }

  [[nodiscard]] std::uint64_t number(LatticePoint p) const {
    std::uint64_t h = static_cast<std::uint64_t>(p.x - options_.grid_x) * 0x9e3779b97f4a7c15ULL +
                      static_cast<std::uint64_t>(p.y - options_.grid_y);
    for (const std::uint64_t factor : {0xff51afd7ed558ccdULL, 0xc4ceb9fe1a85ec53ULL})
      h = (h ^ (h / 8589934592U)) * factor;
    return h ^ (h / 8589934592U);
  }

  // Nothing if the vertex has to stay.
  [[nodiscard]] std::optional<double> error_without(const std::vector<Tri>& tri, int v) const {
    std::vector<Tri> star;
    std::map<int, int> balance;  // of the far vertices: on the hull one comes and does not go
    for (const Tri& t : tri) {
      if (!has(t, v)) continue;
      if (!is_local(t)) return std::nullopt;
      star.push_back(t);
      const std::size_t i = t[0] == v ? 0 : t[1] == v ? 1 : 2;
      ++balance[t[(i + 1) % 3]];
      --balance[t[(i + 2) % 3]];
    }
    for (const auto& [w, count] : balance)
      if (count != 0) return std::nullopt;
    std::set<int> rest = kept_;
    rest.erase(v);
    double worst = 0;
    std::vector<Tri> fill;
    for (const Tri& t : delaunay_of(rest))
      if (std::count(tri.begin(), tri.end(), t) == 0) fill.push_back(t);
    for (const Tri& t : fill)
      if (!is_local(t)) return std::nullopt;
    for (int q = 0; q < size(); ++q) {
      if (q != v && (kept_.contains(q) || !has(tri[holder(tri, q)], v))) continue;
      const Tri& t = fill[holder(fill, q)];
      if (is_beyond(t, q)) return std::nullopt;
      worst = std::max(worst, error(t, q));
    }
    return worst;
  }

  std::vector<LatticePoint> p_;
  std::vector<std::int32_t> z_;
  ThinningOptions options_;
  std::set<int> kept_;
};

}  // namespace hydrotin::oracle
