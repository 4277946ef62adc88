#include "hydrotin/drainage_forest.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <set>
#include <utility>

#include "bit_queue.h"
#include "height_key.h"
#include "radix_sort.h"
#include "sifted.h"

namespace hydrotin {
namespace {

constexpr std::int64_t kNever = std::int64_t{1} << 60;  // weight of an upper bound: no sum of weights reaches it

// Lower halves ascend already among keys with equal upper halves.
void sort_by_upper_half(std::vector<std::uint64_t>& keys) {
  if (keys.size() > 200)
    radix_sort(keys, [](std::uint64_t key) { return key >> 32; });
  else
    std::sort(keys.begin(), keys.end());
}

}  // namespace

class ForestFinder::State {
 public:
  void set_problem(const DrainageProblem& problem) {
    problem_ = &problem;
    by_height_.clear();
  }

  // Members are taken from a queue of those that are reached, by their places in the order (surface, height, number).
  void run(std::span<const std::int32_t> surface, DrainageForest& forest) {
    const DrainageProblem& problem = *problem_;
    const std::uint32_t k = problem.size();
    if (by_height_.empty()) sort_by_height();
    find_places(surface);
    queue_.reset(k);
    for (std::uint32_t v = 0; v < k; ++v) {
      if (problem.exit[v] == kNoLevel || problem.exit[v] > surface[v]) continue;
      member_[v].parent = kRoot;
      queue_.push(member_[v].place);
    }
    forest.order.resize(k);
    std::uint32_t num_done = 0;
    while (!queue_.empty()) {
      const std::uint32_t place = queue_.pop(), v = by_place_[place];
      prefetch_after(place);
      forest.order[num_done++] = v;
      const std::int32_t water = water_[v];
      water_[v] = kDone;
      for_each_of(
          problem.neighbors(v), [&](std::uint32_t w) { return water_[w] >= water; },
          [&](std::uint32_t w) {
            Member& m = member_[w];
            if (m.parent == kWaiting) {
              m.parent = v;
              queue_.push(m.place);
            } else if (m.parent == kRoot && water < problem.exit[w] && water_[w] != kDone) {
              m.parent = v;
            }
          });
    }
    assert(num_done == k && "the surface drains");
    forest.parent.resize(k);
    for (std::uint32_t v = 0; v < k; ++v) forest.parent[v] = member_[v].parent;
  }

 private:
  static constexpr std::uint32_t kWaiting = kRoot - 1;
  static constexpr std::int32_t kDone = std::numeric_limits<std::int32_t>::min();
  struct Member {
    std::uint32_t place, parent;
  };

  // Members are taken in about the order of their places: what the next ones will look at is known, step by step.
  void prefetch_after(std::uint32_t place) const {
    constexpr std::uint32_t kAhead = 4;
    const std::uint32_t k = problem_->size();
    if (k < kOutOfCache || place + 3 * kAhead >= k) return;
    const std::uint32_t far = by_place_[place + 3 * kAhead], soon = by_place_[place + 2 * kAhead];
    __builtin_prefetch(&problem_->begin[far]);
    __builtin_prefetch(&member_[far]);
    __builtin_prefetch(&problem_->neighbor[problem_->begin[soon]]);
    for (const std::uint32_t w : problem_->neighbors(by_place_[place + kAhead])) {
      __builtin_prefetch(&water_[w]);
      __builtin_prefetch(&member_[w]);
    }
  }

  // A rank in 32 bits leaves the other half of a key to the surface.
  void sort_by_height() {
    const std::uint32_t k = problem_->size();
    keys_.resize(k);
    for (std::uint32_t v = 0; v < k; ++v) keys_[v] = height_key(problem_->height[v], v);
    sort_by_upper_half(keys_);
    by_height_.resize(k);
    for (std::uint32_t i = 0; i < k; ++i) by_height_[i] = static_cast<std::uint32_t>(keys_[i]);
  }

  void find_places(std::span<const std::int32_t> surface) {
    const std::uint32_t k = problem_->size();
    constexpr std::uint32_t kAhead = 16;
    for (std::uint32_t i = 0; i < k; ++i) keys_[i] = height_key(surface[by_height_[i]], i);
    sort_by_upper_half(keys_);
    by_place_.resize(k);
    member_.resize(k);
    water_.assign(surface.begin(), surface.end());
    for (std::uint32_t i = 0; i < k; ++i) by_place_[i] = by_height_[static_cast<std::uint32_t>(keys_[i])];
    for (std::uint32_t i = 0; i < k; ++i) {
      if (i + kAhead < k) __builtin_prefetch(&member_[by_place_[i + kAhead]], 1);
      member_[by_place_[i]] = {i, kWaiting};
    }
  }

  static constexpr std::uint32_t kOutOfCache = 10'000;  // members: fewer lie in the cache anyway

  const DrainageProblem* problem_ = nullptr;
  std::vector<std::uint32_t> by_height_,
      by_place_;                     // members in the orders (height, number), (surface, height, number)
  std::vector<std::int32_t> water_;  // the surface, kDone where a member has been taken
  std::vector<Member> member_;
  std::vector<std::uint64_t> keys_;
  BitQueue queue_;
};

ForestFinder::ForestFinder() : state_(std::make_unique<State>()) {}
ForestFinder::ForestFinder(const DrainageProblem& problem) : ForestFinder() {
  set_problem(problem);
}
ForestFinder::~ForestFinder() = default;

void ForestFinder::set_problem(const DrainageProblem& problem) {
  state_->set_problem(problem);
}

void ForestFinder::run(std::span<const std::int32_t> surface, DrainageForest& forest) {
  state_->run(surface, forest);
}

std::uint32_t TreeRegression::meld(std::uint32_t a, std::uint32_t b) {
  if (a == kRoot) return b;
  if (b == kRoot) return a;
  if (slot_[b].key < slot_[a].key) std::swap(a, b);
  slot_[b].sibling = slot_[a].child;
  slot_[a].child = b;
  return a;
}

std::uint32_t TreeRegression::pop(std::uint32_t root) {
  pairs_.clear();
  for (std::uint32_t child = slot_[root].child; child != kRoot;) {
    const std::uint32_t next = slot_[child].sibling;
    slot_[child].sibling = kRoot;
    pairs_.push_back(child);
    child = next;
  }
  free_.push_back(root);
  std::uint32_t last = kRoot;
  std::size_t i = pairs_.size();
  if (i % 2 == 1) last = pairs_[--i];
  for (; i > 0; i -= 2) last = meld(meld(pairs_[i - 1], pairs_[i - 2]), last);
  return last;
}

std::uint32_t TreeRegression::make_slot(std::int32_t key, std::int64_t weight) {
  if (free_.empty()) {
    slot_.push_back({weight, key, kRoot, kRoot});
    return static_cast<std::uint32_t>(slot_.size() - 1);
  }
  const std::uint32_t slot = free_.back();
  free_.pop_back();
  slot_[slot] = {weight, key, kRoot, kRoot};
  return slot;
}

/// Takes a weight away from the lowest breakpoints and returns the last one touched.
std::int32_t TreeRegression::take(std::uint32_t& root, std::int64_t weight) {
  for (;;) {
    Slot& lowest = slot_[root];
    const std::int32_t key = lowest.key;
    if (lowest.weight > weight) {
      lowest.weight -= weight;
      return key;
    }
    weight -= lowest.weight;
    root = pop(root);
    if (weight == 0) return key;
  }
}

void TreeRegression::least_total(const DrainageProblem& problem, const DrainageForest& forest,
                                 std::span<const std::int32_t> lower, std::span<const std::int32_t> upper,
                                 std::vector<std::int32_t>& surface) {
  const std::uint32_t k = problem.size();
  slot_.clear();
  free_.clear();
  heap_.assign(k, kRoot);
  surface.resize(k);
  constexpr std::size_t kAhead = 16;
  for (std::size_t i = k; i-- > 0;) {
    if (i >= kAhead) {  // neighbours in the forest's order are far from each other in memory, but known ahead
      const std::uint32_t soon = forest.order[i - kAhead];
      __builtin_prefetch(&heap_[soon]);
      __builtin_prefetch(&forest.parent[soon]);
      __builtin_prefetch(&problem.height[soon]);
      __builtin_prefetch(&surface[soon]);
    }
    const std::uint32_t v = forest.order[i];
    std::uint32_t heap = heap_[v];
    const std::int64_t weight = problem.weight_of(v);
    if (heap == kRoot || slot_[heap].key >= problem.height[v]) {  // nothing upstream is lower
      heap = meld(make_slot(problem.height[v], weight), heap);
      surface[v] = problem.height[v];
    } else {
      heap = meld(heap, make_slot(problem.height[v], 2 * weight));
      surface[v] = take(heap, weight);
    }
    if (!lower.empty()) {
      if (surface[v] < lower[v]) {
        std::int64_t below = 0;
        for (; heap != kRoot && slot_[heap].key < lower[v]; heap = pop(heap)) below += slot_[heap].weight;
        if (below > 0) heap = meld(heap, make_slot(lower[v], below));
        surface[v] = lower[v];
      }
      if (surface[v] > upper[v]) {
        heap = make_slot(upper[v], kNever);
        surface[v] = upper[v];
      } else {
        heap = meld(heap, make_slot(upper[v], kNever));
      }
    }
    const std::uint32_t p = forest.parent[v];
    if (p != kRoot) heap_[p] = meld(heap_[p], heap);
  }
  for (std::size_t i = 0; i < k; ++i) {
    if (i + kAhead < k) {
      const std::uint32_t soon = forest.order[i + kAhead];
      __builtin_prefetch(&forest.parent[soon]);
      __builtin_prefetch(&surface[soon]);
    }
    const std::uint32_t v = forest.order[i], p = forest.parent[v];
    surface[v] = std::max(surface[v], p == kRoot ? problem.exit[v] : surface[p]);
  }
}

void TreeRegression::least_count(const DrainageProblem& problem, const DrainageForest& forest,
                                 std::vector<std::int32_t>& surface) {
  const std::uint32_t k = problem.size();
  constexpr std::int64_t kLowest = std::numeric_limits<std::int64_t>::min();
  // Steps of S_v(t) = most vertices kept in the subtree of v, all at t or above. Keeping v is worth it for t above
  // `taken[v]`, the height of the step that it takes away.
  std::vector<std::multiset<std::int32_t>> steps(k);
  std::vector<std::int64_t> taken(k, kLowest);
  for (std::size_t i = k; i-- > 0;) {
    const std::uint32_t v = forest.order[i];
    auto& own = steps[v];
    auto next = own.lower_bound(problem.height[v]);
    if (next != own.begin()) {
      --next;
      taken[v] = *next;
      own.erase(next);
    }
    own.insert(problem.height[v]);
    const std::uint32_t p = forest.parent[v];
    if (p == kRoot) continue;
    if (steps[p].size() < own.size()) steps[p].swap(own);
    steps[p].insert(own.begin(), own.end());
    std::multiset<std::int32_t>().swap(own);
  }
  std::vector<std::int64_t> threshold(k);
  std::vector<std::int32_t> lower(k), upper(k);
  for (const std::uint32_t v : forest.order) {
    const std::uint32_t p = forest.parent[v];
    const std::int64_t t = p == kRoot ? problem.exit[v] : threshold[p];
    const std::int32_t h = problem.height[v];
    const bool is_kept = h >= t && t > taken[v];
    threshold[v] = is_kept ? h : t;
    lower[v] = is_kept ? h : (problem.lower.empty() ? std::numeric_limits<std::int32_t>::min() : problem.lower[v]);
    upper[v] = is_kept ? h : (problem.upper.empty() ? kNoLevel - 1 : problem.upper[v]);
  }
  least_total(problem, forest, lower, upper, surface);
}

}  // namespace hydrotin
