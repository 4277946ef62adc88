#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "height_key.h"
#include "hydrotin/lifting.h"
#include "hydrotin/vertex_graph.h"
#include "min_heap.h"
#include "sifted.h"

namespace hydrotin {

/// A visitor of a flood of which only the levels are wanted.
struct NoVisitor {
  static void reach(std::uint32_t, std::uint32_t) {}
  static void meet(std::uint32_t, std::uint32_t) {}
  [[nodiscard]] static bool parts(std::uint32_t, std::uint32_t) { return false; }
};

/// A flood of a terrain from sources: the level of each v is the minimum over sources s and paths from s to v, through
/// no other source, of max(level(s), heights on the path after s).
///
/// A neighbour w of a reached v with h(w) >= level(v) has level h(w), whatever else happens: levels are never below
/// heights. So climbing needs no order, and only what lies below the current levels has to wait for the lowest way in.
/// Three work lists: `climb_`, reached vertices above the water, in order of arrival; `pool_`, vertices at the level of
/// the water; `rim_`, a heap of vertices with an unreached lower neighbour, by level. When climbing is exhausted and
/// the lowest rim, at level L, is taken, every vertex that could lead into the lower region behind it has level L at
/// least: the region up to its own shores is a pool of level L. Candidates for the heap are checked again after the
/// climb, because most of them have been reached from elsewhere by then.
///
/// Graph provides neighbors(v), and the offsets of their lists in `begin`.
template <class Graph>
class Flood {
 public:
  /// @param level  [n] in: heights; out: levels, kNoLevel where no source leads.
  Flood(const Graph& graph, std::span<std::int32_t> level)
      : graph_(&graph), level_(level), reached_(level.size() / 64 + 1, 0) {}

  void add_source(std::uint32_t v, std::int32_t level) {
    level_[v] = level;
    set_reached(v);
    climb_.push_back(v);
  }

  /// Water that stands at `level` outside comes in at v, which is lower and no source.
  void add_inlet(std::uint32_t v, std::int32_t level) { rim_.push(height_key(level, v)); }

  /// Tells a visitor what it finds:
  ///   reach(v, w)    w, no source, is reached from its neighbour v: once for each
  ///   parts(v, w)    whether it wants to hear of another edge between vertices that are reached, and then
  ///   meet(v, w)     such an edge, at least once, in one direction or the other
  template <class Visitor>
  void run(Visitor&& visitor) {
    climb(visitor);
    while (!rim_.empty()) {
      const std::uint64_t lowest = rim_.pop();
      const auto v = static_cast<std::uint32_t>(lowest);
      if (!is_reached(v)) {  // an inlet
        set_reached(v);
        level_[v] = unbiased(static_cast<std::uint32_t>(lowest >> 32));
      }
      if (!rim_.empty()) __builtin_prefetch(&graph_->begin[static_cast<std::uint32_t>(rim_.top())]);
      pool_.push_back(v);
      fill(level_[v], visitor);
      climb(visitor);
    }
    for (std::uint32_t v = 0; v < level_.size(); ++v)
      if (!is_reached(v)) level_[v] = kNoLevel;
  }

 private:
  [[nodiscard]] bool is_reached(std::uint32_t v) const { return (reached_[v >> 6] >> (v & 63)) & 1; }
  void set_reached(std::uint32_t v) { reached_[v >> 6] |= std::uint64_t{1} << (v & 63); }

  // A vertex is looked at here or in `fill` after it was reached: the later one of two neighbours finds the other.
  template <class Visitor>
  void climb(Visitor& visitor) {
    for (std::size_t next = 0; next < climb_.size(); ++next) {
      const std::uint32_t v = climb_[next];
      const std::span<const std::uint32_t> around = graph_->neighbors(v);
      bool may_overflow = false;
      for (std::size_t i = 0; i < around.size(); i += kSiftedAtOnce)
        may_overflow |= climb_from(v, around.subspan(i, std::min(kSiftedAtOnce, around.size() - i)), visitor);
      if (may_overflow) candidate_.push_back(v);
    }
    climb_.clear();
    for (const std::uint32_t v : candidate_) {
      for (const std::uint32_t w : graph_->neighbors(v)) {
        if (is_reached(w) || !is_lowest_way_into(w, v)) continue;
        rim_.push(height_key(level_[v], v));
        break;
      }
    }
    candidate_.clear();
  }

  // Without a branch for each neighbour, as in sifted.h. Returns whether one of them is lower and not reached yet.
  template <class Visitor>
  bool climb_from(std::uint32_t v, std::span<const std::uint32_t> around, Visitor& visitor) {
    std::array<std::uint32_t, kSiftedAtOnce> higher, met;
    std::size_t num_higher = 0, num_met = 0;
    bool may_overflow = false;
    const std::int32_t level = level_[v];
    for (const std::uint32_t w : around) {
      const bool is_new = !is_reached(w), is_lower = level_[w] < level;
      may_overflow |= is_new & is_lower;
      higher[num_higher] = met[num_met] = w;
      num_higher += is_new & !is_lower ? 1 : 0;
      num_met += !is_new & visitor.parts(v, w) ? 1 : 0;
    }
    for (std::size_t i = 0; i < num_met; ++i) visitor.meet(v, met[i]);
    for (std::size_t i = 0; i < num_higher; ++i) {
      const std::uint32_t w = higher[i];
      set_reached(w);
      visitor.reach(v, w);
      climb_.push_back(w);
    }
    return may_overflow;
  }

  [[nodiscard]] bool is_lowest_way_into(std::uint32_t w, std::uint32_t v) const {
    const std::uint64_t way = height_key(level_[v], v);
    for (const std::uint32_t u : graph_->neighbors(w))
      if (is_reached(u) && height_key(level_[u], u) < way) return false;
    return true;
  }

  template <class Visitor>
  void fill(std::int32_t level, Visitor& visitor) {
    while (!pool_.empty()) {
      const std::uint32_t v = pool_.back();
      pool_.pop_back();
      for (const std::uint32_t w : graph_->neighbors(v)) {
        if (is_reached(w)) {
          if (visitor.parts(v, w)) visitor.meet(v, w);
          continue;
        }
        set_reached(w);
        visitor.reach(v, w);
        if (level_[w] > level) {
          climb_.push_back(w);
        } else {
          level_[w] = level;
          pool_.push_back(w);
        }
      }
    }
  }

  const Graph* graph_;
  std::span<std::int32_t> level_;
  std::vector<std::uint64_t> reached_;  // a bit per vertex: stays in the cache where the levels do not
  std::vector<std::uint32_t> climb_, candidate_, pool_;
  MinHeap rim_;
};

}  // namespace hydrotin
