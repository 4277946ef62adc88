#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "polygon_graph.h"

/// Dynamic programming over the directed edges of a polygon (T3.1), for a measure given as a `Rule`.
///
/// A rule has
///   Entry                    one way to triangulate the left side of an edge: `option` (kNoEdge: none) and the
///                            `child_state` of both children
///   Cells                    where the cells of directed edges are kept, each the best ways of one: clear(n) for about
///                            n of them, add(rule, edge), which returns the place of a cell without any way,
///                            add_end(rule) for the edges whose left side is outside, and at(place), which stands for
///                            the cell below
///   improve(cell, o, l, r)   takes option o into account, whose children have the cells l and r
///   best_state(cell)         the entry of the root's cell that the answer of the whole polygon starts from, or -1
///   entry(cell, edge, state)  an entry of a cell
/// `Ways` says how the components inside are tied to the boundary, and with that which cells there are:
///   kMany                    more than one way: `improve` gets the way as its last argument, entries have a `way`
///   num_cells(), chord(e)    the cells, and that of an edge between places on the outer boundary
///   edge_of(c), is_end(c)    the edge of a cell, and whether nothing is left to triangulate
///   for_ways(c, o, visit)    calls visit(way, left, right), with the cells of both children, for every way in which
///                            option o may stand on the edge of the cell
///   children(c, o, way)      these cells

namespace hydrotin {

/// Cells one by one, whatever they are made of: the rule has empty() and boundary() for those without any way and of
/// ends.
template <class Cell>
class WholeCells {
 public:
  void clear(std::size_t about) {
    cell_.clear();
    cell_.reserve(about);
  }
  template <class Rule>
  std::uint32_t add(const Rule& rule, std::uint32_t) {
    cell_.push_back(rule.empty());
    return static_cast<std::uint32_t>(cell_.size() - 1);
  }
  template <class Rule>
  std::uint32_t add_end(const Rule& rule) {
    cell_.push_back(rule.boundary());
    return static_cast<std::uint32_t>(cell_.size() - 1);
  }
  [[nodiscard]] Cell& at(std::uint32_t place) { return cell_[place]; }
  [[nodiscard]] const Cell& at(std::uint32_t place) const { return cell_[place]; }

 private:
  std::vector<Cell> cell_;
};

/// One way: `closed` edges count as boundary, if any are given. Without components there are none.
class OneWay {
 public:
  static constexpr bool kMany = false;

  explicit OneWay(const PolygonGraph& graph) : graph_(graph) {}
  OneWay(const PolygonGraph& graph, const std::vector<std::uint8_t>& closed) : graph_(graph), closed_(&closed) {}

  [[nodiscard]] std::uint32_t num_cells() const { return graph_.num_edges(); }
  [[nodiscard]] static std::uint32_t chord(std::uint32_t e) { return e; }
  [[nodiscard]] static std::uint32_t edge_of(std::uint32_t c) { return c; }
  [[nodiscard]] bool is_end(std::uint32_t c) const {
    return graph_.edge(c).is_boundary || (closed_ != nullptr && (*closed_)[c]);
  }
  template <class Visit>
  void for_ways(std::uint32_t, std::uint32_t o, Visit visit) const {
    const Option& option = graph_.option(o);
    visit(0U, option.left_child, option.right_child);
  }
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> children(std::uint32_t, std::uint32_t o, std::uint32_t) const {
    const Option& option = graph_.option(o);
    return {option.left_child, option.right_child};
  }

 private:
  const PolygonGraph& graph_;
  const std::vector<std::uint8_t>* closed_ = nullptr;
};

template <class Rule>
class PolygonProgram {
 public:
  /// Solves the polygon; false if no triangulation avoids the blocked triangles.
  template <class Ways>
  bool run(const Rule& rule, const PolygonGraph& graph, const Ways& ways, const std::vector<std::uint8_t>& blocked) {
    graph_ = &graph;
    place_.assign(ways.num_cells(), kOpen);
    cells_.clear(ways.num_cells() / 2 + 1);  // of an edge and its twin one is asked for
    end_ = cells_.add_end(rule);
    root_ = ways.chord(graph.root());
    stack_.assign(1, root_);
    while (!stack_.empty()) {
      const std::uint32_t c = stack_.back();
      if (place_[c] == kOpen) {
        place_[c] = kEntered;
        push_children(ways, c, blocked);
        continue;
      }
      stack_.pop_back();
      if (place_[c] == kEntered) solve(rule, ways, c, blocked);
    }
    return rule.best_state(root_cell()) >= 0;
  }

  [[nodiscard]] decltype(auto) root_cell() const { return cells_.at(place_[root_]); }

  /// Calls visit(o, entry) for the options of the answer and their entries. `ways` are those of the run.
  template <class Ways, class Visit>
  void read_back(const Rule& rule, const Ways& ways, Visit visit) {
    trail_.clear();
    if (!ways.is_end(root_)) trail_.push_back({root_, rule.best_state(root_cell())});
    while (!trail_.empty()) {
      const auto [c, state] = trail_.back();
      trail_.pop_back();
      const auto& entry = rule.entry(cells_.at(place_[c]), ways.edge_of(c), state);
      std::uint32_t way = 0;
      if constexpr (Ways::kMany) way = entry.way;
      visit(entry.option, entry);
      const auto [left, right] = ways.children(c, entry.option, way);
      if (!ways.is_end(right)) trail_.push_back({right, static_cast<int>(entry.child_state[1])});
      if (!ways.is_end(left)) trail_.push_back({left, static_cast<int>(entry.child_state[0])});
    }
  }

 private:
  static constexpr std::uint32_t kOpen = static_cast<std::uint32_t>(-1), kEntered = kOpen - 1;

  template <class Ways>
  void push_children(const Ways& ways, std::uint32_t c, const std::vector<std::uint8_t>& blocked) {
    const auto push = [&](std::uint32_t child) {
      if (place_[child] != kOpen) return;
      if (ways.is_end(child)) {
        place_[child] = end_;
      } else {
        stack_.push_back(child);
        graph_->fetch_option(graph_->edge(ways.edge_of(child)).first_option);  // its turn comes soon
      }
    };
    for_options(ways, c, blocked, [&](std::uint32_t, std::uint32_t, std::uint32_t left, std::uint32_t right) {
      push(left);
      push(right);
    });
  }

  template <class Ways, class Visit>
  void for_options(const Ways& ways, std::uint32_t c, const std::vector<std::uint8_t>& blocked, Visit visit) const {
    for (std::uint32_t o = graph_->edge(ways.edge_of(c)).first_option; o != kNoEdge; o = graph_->option(o).next) {
      graph_->fetch_option(graph_->option(o).next);
      if (blocked[PolygonGraph::triangle_of(o)]) continue;
      ways.for_ways(c, o,
                    [&](std::uint32_t way, std::uint32_t left, std::uint32_t right) { visit(o, way, left, right); });
    }
  }

  template <class Ways>
  void solve(const Rule& rule, const Ways& ways, std::uint32_t c, const std::vector<std::uint8_t>& blocked) {
    // Made in its place: what is put together elsewhere would be copied before its parts have arrived there.
    const std::uint32_t place = cells_.add(rule, ways.edge_of(c));
    auto&& cell = cells_.at(place);
    for_options(ways, c, blocked, [&](std::uint32_t o, std::uint32_t way, std::uint32_t left, std::uint32_t right) {
      // A child still being solved would close a cycle around a component that no tie reaches.
      if (place_[left] >= kEntered || place_[right] >= kEntered) return;
      if constexpr (Ways::kMany)
        rule.improve(cell, o, cells_.at(place_[left]), cells_.at(place_[right]), way);
      else
        rule.improve(cell, o, cells_.at(place_[left]), cells_.at(place_[right]));
    });
    place_[c] = place;
  }

  const PolygonGraph* graph_ = nullptr;
  std::uint32_t root_ = 0;
  std::uint32_t end_ = 0;             // the place of the cell that all ends share
  std::vector<std::uint32_t> place_;  // [cells] of those that are solved
  typename Rule::Cells cells_;
  std::vector<std::uint32_t> stack_;
  std::vector<std::pair<std::uint32_t, int>> trail_;
};

}  // namespace hydrotin
