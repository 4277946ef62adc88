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

  /// The entries of each cell one after the other, by `index_of`: those of the states that its edge is asked for.
  class Cells {
   public:
    void clear(std::size_t about) {
      entry_.clear();
      entry_.reserve(about + about / 4);
    }
    std::uint32_t add(const SumRule& rule, std::uint32_t e) { return add(num_entries(rule.graph.edge(e).wishes)); }
    std::uint32_t add_end(const SumRule&) {
      const std::uint32_t place = add(States);
      entry_[place].option = kNoEdge;
      return place;
    }
    [[nodiscard]] Entry* at(std::uint32_t place) { return entry_.data() + place; }
    [[nodiscard]] const Entry* at(std::uint32_t place) const { return entry_.data() + place; }

   private:
    std::uint32_t add(std::size_t count) {
      const auto place = static_cast<std::uint32_t>(entry_.size());
      for (std::size_t i = 0; i < count; ++i) entry_.emplace_back();
      return place;
    }

    std::vector<Entry> entry_;
  };

  const PolygonProblem& problem;
  const PolygonGraph& graph;
  const PolygonCosts& costs;
  std::span<const std::uint8_t> wishes;  ///< [n] as `wants_lower`
  int gain_slot = 0;

  [[nodiscard]] const Entry& entry(const Entry* cell, std::uint32_t e, int state) const {
    return cell[index_of(graph.edge(e).wishes, static_cast<unsigned>(state))];
  }

  void improve(Entry* cell, std::uint32_t o, const Entry* left, const Entry* right, std::uint32_t way = 0) const {
    if constexpr (States == 1) {
      offer(cell[0], o, left[0], right[0], cost_of(o), {0, 0}, way);
    } else {
      improve_states(cell, o, left, right, way);
    }
  }

  [[nodiscard]] int best_state(const Entry* cell) const { return best_of(cell).first; }

  /// The value of the whole answer. Where a vertex stands on the boundary twice, it may be counted twice: then the
  /// answer is worth less.
  [[nodiscard]] SlotValues best_value(const Entry* root) const {
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
  [[nodiscard]] std::vector<std::uint32_t> counted_ends(const Entry* root) const {
    const int state = best_state(root);
    const PolygonEdge& edge = graph.edge(graph.root());
    std::vector<std::uint32_t> out;
    if ((state & 1) && wishes[edge.origin]) out.push_back(edge.origin);
    if ((state & 2) && wishes[edge.target]) out.push_back(edge.target);
    return out;
  }

 private:
  [[nodiscard]] std::pair<int, Value> best_of(const Entry* cell) const {
    int best = -1;
    Value best_value{};
    const std::uint8_t asked = graph.edge(graph.root()).wishes;
    for (int state = 0; state < States; ++state) {
      if (static_cast<unsigned>(state) & ~unsigned{asked}) continue;
      const Entry& way = entry(cell, graph.root(), state);
      if (!way.possible()) continue;
      Value value = way.value;
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

  // Of states in which an end has to get what it does not wish for nobody asks.
  static constexpr std::uint8_t kBothWish = PolygonEdge::kOriginWishes | PolygonEdge::kTargetWishes;
  [[nodiscard]] static constexpr std::size_t num_entries(std::uint8_t wishes) {
    return States == 1 ? 1 : wishes == kBothWish ? 4 : wishes != 0 ? 2 : 1;
  }
  [[nodiscard]] static constexpr std::size_t index_of(std::uint8_t wishes, unsigned state) {
    return wishes == kBothWish ? state : state != 0;
  }

  [[nodiscard]] std::size_t slot() const { return static_cast<std::size_t>(gain_slot); }

  [[nodiscard]] bool serves_apex(const Option& option) const {
    const PolygonEdge& el = graph.edge(option.left_child);   // i -> q
    const PolygonEdge& er = graph.edge(option.right_child);  // q -> j
    return (!el.is_boundary && !el.goes_down) || (!er.is_boundary && er.goes_down);
  }

  void improve_states(Entry* cell, std::uint32_t o, const Entry* left, const Entry* right, std::uint32_t way) const {
    const Option& option = graph.option(o);
    const PolygonEdge& el = graph.edge(option.left_child);   // i -> q
    const PolygonEdge& er = graph.edge(option.right_child);  // q -> j
    const Value own = cost_of(o);
    if ((el.wishes | er.wishes) == 0) return offer(cell[0], o, left[0], right[0], own, {0, 0}, way);
    const bool q_wishes = el.wishes & PolygonEdge::kTargetWishes, q_served = q_wishes && serves_apex(option);
    Value with_q = own;
    if (q_wishes) with_q[slot()] -= kGain[wishes[option.apex]];
    const std::uint8_t asked = (el.wishes & PolygonEdge::kOriginWishes) | (er.wishes & PolygonEdge::kTargetWishes);
    const auto offer_states = [&](unsigned state, unsigned need_i, unsigned need_j) {
      const auto offer_q = [&](unsigned q_left, unsigned q_right, const Value& value) {
        const unsigned sl = need_i | q_left << 1U, sr = q_right | need_j << 1U;
        offer(cell[index_of(asked, state)], o, left[index_of(el.wishes, sl)], right[index_of(er.wishes, sr)], value,
              {static_cast<std::uint8_t>(sl), static_cast<std::uint8_t>(sr)}, way);
      };
      offer_q(0, 0, q_served ? with_q : own);
      if (q_wishes && !q_served) {
        offer_q(1, 0, with_q);
        offer_q(0, 1, with_q);
      }
    };
    offer_states(0, 0, 0);
    if (asked == 0) return;
    const bool i_served = !el.is_boundary && el.goes_down, j_served = !er.is_boundary && !er.goes_down;
    for (unsigned state = 1; state < 4; ++state)
      if ((state & ~unsigned{asked}) == 0) offer_states(state, (state & 1U) && !i_served, (state & 2U) && !j_served);
  }

  [[nodiscard]] bool is_better(const Value& value, std::uint32_t o, const Entry& entry) const {
    // One number is compared as such: arrays would be compared byte by byte.
    if constexpr (Slots == 1) {
      if (value[0] != entry.value[0]) return value[0] < entry.value[0];
    } else {
      if (value != entry.value) return value < entry.value;
    }
    const auto at = [&](std::uint32_t option) { return problem.position[graph.option(option).apex]; };
    return entry.option != o && at(o) < at(entry.option);
  }

  [[nodiscard]] Value cost_of(std::uint32_t o) const {
    const std::uint32_t t = PolygonGraph::triangle_of(o);
    Value value{};
    if constexpr (kPacked)
      value[0] = graph.foreign_sides(t);
    else
      for (int s = 0; s < std::min(Slots, costs.num_slots); ++s)
        value[static_cast<std::size_t>(s)] = static_cast<Scalar>(costs.of(t, s));
    return value;
  }

  // A way with the given children, where the triangle and what it serves are worth `own`.
  void offer(Entry& entry, std::uint32_t o, const Entry& left, const Entry& right, const Value& own,
             std::array<std::uint8_t, 2> child_state, std::uint32_t way) const {
    if (!left.possible() || !right.possible()) return;
    Value value;
    for (std::size_t s = 0; s < Slots; ++s) value[s] = left.value[s] + right.value[s] + own[s];
    if (entry.possible() && !is_better(value, o, entry)) return;
    // One by one: a whole made on the stack would be copied before its parts have arrived there.
    entry.value = value;
    entry.option = o;
    entry.child_state = child_state;
    entry.way = static_cast<std::uint16_t>(way);
  }
};

}  // namespace hydrotin
