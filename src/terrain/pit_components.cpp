#include "hydrotin/pit_components.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>
#include <utility>

#include "breach_search.h"

namespace hydrotin {
namespace {

/// The terrain as `BreachSearch` sees it.
struct TerrainGround {
  const ChangeableTerrain* terrain;
  std::span<const std::int32_t> flood_level;
  ChangeMeasure measure;
  std::int64_t max_depth;
  bool any_drained_is_goal = false;  // for water that has been raised to `level`

  [[nodiscard]] std::span<const std::uint32_t> neighbors(std::uint32_t v) const { return terrain->graph->neighbors(v); }
  [[nodiscard]] std::int64_t cost(std::uint32_t v, std::int32_t level) const {
    const std::int64_t depth = std::int64_t{terrain->height[v]} - level;
    if (depth <= 0) return 0;
    if (depth > max_depth || terrain->is_outlet[v]) return -1;
    if (!terrain->lower.empty() && terrain->lower[v] > level) return -1;
    if (measure == ChangeMeasure::count) return 1;
    return depth * (terrain->weight.empty() ? 1 : terrain->weight[v]);
  }
  [[nodiscard]] bool is_goal(std::uint32_t v, std::int32_t level) const {
    if (any_drained_is_goal) return flood_level[v] <= level;
    const std::int32_t h = terrain->height[v];
    return h < level || (h == level && flood_level[v] == h);
  }
  /// The same for heights up to `top` only.
  [[nodiscard]] TerrainGround limited_to(std::int32_t top, std::int32_t level) const {
    TerrainGround ground = *this;
    ground.max_depth = std::min(max_depth, std::int64_t{top} - level);
    return ground;
  }
  [[nodiscard]] static bool is_exit(std::uint32_t, std::int32_t) { return false; }
  [[nodiscard]] bool before(std::uint32_t v, std::uint32_t w) const {
    return terrain->position[v] < terrain->position[w];
  }
};

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

/// The least depth to which a breach of the pit must lower some vertex: how far the water must rise to find a goal.
std::int64_t bottleneck_depth(const ChangeableTerrain& terrain, const TerrainGround& ground,
                              std::span<const std::uint32_t> plateau, std::int32_t level,
                              std::vector<std::uint32_t>& touched, std::vector<std::uint8_t>& is_touched) {
  using Entry = std::pair<std::int32_t, std::uint32_t>;
  std::vector<Entry> heap;
  const auto reach = [&](std::int32_t height, std::uint32_t v) {
    is_touched[v] = 1;
    touched.push_back(v);
    heap.emplace_back(height, v);
    std::push_heap(heap.begin(), heap.end(), std::greater<>{});
  };
  touched.clear();
  for (const std::uint32_t v : plateau) reach(level, v);
  std::int64_t depth = -1;
  while (!heap.empty() && depth < 0) {
    std::pop_heap(heap.begin(), heap.end(), std::greater<>{});
    const auto [top, v] = heap.back();
    heap.pop_back();
    for (const std::uint32_t w : terrain.graph->neighbors(v)) {
      if (is_touched[w]) continue;
      if (ground.cost(w, level) < 0) continue;
      if (ground.is_goal(w, level)) {
        depth = std::int64_t{top} - level;
        break;
      }
      reach(std::max(top, terrain.height[w]), w);
    }
  }
  for (const std::uint32_t v : touched) is_touched[v] = 0;
  return depth;
}

double distance(LatticePoint a, LatticePoint b) {
  const double x = static_cast<double>(a.x) - b.x, y = static_cast<double>(a.y) - b.y;
  return std::sqrt(x * x + y * y);
}

/// Searches of many pits, one after the other.
class Breacher {
 public:
  Breacher(const ChangeableTerrain& terrain, std::span<const std::int32_t> flood_level, ChangeMeasure measure,
           const BreachLimits& limits)
      : terrain_(&terrain),
        ground_{&terrain, flood_level, measure, limits.max_depth},
        limits_(limits),
        search_(terrain.height.size()) {
    if (measure == ChangeMeasure::max) is_touched_.resize(terrain.height.size(), 0);
    for (std::size_t v = 0; v < terrain.height.size(); ++v)
      if (terrain.is_outlet[v])
        lowest_outlet_ = std::min(lowest_outlet_, terrain.height[v]);
      else
        bottom_ = std::min(bottom_, terrain.height[v]);
  }

  /// Whether the pit can be breached within the limits.
  bool run(std::span<const std::uint32_t> plateau, bool to_the_end = false) {
    const std::int32_t level = terrain_->height[plateau.front()];
    if (is_hopeless(plateau.front())) return false;
    TerrainGround ground = ground_;
    if (ground.measure == ChangeMeasure::max) {
      const std::int64_t depth = bottleneck_depth(*terrain_, ground, plateau, level, touched_, is_touched_);
      if (depth < 0) return false;
      ground.max_depth = depth;
    }
    if (!to_the_end) return search_.run(ground, plateau, level, limits_.max_visits) && length() <= limits_.max_length;
    const TerrainGround below_spill = ground.limited_to(ground.flood_level[plateau.front()], level);
    return (search_.run(below_spill, plateau, level) || search_.run(ground, plateau, level)) &&
           length() <= limits_.max_length;
  }
  /// Whether the last search was ended by `max_visits`.
  [[nodiscard]] bool is_unfinished() const { return search_.is_unfinished(); }
  /// The way of water that is raised just so far that it can leave by a breach. For pits below all outlets in reach.
  bool run_raised(std::span<const std::uint32_t> plateau) {
    if (lowest_outlet_ == kNoLevel) return false;
    if (run_raised_to(plateau, lowest_outlet_)) return true;
    const std::int32_t level = lowest_outlet_around(plateau.front());  // the lowest of all is out of reach
    return level != kNoLevel && level != lowest_outlet_ && run_raised_to(plateau, level);
  }
  [[nodiscard]] const BreachSearch& search() const { return search_; }
  /// In terms of the measure.
  [[nodiscard]] std::int64_t cost() const {
    if (ground_.measure != ChangeMeasure::max) return search_.cost();
    std::int64_t depth = 0;
    for (const std::uint32_t v : search_.path())
      depth = std::max(depth, std::int64_t{terrain_->height[v]} - terrain_->height[search_.path().front()]);
    return depth;
  }
  [[nodiscard]] double length() const {
    double sum = 0;
    const auto path = search_.path();
    for (std::size_t i = 1; i < path.size(); ++i)
      sum += distance(terrain_->position[path[i - 1]], terrain_->position[path[i]]);
    return sum;
  }

 private:
  // Whether nothing is lower than v, and no outlet as low.
  [[nodiscard]] bool is_hopeless(std::uint32_t v) const {
    return terrain_->height[v] < lowest_outlet_ && terrain_->height[v] <= bottom_;
  }

  // The lowest outlet that water can reach without passing another.
  [[nodiscard]] std::int32_t lowest_outlet_around(std::uint32_t seed) const {
    std::int32_t lowest = kNoLevel;
    std::vector<bool> is_reached(terrain_->height.size());
    std::vector<std::uint32_t> open{seed};
    is_reached[seed] = true;
    while (!open.empty()) {
      const std::uint32_t v = open.back();
      open.pop_back();
      for (const std::uint32_t w : terrain_->graph->neighbors(v)) {
        if (is_reached[w]) continue;
        is_reached[w] = true;
        if (terrain_->is_outlet[w])
          lowest = std::min(lowest, terrain_->height[w]);
        else
          open.push_back(w);
      }
    }
    return lowest;
  }

  bool run_raised_to(std::span<const std::uint32_t> plateau, std::int32_t level) {
    TerrainGround ground = ground_;
    ground.any_drained_is_goal = true;
    if (ground.measure == ChangeMeasure::max) {
      const std::int64_t depth = bottleneck_depth(*terrain_, ground, plateau, level, touched_, is_touched_);
      if (depth < 0) return false;
      ground.max_depth = depth;
    }
    if (limits_.max_visits != ~std::uint64_t{0}) ground = ground.limited_to(ground.flood_level[plateau.front()], level);
    return search_.run(ground, plateau, level) && length() <= limits_.max_length;
  }

  const ChangeableTerrain* terrain_;
  TerrainGround ground_;
  BreachLimits limits_;
  std::int32_t lowest_outlet_ = kNoLevel, bottom_ = kNoLevel;  // of all outlets, of all other vertices
  BreachSearch search_;
  std::vector<std::uint32_t> touched_;
  std::vector<std::uint8_t> is_touched_;
};

class ComponentFinder {
 public:
  ComponentFinder(const ChangeableTerrain& terrain, PitComponents& result) : terrain_(&terrain), result_(&result) {
    const std::size_t n = terrain.height.size();
    is_member_.assign(n, 0);
    for (std::size_t v = 0; v < n; ++v)
      is_member_[v] = result.level[v] != terrain.height[v] && result.level[v] != kNoLevel;
  }

  void find_pits() {
    std::vector<std::uint8_t> is_seen(terrain_->height.size(), 0);
    for (std::uint32_t v = 0; v < is_seen.size(); ++v) {
      if (!is_member_[v] || is_seen[v]) continue;
      const std::int32_t h = height(v);
      bool is_pit = true;
      plateau_.assign(1, v);
      is_seen[v] = 1;
      for (std::size_t next = 0; next < plateau_.size(); ++next)
        for (const std::uint32_t w : neighbors(plateau_[next])) {
          is_pit &= height(w) >= h;
          if (height(w) != h || is_seen[w]) continue;
          is_seen[w] = 1;
          plateau_.push_back(w);
        }
      if (!is_pit) continue;
      std::uint32_t first = v;
      for (const std::uint32_t w : plateau_)
        if (terrain_->position[w] < terrain_->position[first]) first = w;
      pits_.push_back(first);
      plateau_begin_.push_back(static_cast<std::uint32_t>(plateau_vertex_.size()));
      plateau_vertex_.insert(plateau_vertex_.end(), plateau_.begin(), plateau_.end());
    }
    plateau_begin_.push_back(static_cast<std::uint32_t>(plateau_vertex_.size()));
    result_->num_pits = pits_.size();
  }

  void add_breaches(Breacher& breacher, bool with_centers) {
    std::vector<std::uint32_t> unfinished;
    for (std::uint32_t i = 0; i < pits_.size(); ++i) {
      if (breacher.run(plateau(i)))
        add_path(i, breacher, with_centers);
      else if (breacher.is_unfinished())
        unfinished.push_back(i);
      else
        add_raised_path(i, breacher);
    }
    result_->num_unfinished = unfinished.size();
    if (!unfinished.empty()) open_lakes(breacher, unfinished);
    for (const std::uint32_t v : added_) is_member_[v] = 1;
  }

  /// Adds flats outside that touch members and have neither an outlet nor a neighbour whose level is lower.
  void add_flats_without_descent() {
    enum : std::uint8_t { kUnknown, kDescends, kVisited };
    std::vector<std::uint8_t> state(terrain_->height.size(), kUnknown);
    const auto descends = [&](std::uint32_t v) {
      if (terrain_->is_outlet[v] || state[v] == kDescends) return true;
      return std::ranges::any_of(neighbors(v), [&](std::uint32_t w) { return result_->level[w] < height(v); });
    };
    std::vector<std::uint32_t> flat;
    for (std::uint32_t v = 0; v < state.size(); ++v) {
      if (is_member_[v] || state[v] != kUnknown || result_->level[v] == kNoLevel || descends(v)) continue;
      if (std::ranges::none_of(neighbors(v), [&](std::uint32_t w) { return is_member_[w] != 0; })) continue;
      bool found = false;
      flat.assign(1, v);
      state[v] = kVisited;
      for (std::size_t next = 0; next < flat.size() && !found; ++next)
        for (const std::uint32_t w : neighbors(flat[next])) {
          if (is_member_[w] || height(w) != height(v) || state[w] == kVisited) continue;
          if (descends(w)) {
            found = true;
            break;
          }
          state[w] = kVisited;
          flat.push_back(w);
        }
      for (const std::uint32_t w : flat) {
        state[w] = found ? kDescends : kUnknown;
        if (!found) is_member_[w] = 1;
      }
    }
  }

  void collect() {
    constexpr std::uint32_t kNone = 0xffffffffu;
    const auto before = [&](std::uint32_t a, std::uint32_t b) { return terrain_->position[a] < terrain_->position[b]; };
    std::vector<std::uint32_t> component(is_member_.size(), kNone), begin{0}, member;
    for (std::uint32_t seed = 0; seed < is_member_.size(); ++seed) {
      if (!is_member_[seed] || component[seed] != kNone) continue;
      const auto number = static_cast<std::uint32_t>(begin.size() - 1);
      component[seed] = number;
      member.push_back(seed);
      for (std::size_t next = begin.back(); next < member.size(); ++next)
        for (const std::uint32_t w : neighbors(member[next]))
          if (is_member_[w] && component[w] == kNone) {
            component[w] = number;
            member.push_back(w);
          }
      sort_by_position(member, begin.back());
      begin.push_back(static_cast<std::uint32_t>(member.size()));
    }
    // Components by their smallest members.
    std::vector<std::uint32_t> order(begin.size() - 1), place(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return before(member[begin[a]], member[begin[b]]); });
    result_->begin.assign(1, 0);
    result_->member.reserve(member.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      place[order[i]] = i;
      result_->member.insert(result_->member.end(), member.begin() + begin[order[i]],
                             member.begin() + begin[order[i] + 1]);
      result_->begin.push_back(static_cast<std::uint32_t>(result_->member.size()));
    }
    std::sort(pits_.begin(), pits_.end(), [&](std::uint32_t a, std::uint32_t b) {
      const std::uint32_t p = place[component[a]], q = place[component[b]];
      if (p != q) return p < q;
      return height(a) != height(b) ? height(a) < height(b) : before(a, b);
    });
    result_->pit_begin.assign(order.size() + 1, 0);
    for (const std::uint32_t pit : pits_) ++result_->pit_begin[place[component[pit]] + 1];
    for (std::size_t i = 0; i < order.size(); ++i) result_->pit_begin[i + 1] += result_->pit_begin[i];
    result_->pit = std::move(pits_);
  }

 private:
  [[nodiscard]] std::int32_t height(std::uint32_t v) const { return terrain_->height[v]; }
  [[nodiscard]] std::span<const std::uint32_t> neighbors(std::uint32_t v) const {
    return terrain_->graph->neighbors(v);
  }

  [[nodiscard]] std::span<const std::uint32_t> plateau(std::uint32_t pit) const {
    return {plateau_vertex_.data() + plateau_begin_[pit], plateau_vertex_.data() + plateau_begin_[pit + 1]};
  }

  void add_path(std::uint32_t pit, const Breacher& breacher, bool with_centers) {
    const std::int32_t level = height(pits_[pit]);
    const BreachSearch& search = breacher.search();
    const std::int64_t cost = search.cost();
    result_->dearest_breach = std::max(result_->dearest_breach, breacher.cost());
    for (const std::uint32_t v : search.path().first(search.path().size() - 1)) {
      added_.push_back(v);
      result_->breached[v] = std::min(result_->breached[v], level);
    }
    if (!with_centers) return;
    const auto may_meet = [&](std::uint32_t v) { return !terrain_->is_outlet[v] && height(v) >= level; };
    for (const std::uint32_t v : search.touched()) {
      if (search.cost_to(v) >= cost) continue;
      if (may_meet(v)) added_.push_back(v);
      for (const std::uint32_t w : neighbors(v))
        if (may_meet(w)) added_.push_back(w);
    }
  }

  void add_raised_path(std::uint32_t pit, Breacher& breacher) {
    ++result_->num_unbreached;
    if (!breacher.run_raised(plateau(pit))) return;
    for (const std::uint32_t v : breacher.search().path())
      if (!terrain_->is_outlet[v]) added_.push_back(v);
  }

  // One search to its end for each lake with unfinished pits: for the lowest of them.
  void open_lakes(Breacher& breacher, std::vector<std::uint32_t>& unfinished) {
    std::sort(unfinished.begin(), unfinished.end(), [&](std::uint32_t a, std::uint32_t b) {
      const auto key = [&](std::uint32_t i) { return std::tuple(height(pits_[i]), terrain_->position[pits_[i]]); };
      return key(a) < key(b);
    });
    std::vector<std::uint8_t> is_open(is_member_.size(), 0);
    std::vector<std::uint32_t> lake;
    for (const std::uint32_t i : unfinished) {
      if (is_open[pits_[i]] != 0) continue;
      lake.assign(1, pits_[i]);
      is_open[pits_[i]] = 1;
      while (!lake.empty()) {
        const std::uint32_t v = lake.back();
        lake.pop_back();
        for (const std::uint32_t w : neighbors(v)) {
          if (is_member_[w] == 0 || is_open[w] != 0) continue;
          is_open[w] = 1;
          lake.push_back(w);
        }
      }
      if (breacher.run(plateau(i), true))
        add_path(i, breacher, false);
      else
        add_raised_path(i, breacher);
    }
  }

  void sort_by_position(std::vector<std::uint32_t>& member, std::size_t from) {
    keyed_.clear();
    for (std::size_t i = from; i < member.size(); ++i) {
      const LatticePoint p = terrain_->position[member[i]];
      const auto biased = [](std::int32_t c) { return std::uint64_t{static_cast<std::uint32_t>(c) ^ 0x80000000u}; };
      keyed_.emplace_back(biased(p.x) << 32 | biased(p.y), member[i]);
    }
    std::sort(keyed_.begin(), keyed_.end());
    for (std::size_t i = from; i < member.size(); ++i) member[i] = keyed_[i - from].second;
  }

  const ChangeableTerrain* terrain_;
  PitComponents* result_;
  std::vector<std::uint8_t> is_member_;
  std::vector<std::uint32_t>
      added_;  // members found by breaches; while these are sought, members are the raised vertices
  std::vector<std::uint32_t> pits_, plateau_begin_, plateau_vertex_, plateau_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed_;
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
  Breacher breacher(terrain, level, measure, limits);
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
  ComponentFinder finder(terrain, result);
  finder.find_pits();
  if (reach != MemberReach::lifted) {
    Breacher breacher(terrain, result.level, measure, limits);
    finder.add_breaches(breacher, reach == MemberReach::centers);
  }
  finder.add_flats_without_descent();
  finder.collect();
  return result;
}

void make_problem(const ChangeableTerrain& terrain, const PitComponents& components, std::size_t component,
                  std::span<std::uint32_t> number, DrainageProblem& problem) {
  assert(number.size() == terrain.height.size() && "one entry per vertex");
  const std::span<const std::uint32_t> member(components.member.data() + components.begin[component],
                                              components.member.data() + components.begin[component + 1]);
  problem.clear();
  for (std::uint32_t i = 0; i < member.size(); ++i) number[member[i]] = i;
  problem.begin.push_back(0);
  for (const std::uint32_t v : member) {
    const std::int32_t h = terrain.height[v];
    std::int32_t exit = kNoLevel;
    const std::size_t first = problem.neighbor.size();
    for (const std::uint32_t w : terrain.graph->neighbors(v)) {
      if (number[w] == kNoVertexNumber) {
        exit = std::min(exit, terrain.height[w]);
        continue;
      }
      problem.neighbor.push_back(number[w]);
      for (std::size_t i = problem.neighbor.size() - 1; i > first && problem.neighbor[i] < problem.neighbor[i - 1]; --i)
        std::swap(problem.neighbor[i], problem.neighbor[i - 1]);
    }
    problem.begin.push_back(static_cast<std::uint32_t>(problem.neighbor.size()));
    problem.height.push_back(h);
    problem.exit.push_back(exit);
    problem.level.push_back(components.level[v]);
    problem.breached.push_back(components.breached[v]);
    if (!terrain.weight.empty()) problem.weight.push_back(terrain.weight[v]);
    if (!terrain.lower.empty()) problem.lower.push_back(terrain.lower[v]);
    if (!terrain.upper.empty()) problem.upper.push_back(terrain.upper[v]);
  }
  for (const std::uint32_t v : member) number[v] = kNoVertexNumber;
}

}  // namespace hydrotin
