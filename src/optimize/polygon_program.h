#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "polygon_graph.h"

/// Dynamic programming over the directed edges of a polygon (T3.1), for a measure given as a `Rule`.
///
/// A rule has
///   Cell                     what is stored for a directed edge: the best ways to triangulate its left side
///   Entry                    one such way: `option` (kNoEdge: none) and the `child_state` of both children
///   boundary()               the cell of an edge whose left side is outside
///   improve(cell, o, l, r)   takes option o into account, whose children have the cells l and r
///   best_state(cell)         the entry that the answer of the whole polygon starts from, or -1

namespace hydrotin {

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
    return finish(rule, blocked);
  }

  /// The same after changes of `blocked` and `closed` on which only the cells of the edges given to `forget` depend.
  /// Precondition: no cycle around a component is left open, before and after.
  bool run_again(const Rule& rule, const PolygonGraph& graph, const std::vector<std::uint8_t>& blocked,
                 const std::vector<std::uint8_t>& closed) {
    graph_ = &graph;
    closed_ = &closed;
    return finish(rule, blocked);
  }
  void forget(std::span<const std::uint32_t> edges) {
    for (const std::uint32_t e : edges) state_[e] = kOpen;
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
      trail_.push_back({option.right_child, static_cast<int>(entry.child_state[1])});
      trail_.push_back({option.left_child, static_cast<int>(entry.child_state[0])});
    }
  }

 private:
  static constexpr std::uint8_t kOpen = 0, kEntered = 1, kDone = 2;

  // Fills all open cells that the root's depends on.
  bool finish(const Rule& rule, const std::vector<std::uint8_t>& blocked) {
    stack_.assign(1, graph_->root());
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
    return rule.best_state(cell_[graph_->root()]) >= 0;
  }

  [[nodiscard]] bool is_end(std::uint32_t e) const { return graph_->edge(e).is_boundary || (*closed_)[e]; }

  template <class Visit>
  void for_options(std::uint32_t e, const std::vector<std::uint8_t>& blocked, Visit visit) {
    for (std::uint32_t o = graph_->edge(e).first_option; o != kNoEdge; o = graph_->option(o).next)
      if (!blocked[graph_->option(o).triangle]) visit(graph_->option(o), o);
  }

  void solve(const Rule& rule, std::uint32_t e, const std::vector<std::uint8_t>& blocked) {
    if (is_end(e)) {
      cell_[e] = rule.boundary(e);
      return;
    }
    typename Rule::Cell cell = rule.empty();
    for_options(e, blocked, [&](const Option& option, std::uint32_t o) {
      // A child still being solved would close a cycle around a component that no tie reaches.
      if (state_[option.left_child] != kDone || state_[option.right_child] != kDone) return;
      rule.improve(cell, o, cell_[option.left_child], cell_[option.right_child]);
    });
    cell_[e] = std::move(cell);
  }

  const PolygonGraph* graph_ = nullptr;
  const std::vector<std::uint8_t>* closed_ = nullptr;
  std::vector<std::uint8_t> state_;
  std::vector<typename Rule::Cell> cell_;
  std::vector<std::uint32_t> stack_;
  std::vector<std::pair<std::uint32_t, int>> trail_;
};

}  // namespace hydrotin
