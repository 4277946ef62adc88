#include "hydrotin/pit_components.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <tuple>
#include <utility>

#include "breacher.h"
#include "height_key.h"
#include "hydrotin/group_cut.h"
#include "hydrotin/lake_breaches.h"
#include "radix_sort.h"

namespace hydrotin {
namespace {

/// Most lists of neighbours have six or so: those are sorted in registers.
constexpr std::size_t kShortList = 8;

/// Sorts by a network (Batcher's), whose steps do not depend on the numbers and so are not guessed wrong.
void sort_short_list(std::array<std::uint32_t, kShortList>& a) {
  const auto order = [&](std::size_t i, std::size_t j) {
    const std::uint32_t low = std::min(a[i], a[j]), high = std::max(a[i], a[j]);
    a[i] = low, a[j] = high;
  };
  order(0, 1), order(2, 3), order(4, 5), order(6, 7);
  order(0, 2), order(1, 3), order(4, 6), order(5, 7);
  order(1, 2), order(5, 6);
  order(0, 4), order(1, 5), order(2, 6), order(3, 7);
  order(2, 4), order(3, 5);
  order(1, 2), order(3, 4), order(5, 6);
}

std::vector<std::uint32_t> plateau_of(const ChangeableTerrain& terrain, std::uint32_t v) {
  std::vector<bool> is_seen(terrain.height.size());
  std::vector<std::uint32_t> plateau{v};
  is_seen[v] = true;
  for (std::size_t next = 0; next < plateau.size(); ++next)
    for (const std::uint32_t w : terrain.graph->neighbors(plateau[next])) {
      if (terrain.height[w] != terrain.height[v] || is_seen[w]) continue;
      is_seen[w] = true;
      plateau.push_back(w);
    }
  return plateau;
}

/// The members by lifting, and those that breaches add; with all pits.
class LakeCollector {
 public:
  LakeCollector(const ChangeableTerrain& terrain, std::uint64_t max_lake, PitComponents& result)
      : terrain_(&terrain), max_lake_(max_lake), result_(&result) {
    const std::size_t n = terrain.height.size();
    is_member_.assign(n, 0);
    for (std::size_t v = 0; v < n; ++v)
      is_member_[v] = result.level[v] != terrain.height[v] && result.level[v] != kNoLevel;
  }

  /// The lakes with their pits, and the members that breaches add.
  void add_lakes(LakeBreacher& breacher) {
    std::vector<std::uint8_t> is_seen(terrain_->height.size(), 0);
    std::vector<std::uint32_t> added;
    LakeBreaches found;
    for (std::uint32_t seed = 0; seed < is_seen.size(); ++seed) {
      if (!is_member_[seed] || is_seen[seed]) continue;
      const auto lake = breacher.lake_around(seed);
      for (const std::uint32_t v : lake) is_seen[v] = 1;
      if (lake.size() > max_lake_) {
        result_->filled.insert(result_->filled.end(), lake.begin(), lake.end());
        continue;
      }
      breacher.run(found);
      pits_.insert(pits_.end(), found.pit.begin(), found.pit.end());
      added.insert(added.end(), found.vertex.begin(), found.vertex.end());
      for (std::size_t i = 0; i < found.vertex.size(); ++i) {
        std::int32_t& breached = result_->breached[found.vertex[i]];
        breached = std::min(breached, found.level[i]);
      }
      result_->dearest_breach = std::max(result_->dearest_breach, found.dearest);
      result_->num_unfinished += found.num_unfinished;
      result_->num_unbreached += found.num_unbreached;
    }
    result_->num_pits = pits_.size();
    for (const std::uint32_t v : added) is_member_[v] = 1;
    for (const std::uint32_t v : result_->filled) is_member_[v] = 0;
  }

  [[nodiscard]] std::vector<std::uint8_t> take_members() { return std::move(is_member_); }
  [[nodiscard]] std::vector<std::uint32_t> take_pits() { return std::move(pits_); }

 private:
  const ChangeableTerrain* terrain_;
  std::uint64_t max_lake_;
  PitComponents* result_;
  std::vector<std::uint8_t> is_member_;
  std::vector<std::uint32_t> pits_;
};

/// Flats outside the members.
class FlatFinder {
 public:
  FlatFinder(const ChangeableTerrain& terrain, std::span<const std::int32_t> level, std::span<std::uint8_t> is_member)
      : terrain_(&terrain), level_(level), is_member_(is_member), state_(level.size(), kUnknown) {}

  void find_open(std::span<const std::uint8_t> is_rim, OpenFlats& open) {
    for (std::uint32_t v = 0; v < state_.size(); ++v) {
      if (!is_rim[v] || is_member_[v] || state_[v] != kUnknown || level_[v] == kNoLevel) continue;
      bool touches = false, drains = false;
      const std::size_t first = open.vertex.size();
      open.vertex.push_back(v);
      state_[v] = kOpen;
      for (std::size_t next = first; next < open.vertex.size(); ++next) {
        const std::uint32_t u = open.vertex[next];
        drains = drains || descends(u);
        for (const std::uint32_t w : terrain_->graph->neighbors(u)) {
          touches = touches || is_member_[w] != 0;
          if (is_member_[w] || height(w) != height(v) || state_[w] != kUnknown) continue;
          state_[w] = kOpen;
          open.vertex.push_back(w);
        }
      }
      open.begin.push_back(static_cast<std::uint32_t>(open.vertex.size()));
      open.touches.push_back(touches);
      open.drains.push_back(drains);
    }
  }

  /// Makes members of the others that touch members and have neither an outlet nor a neighbour whose level is lower.
  void add_closed() {
    std::vector<std::uint32_t> flat;
    for (std::uint32_t v = 0; v < state_.size(); ++v) {
      if (is_member_[v] || state_[v] != kUnknown || level_[v] == kNoLevel || descends(v)) continue;
      if (std::ranges::none_of(terrain_->graph->neighbors(v), [&](std::uint32_t w) { return is_member_[w] != 0; }))
        continue;
      bool found = false;
      flat.assign(1, v);
      state_[v] = kVisited;
      for (std::size_t next = 0; next < flat.size() && !found; ++next)
        for (const std::uint32_t w : terrain_->graph->neighbors(flat[next])) {
          if (is_member_[w] || height(w) != height(v) || state_[w] == kVisited) continue;
          if (state_[w] == kDescends || descends(w)) {
            found = true;
            break;
          }
          state_[w] = kVisited;
          flat.push_back(w);
        }
      for (const std::uint32_t w : flat) {
        state_[w] = found ? kDescends : kUnknown;
        if (!found) is_member_[w] = 1;
      }
    }
  }

 private:
  enum : std::uint8_t { kUnknown, kDescends, kVisited, kOpen };

  [[nodiscard]] std::int32_t height(std::uint32_t v) const { return terrain_->height[v]; }
  [[nodiscard]] bool descends(std::uint32_t v) const {
    return terrain_->is_outlet[v] != 0 ||
           std::ranges::any_of(terrain_->graph->neighbors(v), [&](std::uint32_t w) { return level_[w] < height(v); });
  }

  const ChangeableTerrain* terrain_;
  std::span<const std::int32_t> level_;
  std::span<std::uint8_t> is_member_;
  std::vector<std::uint8_t> state_;
};

class ComponentFinder {
 public:
  ComponentFinder(const ChangeableTerrain& terrain, PitComponents& result, std::vector<std::uint32_t> pits)
      : terrain_(&terrain), result_(&result), pits_(std::move(pits)) {}

  void collect(std::span<const std::uint8_t> is_member) {
    const std::vector<std::uint32_t> component = number_components(is_member);
    sort_members(is_member, component);
    // Components by their smallest members.
    const std::size_t num_components = begin_.size() - 1;
    std::vector<Member> first(num_components);
    for (std::uint32_t c = 0; c < num_components; ++c) first[c] = {key_of(member_[begin_[c]]), c};
    std::sort(first.begin(), first.end());
    std::vector<std::uint32_t> place(num_components);
    result_->begin.assign(1, 0);
    result_->member.clear();
    result_->member.reserve(member_.size());
    for (std::uint32_t i = 0; i < num_components; ++i) {
      const std::uint32_t c = first[i].vertex;
      place[c] = i;
      result_->member.insert(result_->member.end(), member_.begin() + begin_[c], member_.begin() + begin_[c + 1]);
      result_->begin.push_back(static_cast<std::uint32_t>(result_->member.size()));
    }
    std::sort(pits_.begin(), pits_.end(), [&](std::uint32_t a, std::uint32_t b) {
      const std::uint32_t p = place[component[a]], q = place[component[b]];
      if (p != q) return p < q;
      return std::tie(terrain_->height[a], terrain_->position[a]) <
             std::tie(terrain_->height[b], terrain_->position[b]);
    });
    result_->pit_begin.assign(num_components + 1, 0);
    for (const std::uint32_t pit : pits_) ++result_->pit_begin[place[component[pit]] + 1];
    for (std::size_t i = 0; i < num_components; ++i) result_->pit_begin[i + 1] += result_->pit_begin[i];
    result_->pit = std::move(pits_);
  }

 private:
  struct Member {
    std::uint64_t key;  // (x, y)
    std::uint32_t vertex;
    friend auto operator<=>(const Member&, const Member&) = default;
  };

  // [n] of members: the components by their smallest numbers; their sizes go to `begin_`. Sets are united in one scan
  // of the members; the smallest vertex of a set stands for it, so that all others find its number before theirs.
  std::vector<std::uint32_t> number_components(std::span<const std::uint8_t> is_member) {
    std::vector<std::uint32_t> parent(is_member.size());
    const auto find = [&](std::uint32_t v) {
      while (parent[v] != v) v = parent[v] = parent[parent[v]];
      return v;
    };
    for (std::uint32_t v = 0; v < is_member.size(); ++v) {
      if (!is_member[v]) continue;
      std::uint32_t root = parent[v] = v;
      for (const std::uint32_t w : terrain_->graph->neighbors(v)) {
        if (w > v) break;  // neighbours ascend
        if (!is_member[w]) continue;
        const std::uint32_t other = find(w), low = std::min(root, other);
        parent[root] = parent[other] = low;
        root = low;
      }
    }
    begin_.assign(1, 0);
    for (std::uint32_t v = 0; v < is_member.size(); ++v) {
      if (!is_member[v]) continue;
      if (parent[v] == v) {
        parent[v] = static_cast<std::uint32_t>(begin_.size() - 1);
        begin_.push_back(0);
      } else {
        parent[v] = parent[parent[v]];
      }
      ++begin_[parent[v] + 1];
    }
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    return parent;
  }

  [[nodiscard]] std::uint64_t key_of(std::uint32_t v) const {
    const LatticePoint p = terrain_->position[v];
    return biased(p.x) << 32 | biased(p.y);
  }

  // The members of each component by (x, y).
  void sort_members(std::span<const std::uint8_t> is_member, const std::vector<std::uint32_t>& component) {
    member_.resize(begin_.back());
    std::vector<std::uint32_t> end(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t v = 0; v < is_member.size(); ++v)
      if (is_member[v]) member_[end[component[v]]++] = v;
    std::vector<Member> keyed;
    for (std::size_t c = 0; c + 1 < begin_.size(); ++c) {
      keyed.clear();
      for (std::size_t i = begin_[c]; i < begin_[c + 1]; ++i) keyed.push_back({key_of(member_[i]), member_[i]});
      if (keyed.size() < kManyMembers)
        std::sort(keyed.begin(), keyed.end());
      else
        radix_sort(keyed, [](const Member& m) { return m.key; });
      for (std::size_t i = begin_[c]; i < begin_[c + 1]; ++i) member_[i] = keyed[i - begin_[c]].vertex;
    }
  }

  static constexpr std::size_t kManyMembers = 5000;

  const ChangeableTerrain* terrain_;
  PitComponents* result_;
  std::vector<std::uint32_t> pits_;
  std::vector<std::uint32_t> begin_, member_;  // of component c: member_[begin_[c] .. begin_[c + 1])
};

}  // namespace

BreachPath breach_one(const ChangeableTerrain& terrain, std::span<const std::int32_t> level, std::uint32_t pit,
                      ChangeMeasure measure, const BreachLimits& limits) {
  assert(level.size() == terrain.height.size() && pit < level.size() && "one level per vertex");
  const std::vector<std::uint32_t> plateau = plateau_of(terrain, pit);
  BreachPath path;
  path.pit = pit;
  for (const std::uint32_t v : plateau)
    if (terrain.position[v] < terrain.position[path.pit]) path.pit = v;
  path.level = terrain.height[pit];
  Breacher breacher(terrain, level, {}, outlet_heights(terrain), measure, limits);
  if (!breacher.run(plateau)) return path;
  path.vertex.assign(breacher.search().path().begin(), breacher.search().path().end());
  path.length = breacher.length();
  for (const std::uint32_t v : path.vertex) path.max_depth = std::max(path.max_depth, terrain.height[v] - path.level);
  path.cost = breacher.cost();
  return path;
}

PitComponents find_pit_components(const ChangeableTerrain& terrain, MemberReach reach, ChangeMeasure measure,
                                  const BreachLimits& limits) {
  assert(terrain.graph != nullptr && terrain.height.size() == terrain.graph->num_vertices() && "one entry per vertex");
  assert(terrain.position.size() == terrain.height.size() && terrain.is_outlet.size() == terrain.height.size());
  PitComponents result;
  result.level = lift(*terrain.graph, terrain.height, terrain.is_outlet);
  result.breached.assign(terrain.height.begin(), terrain.height.end());
  LakeCollector lakes(terrain, reach == MemberReach::lifted ? ~std::uint64_t{0} : limits.max_lake, result);
  {
    LakeBreacher breacher(terrain, result.level, {}, outlet_heights(terrain), reach, measure, limits);
    lakes.add_lakes(breacher);
  }
  std::vector<std::uint8_t> is_member = lakes.take_members();
  ChangeableTerrain filled = terrain;
  std::vector<std::int32_t> height;
  std::vector<std::uint8_t> is_outlet;
  if (!result.filled.empty()) {
    height = filled_heights(terrain, result);
    is_outlet.assign(terrain.is_outlet.begin(), terrain.is_outlet.end());
    for (const std::uint32_t v : result.filled) is_outlet[v] = 1;  // a flat with filled lakes stays with them
    filled.height = height;
    filled.is_outlet = is_outlet;
  }
  (void)add_flats_without_descent(filled, result.level, {}, is_member);
  if (reach != MemberReach::lifted && limits.max_group < terrain.position.size()) {
    LatticeBox bounds;
    for (const LatticePoint p : terrain.position) bounds.extend(p);
    result.num_cut =
        cut_large_groups(filled, result.level, cut_grid(bounds, terrain.position.size()), limits.max_group, is_member);
  }
  collect_components(filled, is_member, lakes.take_pits(), result);
  return result;
}

std::vector<std::int32_t> filled_heights(const ChangeableTerrain& terrain, const PitComponents& components) {
  std::vector<std::int32_t> height(terrain.height.begin(), terrain.height.end());
  for (const std::uint32_t v : components.filled) height[v] = components.level[v];
  return height;
}

void collect_components(const ChangeableTerrain& terrain, std::span<const std::uint8_t> is_member,
                        std::vector<std::uint32_t> pits, PitComponents& components) {
  assert(is_member.size() == terrain.height.size() && "one entry per vertex");
  ComponentFinder(terrain, components, std::move(pits)).collect(is_member);
}

OpenFlats add_flats_without_descent(const ChangeableTerrain& terrain, std::span<const std::int32_t> level,
                                    std::span<const std::uint8_t> is_rim, std::span<std::uint8_t> is_member) {
  assert(level.size() == is_member.size() && (is_rim.empty() || is_rim.size() == level.size()));
  FlatFinder finder(terrain, level, is_member);
  OpenFlats open;
  open.begin.push_back(0);
  if (!is_rim.empty()) finder.find_open(is_rim, open);
  finder.add_closed();
  return open;
}

void make_problem(const ChangeableTerrain& terrain, const PitComponents& components, std::size_t component,
                  std::span<std::uint32_t> number, DrainageProblem& problem) {
  assert(number.size() == terrain.height.size() && "one entry per vertex");
  const std::span<const std::uint32_t> member(components.member.data() + components.begin[component],
                                              components.member.data() + components.begin[component + 1]);
  problem.clear();
  for (std::uint32_t i = 0; i < member.size(); ++i) number[member[i]] = i;
  const std::size_t k = member.size();
  problem.begin.resize(k + 1);
  problem.height.resize(k), problem.exit.resize(k), problem.level.resize(k), problem.breached.resize(k);
  const VertexGraph& graph = *terrain.graph;
  std::size_t end = 0;
  for (std::size_t i = 0; i < k; ++i) {
    constexpr std::size_t kAhead = 8;  // members near each other by (x, y) may lie anywhere in memory
    if (i + 2 * kAhead < k) __builtin_prefetch(&graph.begin[member[i + 2 * kAhead]]);
    if (i + kAhead < k) {
      const std::uint32_t soon = member[i + kAhead];
      __builtin_prefetch(graph.neighbor.data() + graph.begin[soon]);
      __builtin_prefetch(&terrain.height[soon]);
      __builtin_prefetch(&components.level[soon]);
      __builtin_prefetch(&components.breached[soon]);
    }
    const std::uint32_t v = member[i];
    const std::span<const std::uint32_t> around = graph.neighbors(v);
    const std::size_t first = end, most = first + std::max(around.size(), kShortList);
    if (problem.neighbor.size() < most) problem.neighbor.resize(std::max(most, 2 * problem.neighbor.size()));
    std::array<std::uint32_t, kShortList> few;
    few.fill(kNoVertexNumber);
    std::uint32_t* const list = around.size() <= kShortList ? few.data() : problem.neighbor.data() + first;
    std::int32_t exit = kNoLevel;
    std::size_t count = 0;
    for (const std::uint32_t w : around) {
      const std::uint32_t j = number[w];
      list[count] = j;
      count += j != kNoVertexNumber ? 1 : 0;
      exit = std::min(exit, j == kNoVertexNumber ? terrain.height[w] : kNoLevel);
    }
    if (list == few.data()) {
      sort_short_list(few);
      for (std::size_t j = 0; j < kShortList; ++j) problem.neighbor[first + j] = few[j];  // what is behind comes later
    } else {
      std::sort(list, list + count);
    }
    end += count;
    problem.begin[i + 1] = static_cast<std::uint32_t>(end);
    problem.height[i] = terrain.height[v];
    problem.exit[i] = exit;
    problem.level[i] = components.level[v];
    problem.breached[i] = components.breached[v];
    if (!terrain.weight.empty()) problem.weight.push_back(terrain.weight[v]);
    if (!terrain.lower.empty()) problem.lower.push_back(terrain.lower[v]);
    if (!terrain.upper.empty()) problem.upper.push_back(terrain.upper[v]);
  }
  problem.begin[0] = 0;
  problem.neighbor.resize(end);
  for (const std::uint32_t v : member) number[v] = kNoVertexNumber;
}

}  // namespace hydrotin
