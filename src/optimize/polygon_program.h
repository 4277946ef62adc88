#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "polygon_graph.h"

/// Dynamic programming over the directed edges of a polygon (T3.1), for a measure given as a `Rule`.
///
/// A rule has
///   Cell                    what is stored for a directed edge: the best ways to triangulate its left side, one per
///   state boundary()              the cell of an edge whose left side is outside improve(cell, o, l, r)  takes option
///   o into account, whose children have the cells l and r best_state(cell)        the state that the answer of the
///   whole polygon starts from

namespace hydrotin {

/// Length of an edge [lattice units].
inline double length(LatticePoint a, LatticePoint b) {
  const double dx = static_cast<double>(b.x) - a.x, dy = static_cast<double>(b.y) - a.y;
  return std::sqrt(dx * dx + dy * dy);
}

/// Sum of the lengths of the inner edges; equal sums: fewer edges that are not Delaunay.
struct MinWeightRule {
  struct Value {
    double weight = std::numeric_limits<double>::infinity();
    std::int64_t foreign = 0;  // twice the number of edges that are not Delaunay
    friend bool operator<(const Value& a, const Value& b) {
      return a.weight != b.weight ? a.weight < b.weight : a.foreign < b.foreign;
    }
    friend bool operator==(const Value&, const Value&) = default;
  };
  static constexpr int kStates = 1;
  struct Entry {
    Value value;
    std::uint32_t option = kNoEdge;
    std::array<std::uint8_t, 2> child_state{};
  };
  using Cell = std::array<Entry, 1>;

  const PolygonProblem& problem;
  const PolygonGraph& graph;

  [[nodiscard]] static bool possible(const Value& v) { return v.weight < std::numeric_limits<double>::infinity(); }
  [[nodiscard]] static Cell boundary() {
    Cell cell;
    cell[0].value.weight = 0;
    return cell;
  }
  [[nodiscard]] Value side(std::uint32_t e, const Cell& cell) const {
    const PolygonEdge& edge = graph.edge(e);
    if (edge.is_boundary || !possible(cell[0].value)) return cell[0].value;
    const double weight = length(problem.position[edge.origin], problem.position[edge.target]);
    if (cell[0].option == kNoEdge)  // a closed edge is met from both sides
      return {cell[0].value.weight + weight / 2, cell[0].value.foreign + !edge.is_delaunay};
    return {cell[0].value.weight + weight, cell[0].value.foreign + 2 * !edge.is_delaunay};
  }
  void improve(Cell& cell, std::uint32_t o, const Cell& left, const Cell& right) const {
    const Value a = side(graph.option(o).left_child, left), b = side(graph.option(o).right_child, right);
    offer(cell[0], {a.weight + b.weight, a.foreign + b.foreign}, o);
  }
  void offer(Entry& entry, const Value& value, std::uint32_t o) const {
    if (!possible(value)) return;
    const bool earlier = entry.option != kNoEdge &&
                         problem.position[graph.option(o).apex] < problem.position[graph.option(entry.option).apex];
    if (entry.option == kNoEdge || value < entry.value || (value == entry.value && earlier)) entry = {value, o, {}};
  }
  [[nodiscard]] int best_state(const Cell&) const { return 0; }
};

/// Vertices that want a lower neighbour and get none; equal counts: fewer edges that are not Delaunay.
/// State bit 0: the origin of the edge has to get a lower neighbour strictly inside; bit 1: its target has to.
struct LocalMinimaRule {
  using Value = std::int64_t;  // gain: served vertices * kServed - edges that are not Delaunay
  static constexpr Value kServed = Value{1} << 32;
  static constexpr Value kImpossible = std::numeric_limits<Value>::min() / 4;
  static constexpr int kStates = 4;
  struct Entry {
    Value value = kImpossible;
    std::uint32_t option = kNoEdge;
    std::array<std::uint8_t, 2> child_state{};
  };
  using Cell = std::array<Entry, 4>;

  const PolygonProblem& problem;
  const PolygonGraph& graph;

  [[nodiscard]] static bool possible(Value v) { return v > kImpossible / 2; }
  [[nodiscard]] static Cell boundary() {
    Cell cell;
    cell[0].value = 0;
    return cell;
  }
  [[nodiscard]] bool lower(std::uint32_t p, std::uint32_t q) const {
    return is_lower(problem.height[p], problem.position[p], problem.height[q], problem.position[q]);
  }
  void improve(Cell& cell, std::uint32_t o, const Cell& left, const Cell& right) const {
    const Option& option = graph.option(o);
    const PolygonEdge& el = graph.edge(option.left_child);   // i -> q
    const PolygonEdge& er = graph.edge(option.right_child);  // q -> j
    const std::uint32_t i = el.origin, q = option.apex, j = er.target;
    const bool inner_l = !el.is_boundary, inner_r = !er.is_boundary;
    const Value price = -Value{inner_l && !el.is_delaunay} - Value{inner_r && !er.is_delaunay};
    const bool i_served = inner_l && lower(q, i), j_served = inner_r && lower(q, j);
    const bool q_served = (inner_l && !i_served) || (inner_r && !j_served);
    const bool q_wants = problem.wants_lower[q] != 0;
    for (unsigned state = 0; state < 4; ++state) {
      const unsigned need_i = (state & 1U) && !i_served, need_j = (state & 2U) && !j_served;
      const auto offer = [&](unsigned q_left, unsigned q_right, Value gain) {
        const unsigned sl = need_i | q_left << 1U, sr = q_right | need_j << 1U;
        offer_entry(cell[state], left[sl].value + right[sr].value + price + gain, o,
                    {static_cast<std::uint8_t>(sl), static_cast<std::uint8_t>(sr)});
      };
      offer(0, 0, q_wants && q_served ? kServed : 0);
      if (q_wants && !q_served) {
        offer(1, 0, kServed);
        offer(0, 1, kServed);
      }
    }
  }
  void offer_entry(Entry& entry, Value value, std::uint32_t o, std::array<std::uint8_t, 2> child_state) const {
    if (!possible(value)) return;
    const bool earlier = entry.option != kNoEdge && entry.option != o &&
                         problem.position[graph.option(o).apex] < problem.position[graph.option(entry.option).apex];
    if (entry.option == kNoEdge || value > entry.value || (value == entry.value && earlier))
      entry = {value, o, child_state};
  }
  [[nodiscard]] Value with_ends(const Cell& cell, int state) const {
    const PolygonEdge& root = graph.edge(graph.root());
    return cell[static_cast<std::size_t>(state)].value + (state & 1 ? kServed * problem.wants_lower[root.origin] : 0) +
           (state & 2 ? kServed * problem.wants_lower[root.target] : 0);
  }
  [[nodiscard]] int best_state(const Cell& cell) const {
    int best = 0;
    for (int state = 1; state < 4; ++state)
      if (with_ends(cell, state) > with_ends(cell, best)) best = state;
    return best;
  }
};

/// One dynamic program over a graph; `blocked` triangles are not used and `closed` edges count as boundary.
template <class Rule>
class PolygonProgram {
 public:
  /// Solves the polygon; false if no triangulation avoids the blocked triangles.
  bool run(const Rule& rule, const PolygonGraph& graph, const std::vector<std::uint8_t>& blocked,
           const std::vector<std::uint8_t>& closed) {
    graph_ = &graph;
    closed_ = &closed;
    state_.assign(graph.num_edges(), kOpen);
    cell_.resize(graph.num_edges());
    stack_.assign(1, graph.root());
    while (!stack_.empty()) {
      const std::uint32_t e = stack_.back();
      if (state_[e] == kDone) {
        stack_.pop_back();
      } else if (state_[e] == kOpen && !is_end(e)) {
        state_[e] = kEntered;
        for_options(e, blocked, [&](const Option& option, std::uint32_t) {
          for (const std::uint32_t child : {option.left_child, option.right_child})
            if (state_[child] == kOpen) stack_.push_back(child);
        });
      } else {
        solve(rule, e, blocked);
        state_[e] = kDone;
        stack_.pop_back();
      }
    }
    return cell_[graph.root()][0].option != kNoEdge;
  }

  [[nodiscard]] const typename Rule::Cell& root_cell() const { return cell_[graph_->root()]; }

  /// Appends the numbers of the triangles of the answer.
  void read_back(const Rule& rule, std::vector<std::uint32_t>& triangles) {
    trail_.assign(1, {graph_->root(), rule.best_state(cell_[graph_->root()])});
    while (!trail_.empty()) {
      const auto [e, state] = trail_.back();
      trail_.pop_back();
      if (is_end(e)) continue;
      const auto& entry = cell_[e][static_cast<std::size_t>(state)];
      const Option& option = graph_->option(entry.option);
      triangles.push_back(option.triangle);
      trail_.push_back({option.right_child, entry.child_state[1]});
      trail_.push_back({option.left_child, entry.child_state[0]});
    }
  }

 private:
  static constexpr std::uint8_t kOpen = 0, kEntered = 1, kDone = 2;

  [[nodiscard]] bool is_end(std::uint32_t e) const { return graph_->edge(e).is_boundary || (*closed_)[e]; }

  template <class Visit>
  void for_options(std::uint32_t e, const std::vector<std::uint8_t>& blocked, Visit visit) {
    for (std::uint32_t o = graph_->edge(e).first_option; o != kNoEdge; o = graph_->option(o).next)
      if (!blocked[graph_->option(o).triangle]) visit(graph_->option(o), o);
  }

  void solve(const Rule& rule, std::uint32_t e, const std::vector<std::uint8_t>& blocked) {
    if (is_end(e)) {
      cell_[e] = Rule::boundary();
      return;
    }
    typename Rule::Cell cell{};
    for_options(e, blocked, [&](const Option& option, std::uint32_t o) {
      // A child still being solved would close a cycle around a component that no tie reaches.
      if (state_[option.left_child] != kDone || state_[option.right_child] != kDone) return;
      rule.improve(cell, o, cell_[option.left_child], cell_[option.right_child]);
    });
    cell_[e] = cell;
  }

  const PolygonGraph* graph_ = nullptr;
  const std::vector<std::uint8_t>* closed_ = nullptr;
  std::vector<std::uint8_t> state_;
  std::vector<typename Rule::Cell> cell_;
  std::vector<std::uint32_t> stack_;
  std::vector<std::pair<std::uint32_t, int>> trail_;
};

}  // namespace hydrotin
