#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "component_ties.h"

/// The ways to tie the components of a polygon, edge by edge.
///
/// A *chain* of a component is a path of ties from it to the outer boundary; ties lead to later vertices of the sweep,
/// so there is no way back. What an edge cuts off on its left is bounded by the edge, the chains of the components that
/// its ends lie on (none: an end on the outer boundary), and the outer boundary; the components within hang nowhere and
/// may be tied in any way. So a dynamic program needs one cell for each edge and choice of chains at its ends, and
/// chooses a chain where a triangle reaches a component first: ways of different components add up, where in T3.3 they
/// multiply.
///
/// Why  Every triangulation contains a tie of every component (Lemma 3.1), hence a chain of each; along its triangles
///      the program meets these chains. Conversely, what the program puts together covers the polygon, since a triangle
///      that a chain of its corners cuts is not used.

namespace hydrotin {

/// `Ways` of a PolygonProgram: a way of an option is the chain of its apex.
class TieWays {
 public:
  static constexpr bool kMany = true;
  static constexpr std::uint32_t kMostWays = 0xFFFF;  ///< entries of a program hold them in 16 bits
  static constexpr std::uint64_t kMostVisits = 1U << 28;

  /// False if a component has more than `most_ways` chains (at most kMostWays), or a program would look at more than
  /// `most_visits` triangles with their chains: then nothing else may be called. O(T + C + visits).
  bool build(const PolygonProblem& problem, const PolygonGraph& graph, const ComponentTies& ties,
             std::uint64_t most_ways, std::uint64_t most_visits);

  /// At most as many triangles with their chains a program looks at.
  [[nodiscard]] std::uint64_t num_visits() const { return visits_; }

  [[nodiscard]] std::uint32_t num_cells() const { return num_edges_ + static_cast<std::uint32_t>(place_.size()); }
  /// The cell of an edge between places on the outer boundary.
  [[nodiscard]] std::uint32_t chord(std::uint32_t e) const { return cell(e, 0, 0); }
  [[nodiscard]] std::uint32_t edge_of(std::uint32_t c) const { return is_plain(c) ? c : place_[c - num_edges_].edge; }
  [[nodiscard]] bool is_end(std::uint32_t c) const {
    return is_plain(c) ? graph_->edge(c).is_boundary : kind_[c - num_edges_] == Kind::end;
  }

  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> children(std::uint32_t c, std::uint32_t o,
                                                                 std::uint32_t way) const {
    const Option& option = graph_->option(o);
    if (!touches_[PolygonGraph::triangle_of(o)]) return {option.left_child, option.right_child};
    return children_at_components(c, option, way);
  }

  template <class Visit>
  void for_ways(std::uint32_t c, std::uint32_t o, Visit visit) const {
    const Option& option = graph_->option(o);
    if (!touches_[PolygonGraph::triangle_of(o)]) return visit(0U, option.left_child, option.right_child);
    for_ways_at_components(c, o, option, visit);
  }

 private:
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> children_at_components(std::uint32_t c, const Option& option,
                                                                               std::uint32_t way) const {
    return {cell(option.left_child, at_origin(c), way), cell(option.right_child, way, at_target(c))};
  }

  enum class Kind : std::uint8_t { open, end, unfit };  ///< unfit: the chains of its ends exclude each other
  struct Chain {
    std::uint32_t tie, rest;  ///< the first tie, and the chain where it ends, or kNoEdge on the outer boundary
  };

  template <class Visit>
  void for_ways_at_components(std::uint32_t c, std::uint32_t o, const Option& option, Visit visit) const {
    const std::uint32_t t = PolygonGraph::triangle_of(o), side = o - PolygonGraph::option_on(t, 0);
    if (is_cut(t, side, at_origin(c)) || is_cut(t, (side + 1) % 3, at_target(c))) return;
    const std::uint32_t count = num_chains(option.apex);
    for (std::uint32_t way = 0; way < count; ++way) {
      const auto [left, right] = children_at_components(c, option, way);
      if (!is_unfit(left) && !is_unfit(right) && !is_cut(t, (side + 2) % 3, way)) visit(way, left, right);
    }
  }

  /// Where a cell is: its edge, and the chains that its ends have.
  struct Place {
    std::uint32_t edge;
    std::uint16_t at_origin, at_target;
  };

  /// On the outer boundary there is one, number 0.
  [[nodiscard]] std::uint32_t num_chains(std::uint32_t v) const {
    const std::uint32_t c = component_[v];
    return c == kNoEdge ? 1 : chain_begin_[c + 1] - chain_begin_[c];
  }
  [[nodiscard]] std::uint32_t cell(std::uint32_t e, std::uint32_t at_origin, std::uint32_t at_target) const {
    if (!is_tied(graph_->edge(e).origin, graph_->edge(e).target)) return e;
    return first_cell_[e] + at_origin * num_chains(graph_->edge(e).target) + at_target;
  }
  /// Whether one of two vertices is on a component.
  [[nodiscard]] bool is_tied(std::uint32_t a, std::uint32_t b) const {
    return (component_[a] & component_[b]) != kNoEdge;
  }
  /// Whether it is the only cell of an edge, which has its number.
  [[nodiscard]] bool is_plain(std::uint32_t c) const { return c < num_edges_; }
  [[nodiscard]] std::uint32_t at_origin(std::uint32_t c) const {
    return is_plain(c) ? 0 : place_[c - num_edges_].at_origin;
  }
  [[nodiscard]] std::uint32_t at_target(std::uint32_t c) const {
    return is_plain(c) ? 0 : place_[c - num_edges_].at_target;
  }
  [[nodiscard]] bool is_unfit(std::uint32_t c) const { return !is_plain(c) && kind_[c - num_edges_] == Kind::unfit; }
  /// Whether a chain of its corner cuts a triangle. Precondition: the triangle touches a component.
  [[nodiscard]] bool is_cut(std::uint32_t t, std::uint32_t corner, std::uint32_t number) const {
    const std::uint32_t begin = cut_begin_[3 * std::size_t{t} + corner];
    return begin != kNoEdge && cut_[begin + number];
  }

  bool list_chains(const PolygonGraph& graph, const ComponentTies& ties, std::uint64_t most);
  bool make_cuts(std::uint64_t most_visits);
  bool make_cells(std::uint64_t most_visits);
  void mark_cuts(const ComponentTies& ties);
  void mark_cells(const PolygonProblem& problem, const ComponentTies& ties);
  [[nodiscard]] Kind kind_of(std::uint32_t c, const PolygonProblem& problem, const ComponentTies& ties) const;
  [[nodiscard]] bool fit(std::uint32_t chain, std::uint32_t other, const PolygonProblem& problem,
                         const ComponentTies& ties) const;

  const PolygonGraph* graph_ = nullptr;
  std::vector<std::uint32_t> component_;    ///< [n] of the vertices
  std::vector<std::uint32_t> chain_begin_;  ///< [components + 1]
  std::vector<Chain> chain_;
  std::vector<std::uint8_t> touches_;  ///< [triangles] a component
  // Edges between places on the outer boundary have a cell each, with their own numbers; then come those of the others.
  std::uint32_t num_edges_ = 0;
  std::vector<std::uint32_t> first_cell_;  ///< [edges] of those with an end on a component
  std::vector<Place> place_;               ///< [cells beyond these]
  std::vector<Kind> kind_;                 ///< [cells beyond these]
  std::vector<std::uint32_t> cut_begin_;   ///< [3 triangles] by corner, if they touch; kNoEdge: on the outer boundary
  std::vector<bool> cut_;                  ///< by corner of a triangle, then chain of its component
  std::uint64_t visits_ = 0;
};

}  // namespace hydrotin
