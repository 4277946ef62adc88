#include "hydrotin/greedy_breach.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <tuple>
#include <utility>

#include "hydrotin/least_change.h"
#include "hydrotin/wide.h"
#include "local_pits.h"

namespace hydrotin {
namespace {

constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max() / 8;
constexpr std::uint32_t kNone = 0xffffffffu;

/// Shortest paths by lowering to one level. `to[v]`: from the sources to v, lowering v included; `before[v]`: not
/// included.
struct Distances {
  std::vector<std::int64_t> to, before;
  std::vector<std::uint32_t> parent;  // the last vertex before v on the way from the sources; kNone: v is one

  explicit Distances(std::uint32_t k) : to(k, kFar), before(k, kFar), parent(k, kNone) {}
  void add_source(std::uint32_t v, std::int64_t cost) {
    to[v] = std::min(to[v], cost);
    before[v] = 0;
  }

  void spread(const ProblemGround& ground, std::int32_t level) {
    using Entry = std::pair<std::int64_t, std::uint32_t>;
    std::vector<Entry> heap;
    for (std::uint32_t v = 0; v < to.size(); ++v)
      if (to[v] < kFar) heap.emplace_back(to[v], v);
    std::make_heap(heap.begin(), heap.end(), std::greater<>{});
    while (!heap.empty()) {
      std::pop_heap(heap.begin(), heap.end(), std::greater<>{});
      const auto [cost, v] = heap.back();
      heap.pop_back();
      if (cost != to[v]) continue;
      for (const std::uint32_t w : ground.neighbors(v)) {
        const std::int64_t step = ground.cost(w, level);
        if (step < 0 || cost >= before[w]) continue;
        before[w] = cost;
        parent[w] = v;
        to[w] = cost + step;
        heap.emplace_back(to[w], w);
        std::push_heap(heap.begin(), heap.end(), std::greater<>{});
      }
    }
  }
};

/// A group of pits that come together at a center.
struct Group {
  std::uint32_t payer = kNone, center = kNone;
  std::int64_t cost = 0;
  std::int64_t num_members = 0;
  [[nodiscard]] bool beats(const Group& other) const {
    if (other.payer == kNone) return true;
    const Wide own = Wide{cost} * other.num_members, its = Wide{other.cost} * num_members;
    return own != its ? own < its : num_members > other.num_members;
  }
};

class Round {
  using Others = std::vector<std::pair<std::int64_t, std::uint32_t>>;

 public:
  Round(const DrainageProblem& problem, std::vector<std::int32_t>& surface, const LocalPits& pits,
        ChangeMeasure measure, std::int32_t max_depth)
      : problem_(&problem), surface_(&surface), pits_(&pits), ground_{&problem, &surface, measure, max_depth} {
    order_.resize(pits.pit.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tie(pits.pit[a].height, pits.pit[a].first) < std::tie(pits.pit[b].height, pits.pit[b].first);
    });
    for (std::uint32_t i = 0; i < order_.size(); ++i) {
      Distances& from = from_.emplace_back(problem.size());
      for (const std::uint32_t v : pits.vertices(pits.pit[order_[i]])) from.add_source(v, 0);
      from.spread(ground_, level(i));
      Distances& down = down_.emplace_back(problem.size());
      add_goals(down, i);
      down.spread(ground_, level(i));
    }
  }

  /// Breaches the best group; false if no pit can be breached.
  bool run() {
    Group best;
    Others others;
    for (std::uint32_t c = 0; c < problem_->size(); ++c)
      for (std::uint32_t payer = 0; payer < order_.size(); ++payer) {
        if (from_[payer].to[c] >= kFar || down_[payer].before[c] >= kFar) continue;
        Group group{payer, c, from_[payer].to[c] + down_[payer].before[c], 2};
        if (group.beats(best)) best = group;
        sort_others(payer, c, others);
        for (const auto& [cost, i] : others) {
          group.cost += cost;
          ++group.num_members;
          if (group.beats(best)) best = group;
        }
      }
    if (best.payer == kNone) return false;
    breach(best);
    return true;
  }

 private:
  [[nodiscard]] std::int32_t level(std::size_t i) const { return pits_->pit[order_[i]].height; }

  // The pits above the payer that can come to c, nearest first.
  void sort_others(std::uint32_t payer, std::uint32_t c, Others& others) const {
    others.clear();
    for (std::uint32_t i = payer + 1; i < order_.size(); ++i)
      if (from_[i].before[c] < kFar) others.emplace_back(from_[i].before[c], i);
    std::sort(others.begin(), others.end());
  }

  // What pit i can drain to: vertices below it, the outside next to members with an exit at its level or below (which
  // have to be lowered themselves), pits of its height before it.
  void add_goals(Distances& down, std::uint32_t i) const {
    for (std::uint32_t v = 0; v < problem_->size(); ++v) {
      if (ground_.is_goal(v, level(i)))
        down.add_source(v, 0);
      else if (const std::int64_t step = ground_.cost(v, level(i)); step >= 0 && ground_.is_exit(v, level(i)))
        down.add_source(v, step);
    }
    for (std::uint32_t j = 0; j < i; ++j)
      if (level(j) == level(i))
        for (const std::uint32_t v : pits_->vertices(pits_->pit[order_[j]])) down.add_source(v, 0);
  }

  // Lowers the way from the sources to c without c.
  void lower_way(const Distances& way, std::uint32_t c, std::int32_t to) {
    for (std::uint32_t v = way.parent[c]; v != kNone; v = way.parent[v]) lower(v, to);
  }
  void lower(std::uint32_t v, std::int32_t to) { (*surface_)[v] = std::min((*surface_)[v], to); }

  void breach(const Group& group) {
    Others others;
    sort_others(group.payer, group.center, others);
    const std::int32_t low = level(group.payer);
    lower_way(from_[group.payer], group.center, low);
    lower_way(down_[group.payer], group.center, low);
    for (std::size_t i = 0; i + 2 < static_cast<std::size_t>(group.num_members); ++i)
      lower_way(from_[others[i].second], group.center, level(others[i].second));
    lower(group.center, low);
  }

  const DrainageProblem* problem_;
  std::vector<std::int32_t>* surface_;
  const LocalPits* pits_;
  ProblemGround ground_;
  std::vector<std::uint32_t> order_;  // pits ascending by (height, x, y)
  std::vector<Distances> from_, down_;
};

}  // namespace

GreedyBreach greedy_breach(const DrainageProblem& problem, ChangeMeasure measure, std::int32_t max_depth) {
  GreedyBreach result;
  result.surface = problem.height;
  for (bool is_first = true;; is_first = false) {
    const std::vector<std::int32_t> level = lift(problem, result.surface);
    const LocalPits pits = find_local_pits(problem, result.surface, level);
    const std::uint64_t m = pits.pit.size() + 1;
    if (is_first) {
      result.num_pits = pits.pit.size();
      if (m * m > kGreedyBreachLimit / std::max(problem.size(), 1u)) {
        result.surface = breach_all(problem, measure, {max_depth});
        result.has_guarantee = false;
        return result;
      }
    }
    if (pits.pit.empty()) return result;
    if (Round(problem, result.surface, pits, measure, max_depth).run()) continue;
    result.surface = level;  // none of those left can be breached
    return result;
  }
}

}  // namespace hydrotin
