#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "polygon_costs.h"
#include "polygon_program.h"

/// The rule for sums over triangles and for local minima (T3.1, T3.2.2).
///
/// With `States` = 4 vertices can be served: state bit 0: the origin of the edge has to get a lower neighbour strictly
/// inside; bit 1: its target has to. Equal values: the apex that comes first in (x, y), then the first way.

namespace hydrotin {

/// @tparam Scalar  int64 if all values are small, else Wide
/// With one slot and four states all values are in one number: served vertices (own, adopted), then foreign sides.
template <class Scalar, int Slots, int States>
struct SumRule {
  static constexpr std::uint32_t kImpossible = kNoEdge - 1;
  static constexpr bool kPacked = Slots == 1 && States == 4;
  static constexpr std::uint32_t kMostPacked = 1U << 19;  ///< triangles of a polygon, so that no part runs over
  /// What a served vertex is worth, by wants_lower.
  static constexpr std::array<Scalar, 3> kGain =
      kPacked ? std::array<Scalar, 3>{0, Scalar{1} << 22, Scalar{1} << 42}
              : std::array<Scalar, 3>{0, Scalar{1}, Scalar{PolygonCosts::kGain[2]}};
  using Value = std::array<Scalar, Slots>;
  struct Entry {
    Value value{};
    std::uint32_t option = kImpossible;  ///< kNoEdge: nothing to triangulate
    std::array<std::uint8_t, 2> child_state{};
    std::uint16_t way = 0;  ///< of the children

    [[nodiscard]] bool possible() const { return option != kImpossible; }
  };
  using Cell = std::array<Entry, States>;

  const PolygonProblem& problem;
  const PolygonGraph& graph;
  const PolygonCosts& costs;
  std::span<const std::uint8_t> wishes;  ///< [n] as `wants_lower`
  int gain_slot = 0;

  [[nodiscard]] static Cell empty() { return {}; }
  [[nodiscard]] static Cell boundary(std::uint32_t) {
    Cell cell{};
    cell[0].option = kNoEdge;
    return cell;
  }

  void improve(Cell& cell, std::uint32_t o, const Cell& left, const Cell& right, std::uint32_t way = 0) const {
    if constexpr (States == 1) {
      offer(cell[0], o, left[0], right[0], 0, {0, 0}, way);
    } else {
      improve_states(cell, o, left, right, way);
    }
  }

  [[nodiscard]] int best_state(const Cell& cell) const { return best_of(cell).first; }

  /// The value of the whole answer. Where a vertex stands on the boundary twice, it may be counted twice: then the
  /// answer is worth less.
  [[nodiscard]] SlotValues best_value(const Cell& root) const {
    const Value value = best_of(root).second;
    SlotValues out{};
    if constexpr (kPacked) {
      const std::int64_t foreign = value[0] & (kGain[1] - 1), served = (foreign - value[0]) / kGain[1];
      const std::int64_t own = served / (kGain[2] / kGain[1]), adopted = served % (kGain[2] / kGain[1]);
      out[0] = -(own * PolygonCosts::kGain[2] + adopted * PolygonCosts::kGain[1]);
      out[1] = foreign;
    } else {
      std::copy(value.begin(), value.end(), out.begin());
    }
    return out;
  }

  /// Whether the apex of an option is counted as served in this entry.
  [[nodiscard]] bool counts_apex(std::uint32_t o, const Entry& entry) const {
    const Option& option = graph.option(o);
    if (!wishes[option.apex]) return false;
    return serves_apex(option) || (entry.child_state[0] & 2U) || (entry.child_state[1] & 1U);
  }

  /// The ends of the root that are counted as served in the answer of the whole polygon.
  [[nodiscard]] std::vector<std::uint32_t> counted_ends(const Cell& root) const {
    const int state = best_state(root);
    const PolygonEdge& edge = graph.edge(graph.root());
    std::vector<std::uint32_t> out;
    if ((state & 1) && wishes[edge.origin]) out.push_back(edge.origin);
    if ((state & 2) && wishes[edge.target]) out.push_back(edge.target);
    return out;
  }

 private:
  [[nodiscard]] std::pair<int, Value> best_of(const Cell& cell) const {
    int best = -1;
    Value best_value{};
    for (int state = 0; state < States; ++state) {
      const Entry& entry = cell[static_cast<std::size_t>(state)];
      if (!entry.possible()) continue;
      Value value = entry.value;
      if constexpr (States == 4) {
        const PolygonEdge& root = graph.edge(graph.root());
        if (state & 1) value[slot()] -= kGain[wishes[root.origin]];
        if (state & 2) value[slot()] -= kGain[wishes[root.target]];
      }
      if (best >= 0 && !(value < best_value)) continue;
      best = state;
      best_value = value;
    }
    return {best, best_value};
  }

  [[nodiscard]] std::size_t slot() const { return static_cast<std::size_t>(gain_slot); }

  [[nodiscard]] bool serves_apex(const Option& option) const {
    const PolygonEdge& el = graph.edge(option.left_child);   // i -> q
    const PolygonEdge& er = graph.edge(option.right_child);  // q -> j
    return (!el.is_boundary && !el.goes_down) || (!er.is_boundary && er.goes_down);
  }

  void improve_states(Cell& cell, std::uint32_t o, const Cell& left, const Cell& right, std::uint32_t way) const {
    const Option& option = graph.option(o);
    const PolygonEdge& el = graph.edge(option.left_child);   // i -> q
    const PolygonEdge& er = graph.edge(option.right_child);  // q -> j
    // Of states in which an end has to get what it does not wish for nobody asks.
    const unsigned asked = (el.wishes & PolygonEdge::kOriginWishes) | (er.wishes & PolygonEdge::kTargetWishes);
    const bool inner_l = !el.is_boundary, inner_r = !er.is_boundary;
    const bool i_served = inner_l && el.goes_down, j_served = inner_r && !er.goes_down;
    const bool q_served = serves_apex(option);
    const bool q_wishes = el.wishes & PolygonEdge::kTargetWishes;
    const Scalar q_gain = q_wishes ? kGain[wishes[option.apex]] : Scalar{0};
    for (unsigned state = 0; state < 4; ++state) {
      if (state & ~asked) continue;
      const unsigned need_i = (state & 1U) && !i_served, need_j = (state & 2U) && !j_served;
      const auto offer_states = [&](unsigned q_left, unsigned q_right, Scalar served) {
        const unsigned sl = need_i | q_left << 1U, sr = q_right | need_j << 1U;
        offer(cell[state], o, left[sl], right[sr], served,
              {static_cast<std::uint8_t>(sl), static_cast<std::uint8_t>(sr)}, way);
      };
      offer_states(0, 0, q_served ? q_gain : Scalar{0});
      if (q_wishes && !q_served) {
        offer_states(1, 0, q_gain);
        offer_states(0, 1, q_gain);
      }
    }
  }

  [[nodiscard]] Scalar cost(std::uint32_t triangle, std::size_t s) const {
    if constexpr (kPacked) return graph.foreign_sides(triangle);
    if (static_cast<int>(s) < costs.num_slots) return static_cast<Scalar>(costs.of(triangle, static_cast<int>(s)));
    return 0;
  }

  void offer(Entry& entry, std::uint32_t o, const Entry& left, const Entry& right, Scalar served,
             std::array<std::uint8_t, 2> child_state, std::uint32_t way) const {
    if (!left.possible() || !right.possible()) return;
    const Option& option = graph.option(o);
    Value value;
    for (std::size_t s = 0; s < Slots; ++s) value[s] = left.value[s] + right.value[s] + cost(option.triangle, s);
    if constexpr (States == 4) value[slot()] -= served;
    if (entry.possible()) {
      if (entry.value < value) return;
      if (entry.value == value &&
          (entry.option == o || !(problem.position[option.apex] < problem.position[graph.option(entry.option).apex])))
        return;
    }
    // One by one: a whole made on the stack would be copied before its parts have arrived there.
    entry.value = value;
    entry.option = o;
    entry.child_state = child_state;
    entry.way = static_cast<std::uint16_t>(way);
  }
};

}  // namespace hydrotin
