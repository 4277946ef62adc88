#include "polygon_flips.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "degree_program.h"

namespace hydrotin {
namespace {

constexpr std::uint32_t kNone = kNoEdge;

class Flips {
 public:
  Flips(const PolygonGraph& graph, const PolygonOptions& options, const PolygonCosts& costs,
        const std::vector<FlipCriterion>& criteria, const BeyondSides& beyond,
        const std::vector<std::uint32_t>& triangles)
      : graph_(graph), options_(options), costs_(costs), criteria_(criteria), beyond_(beyond) {
    option_.assign(graph.num_edges(), kNone);
    lower_.assign(graph.problem().position.size(), 0);
    degree_ = degrees(graph, triangles);
    for (const std::uint32_t t : triangles) place(t, true);
    for (std::uint32_t e = 0; e < graph.num_edges(); ++e)
      if (graph_.is_inner(e) && before(e)) {
        edges_.push_back(e);
        if (option_[e] != kNone) count_edge(e, 1);
      }
    std::sort(edges_.begin(), edges_.end(), [&](std::uint32_t e, std::uint32_t f) { return key(e) < key(f); });
  }

  void run(int max_passes) {
    for (int pass = 0; pass < max_passes; ++pass) {
      bool changed = false;
      for (const std::uint32_t e : edges_) changed |= option_[e] != kNone && flip(e);
      if (!changed) return;
    }
  }

  void read(std::vector<std::uint32_t>& triangles) const {
    triangles.clear();
    for (std::uint32_t e = 0; e < option_.size(); ++e) {
      if (option_[e] == kNone) continue;
      const std::uint32_t t = PolygonGraph::triangle_of(option_[e]);
      // Of its three directed edges the first corner's stands for the triangle.
      const auto& v = graph_.triangle(t);
      if (graph_.edge(e).origin == v[0] && graph_.edge(e).target == v[1]) triangles.push_back(t);
    }
  }

 private:
  // The quadrilateral a, d, b, c around the edge ab: c on its left, d on its right; the edge becomes dc.
  struct Quadrilateral {
    std::uint32_t edge, twin;  // ab, ba
    std::uint32_t a, b, c, d;
    std::uint32_t left, right;          // options before: on ab, on ba
    std::uint32_t new_left, new_right;  // options after: on cd (apex b), on dc (apex a)
  };

  [[nodiscard]] LatticePoint at(std::uint32_t v) const { return graph_.problem().position[v]; }
  [[nodiscard]] bool before(std::uint32_t e) const { return at(graph_.edge(e).origin) < at(graph_.edge(e).target); }
  [[nodiscard]] std::pair<LatticePoint, LatticePoint> key(std::uint32_t e) const {
    return {at(graph_.edge(e).origin), at(graph_.edge(e).target)};
  }
  [[nodiscard]] std::uint32_t option_with(std::uint32_t e, std::uint32_t apex) const {
    if (e == kNone) return kNone;
    for (std::uint32_t o = graph_.edge(e).first_option; o != kNone; o = graph_.option(o).next)
      if (graph_.option(o).apex == apex) return o;
    return kNone;
  }
  [[nodiscard]] std::uint32_t lower_end(std::uint32_t a, std::uint32_t b) const {
    const PolygonProblem& p = graph_.problem();
    return is_lower(p.height[a], p.position[a], p.height[b], p.position[b]) ? a : b;
  }

  void place(std::uint32_t t, bool present) {
    for (std::size_t i = 0; i < 3; ++i) option_[graph_.side(t, i)] = present ? PolygonGraph::option_on(t, i) : kNone;
  }
  void count_edge(std::uint32_t e, int change) {
    const std::uint32_t a = graph_.edge(e).origin, b = graph_.edge(e).target;
    const std::uint32_t upper = lower_end(a, b) == a ? b : a;
    lower_[upper] = static_cast<std::uint32_t>(static_cast<int>(lower_[upper]) + change);
  }

  [[nodiscard]] std::optional<Quadrilateral> quadrilateral(std::uint32_t e) const {
    Quadrilateral q{};
    q.edge = e;
    q.twin = PolygonGraph::twin(e);
    q.left = option_[e];
    q.right = option_[q.twin];
    q.a = graph_.edge(e).origin;
    q.b = graph_.edge(e).target;
    q.c = graph_.option(q.left).apex;
    q.d = graph_.option(q.right).apex;
    q.new_left = option_with(graph_.find(q.c, q.d), q.b);
    q.new_right = option_with(graph_.find(q.d, q.c), q.a);
    if (q.new_left == kNone || q.new_right == kNone) return std::nullopt;
    return q;
  }

  bool flip(std::uint32_t e) {
    const auto q = quadrilateral(e);
    if (!q || !improves(*q)) return false;
    place(PolygonGraph::triangle_of(q->left), false);
    place(PolygonGraph::triangle_of(q->right), false);
    place(PolygonGraph::triangle_of(q->new_left), true);
    place(PolygonGraph::triangle_of(q->new_right), true);
    const std::uint32_t added = graph_.find(q->c, q->d);
    count_edge(e, -1);
    count_edge(added, 1);
    --degree_[q->a];
    --degree_[q->b];
    ++degree_[q->c];
    ++degree_[q->d];
    return true;
  }

  [[nodiscard]] bool improves(const Quadrilateral& q) const {
    for (const FlipCriterion& criterion : criteria_) {
      const int sign = compare(criterion, q);
      if (sign != 0) return sign < 0;
    }
    return false;
  }

  // Below 0: the flip improves.
  [[nodiscard]] int compare(const FlipCriterion& criterion, const Quadrilateral& q) const {
    const auto triangle = [&](std::uint32_t o) { return PolygonGraph::triangle_of(o); };
    const auto sign = [](const auto& after, const auto& before) {
      return after < before ? -1 : before < after ? 1 : 0;
    };
    if (criterion.score != nullptr) {
      const auto& s = *criterion.score;
      return sign(std::max(s[triangle(q.new_left)], s[triangle(q.new_right)]),
                  std::max(s[triangle(q.left)], s[triangle(q.right)]));
    }
    if (criterion.by_degree) {
      const std::uint32_t a = degree_[q.a], b = degree_[q.b], c = degree_[q.c], d = degree_[q.d];
      return sign(std::max({a - 1, b - 1, c + 1, d + 1}), std::max({a, b, c, d}));
    }
    if (criterion.by_pairs) return sign(pairs(q, true), pairs(q, false));
    const auto cost = [&](std::uint32_t o) { return costs_.of(triangle(o), criterion.slot); };
    Wide after = cost(q.new_left) + cost(q.new_right), now = cost(q.left) + cost(q.right);
    if (criterion.slot == costs_.minima_slot) after += minima_change(q);
    return sign(after, now);
  }

  // Gains lost (positive) and won at the four vertices.
  [[nodiscard]] Wide minima_change(const Quadrilateral& q) const {
    const auto& wants = graph_.problem().wants_lower;
    Wide change = 0;
    const std::uint32_t loses = lower_end(q.a, q.b) == q.a ? q.b : q.a;
    const std::uint32_t wins = lower_end(q.c, q.d) == q.c ? q.d : q.c;
    if (lower_[loses] == 1) change += PolygonCosts::kGain[wants[loses]];
    if (lower_[wins] == 0) change -= PolygonCosts::kGain[wants[wins]];
    return change;
  }

  // Worst or total score over the edge inside the quadrilateral and its four sides.
  [[nodiscard]] double pairs(const Quadrilateral& q, bool after) const {
    const bool sum = kind_of(options_.objectives.front()) == ObjectiveKind::quadrilateral_sum;
    double value = sum ? 0 : -std::numeric_limits<double>::infinity();
    const auto add = [&](std::uint32_t outer, const SurfacePoint& left, std::uint32_t right) {
      const double score = pair_score(graph_, options_, outer, left, right);
      value = sum ? value + score : std::max(value, score);
    };
    const auto point = [&](std::uint32_t v) { return SurfacePoint{at(v), graph_.problem().height[v]}; };
    const auto side = [&](std::uint32_t from, std::uint32_t to, std::uint32_t inside) {
      const std::uint32_t outer = graph_.find(to, from);
      if (option_[outer] != kNone)
        add(outer, point(graph_.option(option_[outer]).apex), inside);
      else if (beyond_[outer])
        add(outer, *beyond_[outer], inside);
    };
    if (after) {
      add(graph_.find(q.c, q.d), point(q.b), q.a);
      side(q.a, q.d, q.c);
      side(q.d, q.b, q.c);
      side(q.b, q.c, q.d);
      side(q.c, q.a, q.d);
    } else {
      add(q.edge, point(q.c), q.d);
      side(q.a, q.d, q.b);
      side(q.d, q.b, q.a);
      side(q.b, q.c, q.a);
      side(q.c, q.a, q.b);
    }
    return value;
  }

  const PolygonGraph& graph_;
  const PolygonOptions& options_;
  const PolygonCosts& costs_;
  const std::vector<FlipCriterion>& criteria_;
  const BeyondSides& beyond_;
  std::vector<std::uint32_t> option_;  // the option that stands on a directed edge, by edge
  std::vector<std::uint32_t> edges_;   // inner edges, in (x, y) order
  std::vector<std::uint32_t> lower_;   // lower neighbours over inner edges, by vertex
  std::vector<std::uint32_t> degree_;
};

}  // namespace

void improve_by_flips(const PolygonGraph& graph, const PolygonOptions& options, const PolygonCosts& costs,
                      const std::vector<FlipCriterion>& criteria, const BeyondSides& beyond,
                      std::vector<std::uint32_t>& triangles, int max_passes) {
  Flips flips(graph, options, costs, criteria, beyond, triangles);
  flips.run(max_passes);
  flips.read(triangles);
}

}  // namespace hydrotin
