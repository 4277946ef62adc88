#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "min_heap.h"

namespace hydrotin {

/// Theorem 6.2: the cheapest way to let a pit at `level` drain by lowering, found by a search for shortest paths in
/// which it costs to enter a vertex what it costs to lower it to `level`.
///
/// Among paths of equal cost the shortest is taken, then the one whose vertices come first in the order of the ground,
/// seen from its end: the answer does not depend on any numbering.
///
/// Ground provides
///   neighbors(v)
///       range of vertices
///   cost(v, level)
///       of lowering v to level, 0 if it is not higher; negative if it must not be lowered so far
///   is_goal(v, level)
///       whether water that has come to v drains on its own
///   is_exit(v, level)
///       whether it leaves from v
///   before(v, w)
///       the order that breaks ties
class BreachSearch {
 public:
  explicit BreachSearch(std::size_t num_vertices) : place_(num_vertices, 0) {}

  /// Finds the way from any of `sources`, all at `level`; false if there is none, or if more than `max_visits` vertices
  /// cost less to reach than the goal. (Which vertices these are does not depend on the order of visits.)
  template <class Ground>
  bool run(const Ground& ground, std::span<const std::uint32_t> sources, std::int32_t level,
           std::uint64_t max_visits = ~std::uint64_t{0}) {
    start();
    std::uint64_t num_visits = 0;
    std::int64_t limit_cost = -1;  // of the last vertex that may be visited
    for (const std::uint32_t v : sources) {
      add(v, {0, 0, kSource, false});
      push({0, 0, v, 0});
    }
    bool is_found = false;
    Entry best{};
    while (!heap_.empty()) {
      const Entry entry = pop();
      if (is_found && std::tie(entry.cost, entry.hops) != std::tie(best.cost, best.hops)) break;
      Label& label = label_[place_[entry.v]];
      if (entry.leaves == 0 && label.is_settled) continue;
      if (limit_cost >= 0 && entry.cost > limit_cost) {
        is_unfinished_ = true;
        return false;
      }
      if (++num_visits == max_visits) limit_cost = entry.cost;
      if (entry.leaves != 0 || (label.parent != kSource && ground.is_goal(entry.v, level))) {
        if (!is_found || ground.before(entry.v, best.v)) best = entry;
        is_found = true;
        if (entry.leaves == 0) label.is_settled = true;
        continue;
      }
      if (!is_found) settle(ground, entry, level);
    }
    if (is_found) trace(best);
    return is_found;
  }

  /// After a successful run: from the source to the goal, or to the vertex from which water leaves.
  [[nodiscard]] std::span<const std::uint32_t> path() const { return path_; }
  [[nodiscard]] bool leaves() const { return leaves_; }
  [[nodiscard]] std::int64_t cost() const { return cost_; }
  /// After a run without success: whether `max_visits` ended it.
  [[nodiscard]] bool is_unfinished() const { return is_unfinished_; }
  /// All vertices that were reached, in order of discovery.
  [[nodiscard]] std::span<const std::uint32_t> touched() const { return touched_; }
  /// Of a vertex that was reached: whether its way is the cheapest, and no more costly than visits allow.
  [[nodiscard]] bool is_settled(std::uint32_t v) const { return label_[place_[v]].is_settled; }
  /// Cost of the cheapest way to a vertex so far, itself included.
  [[nodiscard]] std::int64_t cost_to(std::uint32_t v) const { return label_[place_[v]].cost; }
  [[nodiscard]] std::uint32_t hops_to(std::uint32_t v) const { return label_[place_[v]].hops; }
  /// Takes the cheapest way to a vertex that is settled for the path.
  void end_at(std::uint32_t v) {
    path_.clear();
    trace({cost_to(v), hops_to(v), v, 0});
  }

 private:
  static constexpr std::uint32_t kSource = 0xffffffffu;
  struct Label {
    std::int64_t cost = 0;
    std::uint32_t hops = 0, parent = kSource;
    bool is_settled = false;
  };
  struct Entry {
    std::int64_t cost;
    std::uint32_t hops, v, leaves;
  };
  __extension__ using Key = unsigned __int128;  // cost, hops, vertex, leaves: 63, 32, 32 and 1 bit

  void start() {
    heap_.clear();
    touched_.clear();
    label_.clear();
    path_.clear();
    limit_ = -1;
    is_unfinished_ = false;
  }
  [[nodiscard]] bool is_reached(std::uint32_t v) const {
    return place_[v] < touched_.size() && touched_[place_[v]] == v;
  }
  void add(std::uint32_t v, const Label& label) {
    place_[v] = static_cast<std::uint32_t>(touched_.size());
    touched_.push_back(v);
    label_.push_back(label);
  }
  void push(const Entry& entry) {
    heap_.push(Key{static_cast<std::uint64_t>(entry.cost)} << 65 | Key{entry.hops} << 33 | Key{entry.v} << 1 |
               entry.leaves);
  }
  Entry pop() {
    const Key key = heap_.pop();
    return {static_cast<std::int64_t>(static_cast<std::uint64_t>(key >> 65)), static_cast<std::uint32_t>(key >> 33),
            static_cast<std::uint32_t>(key >> 1), static_cast<std::uint32_t>(key & 1)};
  }

  template <class Ground>
  void settle(const Ground& ground, const Entry& entry, std::int32_t level) {
    const std::uint32_t v = entry.v;
    label_[place_[v]].is_settled = true;
    if (ground.is_exit(v, level)) {
      push({entry.cost, entry.hops + 1, v, 1});
      limit_ = entry.cost;
    }
    for (const std::uint32_t w : ground.neighbors(v)) {
      const bool was_reached = is_reached(w);
      if (was_reached && label_[place_[w]].is_settled) continue;
      const std::int64_t step = ground.cost(w, level);
      if (step < 0) continue;
      const std::int64_t cost = entry.cost + step;
      if (limit_ >= 0 && cost > limit_) continue;  // a way of this cost is known
      const std::uint32_t hops = entry.hops + 1;
      if (was_reached) {
        Label& label = label_[place_[w]];
        if (std::tie(cost, hops) > std::tie(label.cost, label.hops)) continue;
        if (cost == label.cost && hops == label.hops) {
          if (ground.before(v, label.parent)) label.parent = v;
          continue;
        }
        label = {cost, hops, v, false};
      } else {
        add(w, {cost, hops, v, false});
      }
      push({cost, hops, w, 0});
      if (step == 0 && ground.is_goal(w, level)) limit_ = cost;
    }
  }

  void trace(const Entry& end) {
    cost_ = end.cost;
    leaves_ = end.leaves != 0;
    for (std::uint32_t v = end.v; v != kSource; v = label_[place_[v]].parent) path_.push_back(v);
    std::reverse(path_.begin(), path_.end());
  }

  // Labels lie in the order of discovery, so that a short search stays in the cache. A place says where the label of a
  // vertex would be: it is there if `touched_` says so, so that places need not be cleared.
  std::vector<std::uint32_t> place_;  // [n]
  std::vector<Label> label_;          // [touched]
  BasicMinHeap<Key> heap_;
  std::vector<std::uint32_t> touched_, path_;
  std::int64_t limit_ = -1, cost_ = 0;
  bool leaves_ = false, is_unfinished_ = false;
};

}  // namespace hydrotin
