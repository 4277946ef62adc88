#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "polygon_graph.h"

/// Dynamic programming over the directed edges of a polygon (T3.1), for a measure given as a `Rule`.
///
/// A rule has
///   Cell                     what is stored for a directed edge: the best ways to triangulate its left side
///   Entry                    one such way: `option` (kNoEdge: none) and the `child_state` of both children
///   empty(), boundary(e)     the cell of an edge before any option, and of one whose left side is outside
///   improve(cell, o, l, r)   takes option o into account, whose children have the cells l and r
///   best_state(cell)         the entry that the answer of the whole polygon starts from, or -1
/// `Ways` says how the components inside are tied to the boundary, and with that which cells there are:
///   kMany                    more than one way: `improve` gets the way as its last argument, entries have a `way`
///   num_cells(), chord(e)    the cells, and that of an edge between places on the outer boundary
///   edge_of(c), is_end(c)    the edge of a cell, and whether nothing is left to triangulate
///   for_ways(c, o, visit)    calls visit(way) for every way in which option o may stand on the edge of the cell
///   children(c, option, way)  the cells of both children then

namespace hydrotin {

/// One way: `closed` edges count as boundary. Without components there is none.
class OneWay {
 public:
  static constexpr bool kMany = false;

  OneWay(const PolygonGraph& graph, const std::vector<std::uint8_t>& closed) : graph_(graph), closed_(closed) {}

  [[nodiscard]] std::uint32_t num_cells() const { return graph_.num_edges(); }
  [[nodiscard]] static std::uint32_t chord(std::uint32_t e) { return e; }
  [[nodiscard]] static std::uint32_t edge_of(std::uint32_t c) { return c; }
  [[nodiscard]] bool is_end(std::uint32_t c) const { return graph_.edge(c).is_boundary || closed_[c]; }
  template <class Visit>
  void for_ways(std::uint32_t, std::uint32_t, Visit visit) const {
    visit(0U);
  }
  [[nodiscard]] static std::pair<std::uint32_t, std::uint32_t> children(std::uint32_t, const Option& option,
                                                                        std::uint32_t) {
    return {option.left_child, option.right_child};
  }

 private:
  const PolygonGraph& graph_;
  const std::vector<std::uint8_t>& closed_;
};

template <class Rule, class Ways = OneWay>
class PolygonProgram {
 public:
  /// Solves the polygon; false if no triangulation avoids the blocked triangles.
  bool run(const Rule& rule, const PolygonGraph& graph, const Ways& ways, const std::vector<std::uint8_t>& blocked) {
    graph_ = &graph;
    state_.assign(ways.num_cells(), kOpen);
    cell_.resize(ways.num_cells());
    root_ = ways.chord(graph.root());
    stack_.assign(1, root_);
    while (!stack_.empty()) {
      const std::uint32_t c = stack_.back();
      if (state_[c] == kDone) {
        stack_.pop_back();
      } else if (state_[c] == kOpen && !ways.is_end(c)) {
        state_[c] = kEntered;
        for_options(ways, c, blocked, [&](const Option& option, std::uint32_t, std::uint32_t way) {
          const auto [left, right] = ways.children(c, option, way);
          if (state_[left] == kOpen) stack_.push_back(left);
          if (state_[right] == kOpen) stack_.push_back(right);
        });
      } else {
        solve(rule, ways, c, blocked);
        state_[c] = kDone;
        stack_.pop_back();
      }
    }
    return rule.best_state(root_cell()) >= 0;
  }

  [[nodiscard]] const typename Rule::Cell& root_cell() const { return cell_[root_]; }

  /// Calls visit(o, entry) for the options of the answer and their entries. `ways` are those of the run.
  template <class Visit>
  void read_back(const Rule& rule, const Ways& ways, Visit visit) {
    trail_.assign(1, {root_, rule.best_state(root_cell())});
    while (!trail_.empty()) {
      const auto [c, state] = trail_.back();
      trail_.pop_back();
      if (ways.is_end(c)) continue;
      const auto& entry = cell_[c][static_cast<std::size_t>(state)];
      const Option& option = graph_->option(entry.option);
      std::uint32_t way = 0;
      if constexpr (Ways::kMany) way = entry.way;
      visit(entry.option, entry);
      const auto [left, right] = ways.children(c, option, way);
      trail_.push_back({right, static_cast<int>(entry.child_state[1])});
      trail_.push_back({left, static_cast<int>(entry.child_state[0])});
    }
  }

 private:
  static constexpr std::uint8_t kOpen = 0, kEntered = 1, kDone = 2;

  template <class Visit>
  void for_options(const Ways& ways, std::uint32_t c, const std::vector<std::uint8_t>& blocked, Visit visit) const {
    for (std::uint32_t o = graph_->edge(ways.edge_of(c)).first_option; o != kNoEdge; o = graph_->option(o).next) {
      const Option& option = graph_->option(o);
      if (!blocked[option.triangle]) ways.for_ways(c, o, [&](std::uint32_t way) { visit(option, o, way); });
    }
  }

  void solve(const Rule& rule, const Ways& ways, std::uint32_t c, const std::vector<std::uint8_t>& blocked) {
    if (ways.is_end(c)) {
      cell_[c] = rule.boundary(ways.edge_of(c));
      return;
    }
    typename Rule::Cell cell = rule.empty();
    for_options(ways, c, blocked, [&](const Option& option, std::uint32_t o, std::uint32_t way) {
      const auto [left, right] = ways.children(c, option, way);
      // A child still being solved would close a cycle around a component that no tie reaches.
      if (state_[left] != kDone || state_[right] != kDone) return;
      if constexpr (Ways::kMany)
        rule.improve(cell, o, cell_[left], cell_[right], way);
      else
        rule.improve(cell, o, cell_[left], cell_[right]);
    });
    cell_[c] = std::move(cell);
  }

  const PolygonGraph* graph_ = nullptr;
  std::uint32_t root_ = 0;
  std::vector<std::uint8_t> state_;
  std::vector<typename Rule::Cell> cell_;
  std::vector<std::uint32_t> stack_;
  std::vector<std::pair<std::uint32_t, int>> trail_;
};

}  // namespace hydrotin
