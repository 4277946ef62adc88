#include "hydrotin/nested_pools.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <numeric>
#include <tuple>

#include "pool_sweep.h"
#include "vertex_order.h"

namespace hydrotin {
namespace {

Wide sixfold_of(const PoolContent& content) {
  return (static_cast<Wide>(content.sixfold_high) * (Wide{1} << 64)) | content.sixfold_low;
}

void set_sixfold(PoolContent& content, Wide value) {
  content.sixfold_high = static_cast<std::int64_t>(value >> 64);
  content.sixfold_low = static_cast<std::uint64_t>(value);
}

/// A sweep that says what its pools hold.
class ContentSweep : protected PoolSweep {
 protected:
  ContentSweep(const VertexGraph& graph, std::span<const std::uint32_t> triangle_vertex,
               std::span<const std::int32_t> height, std::span<const LatticePoint> position,
               std::span<const std::uint64_t> global_id)
      : PoolSweep(graph, triangle_vertex, height, position), id_(global_id) {}

  [[nodiscard]] RankedVertex ranked(std::uint32_t v) const { return {height_[v], position_[v], id_[v]}; }

  [[nodiscard]] PoolContent content_of(std::uint32_t number, std::int32_t level) {
    Pool& pool = pools_[number];
    PoolContent content;
    content.num_vertices = static_cast<std::int64_t>(pool.num_vertices);
    content.num_below = content.num_vertices - (pool.top == level ? static_cast<std::int64_t>(pool.num_at_top) : 0);
    content.sum_of_heights = pool.sum_of_heights;
    Wide sixfold = 0;
    measure_water(pool, level, content.doubled_area, sixfold);
    set_sixfold(content, sixfold);
    return content;
  }

  std::span<const std::uint64_t> id_;
};

class Reducer : private ContentSweep {
 public:
  Reducer(const VertexGraph& graph, std::span<const std::uint32_t> triangle_vertex,
          std::span<const std::int32_t> height, std::span<const LatticePoint> position,
          std::span<const std::uint64_t> global_id)
      : ContentSweep(graph, triangle_vertex, height, position, global_id) {}

  ReducedPools run(std::span<const std::uint8_t> is_rim, std::span<const std::uint8_t> is_outlet) {
    const std::vector<std::uint32_t> order = order_vertices(height_, position_);
    sort_triangles(order);
    pool_of_.assign(height_.size(), kNone);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::uint32_t v = order[i];
      look_ahead(order, i);
      find_meeting(v);
      const bool is_new = meeting_.empty();
      if (is_new) {
        meeting_.push_back(make_pool(v));
        node_of_.push_back(kNone);
      }
      const bool meets_open = std::any_of(meeting_.begin(), meeting_.end(), [&](std::uint32_t pool) {
        return node_of_[pool] != kNone && !pools_[pool].drains;
      });
      std::uint32_t pool;
      if (is_rim[v] || (meets_open && (meeting_.size() > 1 || is_outlet[v])))
        pool = meet_openly(v, is_new, is_outlet[v] != 0);
      else
        pool = meet(v, is_outlet[v] != 0);
      pool_of_[v] = pool;
      add_vertex(pools_[pool], v);
    }
    for (std::uint32_t pool = 0; pool < pools_.size(); ++pool)
      if (parent_[pool] == pool && node_of_[pool] == kNone && !pools_[pool].drains) result_.all_drain = false;
    for (std::size_t i = 0; i < result_.pit.size(); ++i) result_.pit[i].basin.price = price_[bottom_pool_[i]];
    return std::move(result_);
  }

 private:
  std::uint32_t meet_openly(std::uint32_t v, bool is_new, bool is_outlet) {
    bool drains = is_outlet;
    std::vector<std::uint32_t> child;
    for (const std::uint32_t pool : meeting_) {
      drains = drains || pools_[pool].drains;
      if (is_new) continue;
      if (node_of_[pool] == kNone) node_of_[pool] = make_leaf(pool, height_[v]);
      child.push_back(node_of_[pool]);
    }
    const auto node = static_cast<std::uint32_t>(result_.node.size());
    result_.node.push_back({ranked(v), kNoPit, kNoPit, is_outlet ? PoolNode::Kind::outlet : PoolNode::Kind::meeting});
    for (const std::uint32_t c : child) result_.node[c].parent = node;
    const std::uint32_t elder = meeting_.front();
    for (const std::uint32_t pool : meeting_)
      if (pool != elder) absorb(elder, pool);
    node_of_[elder] = node;
    pools_[elder].drains = drains;
    return elder;
  }

  std::uint32_t make_leaf(std::uint32_t number, std::int32_t level) {
    const Pool& pool = pools_[number];
    PoolNode leaf{ranked(pool.bottom), kNoPit, kNoPit, PoolNode::Kind::drained_leaf};
    if (!pool.drains) {
      leaf.kind = PoolNode::Kind::leaf;
      leaf.content = static_cast<std::uint32_t>(result_.content.size());
      result_.content.push_back(content_of(number, level));
      result_.spent.push_back(pool.spent);
      result_.bottom_price.push_back(price_[number_of_bottom(pool)]);
      const bool has_leader = pool.leader != kNone;
      result_.leader.push_back(has_leader ? ranked(pools_[pool.leader].bottom) : RankedVertex{});
      result_.leader_price.push_back(has_leader ? price_[pool.leader] : 0);
    }
    result_.node.push_back(leaf);
    return static_cast<std::uint32_t>(result_.node.size() - 1);
  }

  // The pool that v began: closed pools are numbered by their bottoms.
  [[nodiscard]] std::uint32_t number_of_bottom(const Pool& pool) const {
    return static_cast<std::uint32_t>(&pool - pools_.data());
  }

  // All pools are closed, or drain.
  std::uint32_t meet(std::uint32_t v, bool is_outlet) {
    std::uint32_t elder = meeting_.front();
    bool drains = is_outlet;
    for (const std::uint32_t pool : meeting_) {
      if (!pools_[pool].drains) continue;
      if (!pools_[elder].drains || node_of_[pool] != kNone) elder = pool;
      drains = true;
    }
    return join(elder, v, drains,
                [&](std::uint32_t pool, std::uint32_t into) -> PitBasin& { return add_pit(pool, into); });
  }

  PitBasin& add_pit(std::uint32_t number, std::uint32_t elder) {
    const std::uint32_t bottom = pools_[number].bottom;
    DecidedPit& pit = result_.pit.emplace_back();
    pit.basin.pit = {position_[bottom], id_[bottom], height_[bottom], 0};
    pit.basin.spill_vertex = 0;
    if (elder != kNone) pit.parent = id_[pools_[elder].bottom];
    bottom_pool_.push_back(number);
    return pit.basin;
  }

  ReducedPools result_;
  std::vector<std::uint32_t> node_of_;      // [pools] the last node of an open pool
  std::vector<std::uint32_t> bottom_pool_;  // [decided pits]
};

/// The pools of all parts together.
class Ranker {
 public:
  Ranker(std::span<const ReducedPools> parts, bool with_prices) : parts_(parts), with_prices_(with_prices) {
    for (std::uint32_t p = 0; p < parts.size(); ++p) {
      first_.push_back(static_cast<std::uint32_t>(part_.size()));
      part_.insert(part_.end(), parts[p].node.size(), p);
    }
    result_.query.resize(parts.size());
  }

  RankedPools run() {
    list_children();
    pool_of_.assign(part_.size(), kNone);
    is_dead_.assign(part_.size(), false);
    std::vector<std::uint32_t> order;
    for (std::uint32_t n = 0; n < part_.size(); ++n)
      if (is_meeting(n)) order.push_back(n);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return std::tie(node(a).at, a) < std::tie(node(b).at, b); });
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
      for (end = begin + 1; end < order.size() && node(order[end]).at == node(order[begin]).at;) ++end;
      meet({order.data() + begin, order.data() + end});
    }
    for (const ReducedPools& part : parts_) result_.all_drain = result_.all_drain && part.all_drain;
    for (std::uint32_t pool = 0; pool < pools_.size(); ++pool)
      if (find(pool) == pool && !pools_[pool].drains) result_.all_drain = false;
    return std::move(result_);
  }

 private:
  struct GlobalPool {
    RankedVertex bottom;
    std::uint32_t lone = kNoPit;     // content of the leaf that it still is
    std::vector<std::uint32_t> top;  // the last nodes of its shares of parts, and dead ones
    bool drains = false;
  };

  [[nodiscard]] const PoolNode& node(std::uint32_t n) const { return parts_[part_[n]].node[n - first_[part_[n]]]; }
  [[nodiscard]] bool is_meeting(std::uint32_t n) const {
    return node(n).kind == PoolNode::Kind::meeting || node(n).kind == PoolNode::Kind::outlet;
  }

  void list_children() {
    child_begin_.assign(part_.size() + 1, 0);
    const auto parent_of = [&](std::uint32_t n) { return first_[part_[n]] + node(n).parent; };
    for (std::uint32_t n = 0; n < part_.size(); ++n)
      if (node(n).parent != kNoPit) ++child_begin_[parent_of(n) + 1];
    std::partial_sum(child_begin_.begin(), child_begin_.end(), child_begin_.begin());
    child_.resize(child_begin_.back());
    std::vector<std::uint32_t> next(child_begin_.begin(), child_begin_.end() - 1);
    for (std::uint32_t n = 0; n < part_.size(); ++n)
      if (node(n).parent != kNoPit) child_[next[parent_of(n)]++] = n;
  }

  std::uint32_t find(std::uint32_t pool) {
    while (parent_[pool] != pool) pool = parent_[pool] = parent_[parent_[pool]];
    return pool;
  }

  std::uint32_t make_pool(const RankedVertex& bottom) {
    const auto pool = static_cast<std::uint32_t>(pools_.size());
    pools_.emplace_back().bottom = bottom;
    parent_.push_back(pool);
    if (with_prices_) {
      result_.pool_leader.push_back(bottom);
      result_.pool_price.push_back(0);
      result_.pool_spent.push_back(0);
    }
    return pool;
  }

  std::uint32_t make_pool_of_leaf(std::uint32_t n) {
    const PoolNode& leaf = node(n);
    const std::uint32_t number = make_pool(leaf.at);
    GlobalPool& pool = pools_[number];
    pool.top.push_back(n);
    if (leaf.kind == PoolNode::Kind::drained_leaf) {
      pool.drains = true;
      if (with_prices_) result_.pool_leader.back() = {};  // its pits have their prices
      return number;
    }
    const ReducedPools& part = parts_[part_[n]];
    pool.lone = static_cast<std::uint32_t>(result_.content.size());
    result_.content.push_back(part.content[leaf.content]);
    if (with_prices_) {
      result_.pool_leader.back() = part.leader[leaf.content];
      result_.bottom_price.emplace_back(leaf.at.vertex, part.bottom_price[leaf.content]);
      result_.pool_price.back() = part.leader_price[leaf.content];
      result_.pool_spent.back() = part.spent[leaf.content];
    }
    return number;
  }

  // Everything that happens at one vertex, in all parts that have it.
  void meet(std::span<const std::uint32_t> group) {
    const RankedVertex at = node(group.front()).at;
    meeting_.clear();
    bool drains = false;
    for (const std::uint32_t n : group) {
      drains = drains || node(n).kind == PoolNode::Kind::outlet;
      for (std::uint32_t i = child_begin_[n]; i < child_begin_[n + 1]; ++i) {
        const std::uint32_t c = child_[i];
        if (pool_of_[c] == kNone) pool_of_[c] = make_pool_of_leaf(c);
        meeting_.push_back(find(pool_of_[c]));
      }
    }
    const auto before = [&](std::uint32_t a, std::uint32_t b) { return pools_[a].bottom < pools_[b].bottom; };
    std::sort(meeting_.begin(), meeting_.end(), before);
    meeting_.erase(std::unique(meeting_.begin(), meeting_.end()), meeting_.end());
    if (meeting_.empty()) meeting_.push_back(make_pool(at));
    std::uint32_t elder = meeting_.front();
    for (const std::uint32_t pool : meeting_)
      if (pools_[pool].drains) elder = pool, drains = true;
    if (drains || meeting_.size() > 1) join(at, elder, drains);
    for (const std::uint32_t n : group) {
      for (std::uint32_t i = child_begin_[n]; i < child_begin_[n + 1]; ++i) is_dead_[child_[i]] = true;
      pool_of_[n] = elder;
      pools_[elder].top.push_back(n);
    }
    pools_[elder].lone = kNoPit;
    pools_[elder].drains = drains;
    if (drains) std::vector<std::uint32_t>().swap(pools_[elder].top);
  }

  void join(const RankedVertex& at, std::uint32_t elder, bool drains) {
    std::vector<std::uint32_t> content(meeting_.size(), kNoPit);
    for (std::size_t i = 0; i < meeting_.size(); ++i) {
      const std::uint32_t pool = meeting_[i];
      const bool ends = drains || pool != elder;
      if (pools_[pool].drains || (!ends && !with_prices_)) continue;
      content[i] = content_at(pools_[pool], at);
      if (with_prices_) result_.step.push_back({pool, content[i], at.height, PriceStep::Kind::raise});
    }
    for (std::size_t i = 0; i < meeting_.size(); ++i) {
      const std::uint32_t pool = meeting_[i];
      if (pools_[pool].drains || (!drains && pool == elder)) continue;
      if (pools_[pool].bottom.height == at.height) {
        if (with_prices_) result_.step.push_back({pool, 0, at.height, PriceStep::Kind::end_without_pit});
        continue;
      }
      result_.pit.push_back({pools_[pool].bottom, at, drains ? kNoPoint : pools_[elder].bottom.vertex, content[i]});
    }
    for (const std::uint32_t pool : meeting_) {
      if (pool == elder) continue;
      if (with_prices_) result_.step.push_back({elder, pool, at.height, PriceStep::Kind::absorb});
      parent_[pool] = elder;
      std::vector<std::uint32_t>& into = pools_[elder].top;
      std::vector<std::uint32_t>& from = pools_[pool].top;
      if (into.size() < from.size()) into.swap(from);
      into.insert(into.end(), from.begin(), from.end());
      std::vector<std::uint32_t>().swap(from);
    }
  }

  // The entry for what the pool holds just before `at`: known of a leaf, else asked of the parts.
  std::uint32_t content_at(GlobalPool& pool, const RankedVertex& at) {
    if (pool.lone != kNoPit) return pool.lone;
    const auto entry = static_cast<std::uint32_t>(result_.content.size());
    result_.content.emplace_back();
    std::erase_if(pool.top, [&](std::uint32_t n) { return is_dead_[n]; });
    for (const std::uint32_t n : pool.top) result_.query[part_[n]].push_back({node(n).at.vertex, at, entry});
    return entry;
  }

  std::span<const ReducedPools> parts_;
  bool with_prices_;
  std::vector<std::uint32_t> part_, first_;  // [nodes of all parts]; [parts]
  std::vector<std::uint32_t> child_begin_, child_;
  std::vector<std::uint32_t> pool_of_;
  std::vector<bool> is_dead_;
  std::vector<GlobalPool> pools_;
  std::vector<std::uint32_t> parent_, meeting_;
  RankedPools result_;
};

class Weigher : private ContentSweep {
 public:
  Weigher(const VertexGraph& graph, std::span<const std::uint32_t> triangle_vertex,
          std::span<const std::int32_t> height, std::span<const LatticePoint> position,
          std::span<const std::uint64_t> global_id)
      : ContentSweep(graph, triangle_vertex, height, position, global_id) {}

  std::vector<PoolContent> run(std::span<const std::uint8_t> counts, std::span<const PoolQuery> query) {
    std::vector<PoolContent> answer(query.size());
    if (query.empty()) return answer;
    std::vector<std::uint64_t> wanted;
    for (const PoolQuery& q : query) wanted.push_back(q.vertex);
    std::sort(wanted.begin(), wanted.end());
    std::vector<std::pair<std::uint64_t, std::uint32_t>> vertex_of;  // of those that are asked for
    auto at_wanted = wanted.begin();                                 // ids of a part ascend but for few places
    for (std::uint32_t v = 0; v < id_.size(); ++v) {
      if (v > 0 && id_[v] < id_[v - 1]) at_wanted = std::lower_bound(wanted.begin(), wanted.end(), id_[v]);
      while (at_wanted != wanted.end() && *at_wanted < id_[v]) ++at_wanted;
      if (at_wanted != wanted.end() && *at_wanted == id_[v]) vertex_of.emplace_back(id_[v], v);
    }
    std::sort(vertex_of.begin(), vertex_of.end());
    const std::vector<std::uint32_t> order = order_vertices(height_, position_);
    sort_triangles(order);
    pool_of_.assign(height_.size(), kNone);
    std::size_t next = 0;
    const auto answer_before = [&](const RankedVertex* moment) {
      for (; next < query.size() && (moment == nullptr || query[next].moment <= *moment); ++next) {
        const auto at = std::lower_bound(vertex_of.begin(), vertex_of.end(), std::pair{query[next].vertex, 0U});
        assert(at != vertex_of.end() && at->first == query[next].vertex && "the part has the vertex");
        answer[next] = content_of(find(pool_of_[at->second]), query[next].moment.height);
      }
    };
    for (std::size_t i = 0; i < order.size() && next < query.size(); ++i) {
      const std::uint32_t v = order[i];
      look_ahead(order, i);
      if (query[next].moment.height <= height_[v]) {
        const RankedVertex at = ranked(v);
        answer_before(&at);
        if (next == query.size()) break;
      }
      find_meeting(v);
      if (meeting_.empty()) meeting_.push_back(make_pool(v));
      const std::uint32_t pool = meeting_.front();
      for (const std::uint32_t other : meeting_)
        if (other != pool) absorb(pool, other);
      pool_of_[v] = pool;
      if (counts[v]) {
        add_vertex(pools_[pool], v);
        continue;
      }
      const Pool before = pools_[pool];  // another part counts it
      add_vertex(pools_[pool], v);
      pools_[pool].num_vertices = before.num_vertices;
      pools_[pool].sum_of_heights = before.sum_of_heights;
      pools_[pool].num_at_top = before.top == height_[v] ? before.num_at_top : 0;
    }
    answer_before(nullptr);
    return answer;
  }
};

/// Final prices of the pits that lead pools of the global pass, by their bottoms.
std::vector<std::pair<std::uint64_t, std::int64_t>> replay_prices(const RankedPools& ranked) {
  std::vector<std::uint32_t> leader(ranked.pool_leader.size());
  std::vector<std::int64_t> price = ranked.pool_price, spent = ranked.pool_spent;
  for (std::uint32_t pool = 0; pool < leader.size(); ++pool)
    leader[pool] = ranked.pool_leader[pool].vertex == kNoPoint ? kNone : pool;
  const auto key = [&](std::uint32_t l) { return std::tuple(price[l], ranked.pool_leader[l]); };
  for (const PriceStep& step : ranked.step) {
    switch (step.kind) {
      case PriceStep::Kind::raise: {
        const std::int64_t cost = ranked.content[step.other].displacement(step.level);
        if (leader[step.pool] != kNone) price[leader[step.pool]] += cost - spent[step.pool];
        spent[step.pool] = cost;
        break;
      }
      case PriceStep::Kind::end_without_pit:
        leader[step.pool] = kNone;
        break;
      case PriceStep::Kind::absorb: {
        const std::uint32_t from = leader[step.other];
        spent[step.pool] += spent[step.other];
        if (from != kNone && (leader[step.pool] == kNone || key(leader[step.pool]) < key(from)))
          leader[step.pool] = from;
        break;
      }
    }
  }
  std::vector<std::pair<std::uint64_t, std::int64_t>> out;
  for (std::uint32_t pool = 0; pool < leader.size(); ++pool)
    if (ranked.pool_leader[pool].vertex != kNoPoint) out.emplace_back(ranked.pool_leader[pool].vertex, price[pool]);
  for (const auto& bottom : ranked.bottom_price) out.push_back(bottom);
  // Of a pit that leads, the final price is the larger one: prices never fall.
  std::sort(out.begin(), out.end(),
            [](const auto& a, const auto& b) { return a.first != b.first ? a.first < b.first : a.second > b.second; });
  out.erase(std::unique(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.first == b.first; }),
            out.end());
  return out;
}

}  // namespace

void PoolContent::add(const PoolContent& other) {
  num_vertices += other.num_vertices;
  num_below += other.num_below;
  sum_of_heights += other.sum_of_heights;
  doubled_area += other.doubled_area;
  set_sixfold(*this, sixfold_of(*this) + sixfold_of(other));
}

ReducedPools reduce_pools(const VertexGraph& graph, std::span<const std::uint32_t> triangle_vertex,
                          std::span<const std::int32_t> height, std::span<const LatticePoint> position,
                          std::span<const std::uint64_t> global_id, std::span<const std::uint8_t> is_rim,
                          std::span<const std::uint8_t> is_outlet) {
  assert(height.size() == graph.num_vertices() && is_outlet.size() == height.size() && is_rim.size() == height.size());
  return Reducer(graph, triangle_vertex, height, position, global_id).run(is_rim, is_outlet);
}

RankedPools rank_pools(std::span<const ReducedPools> parts, bool with_prices) {
  return Ranker(parts, with_prices).run();
}

std::vector<PoolContent> weigh_pools(const VertexGraph& graph, std::span<const std::uint32_t> triangle_vertex,
                                     std::span<const std::int32_t> height, std::span<const LatticePoint> position,
                                     std::span<const std::uint64_t> global_id, std::span<const std::uint8_t> counts,
                                     std::span<const PoolQuery> query) {
  assert(height.size() == graph.num_vertices() && counts.size() == height.size() && "one entry per vertex");
  return Weigher(graph, triangle_vertex, height, position, global_id).run(counts, query);
}

std::vector<PitBasin> nested_pits(std::vector<DecidedPit> decided, const RankedPools& ranked,
                                  std::span<const Pit> plateaus) {
  for (const EndedPit& ended : ranked.pit) {
    DecidedPit& pit = decided.emplace_back();
    const PoolContent& content = ranked.content[ended.content];
    pit.basin.pit = {ended.bottom.position, ended.bottom.vertex, ended.bottom.height, 0};
    pit.basin.spill_vertex = 0;
    pit.basin.spill_position = ended.spill.position;
    pit.basin.spill_level = ended.spill.height;
    pit.basin.num_vertices = static_cast<std::uint64_t>(content.num_below);
    pit.basin.displacement = content.displacement(ended.spill.height);
    pit.basin.doubled_area = content.doubled_area;
    pit.basin.volume = static_cast<double>(sixfold_of(content)) / 6;
    pit.parent = ended.parent;
  }
  std::sort(decided.begin(), decided.end(),
            [](const DecidedPit& a, const DecidedPit& b) { return a.basin.pit < b.basin.pit; });
  const auto prices = replay_prices(ranked);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> index_of;
  for (std::uint32_t i = 0; i < decided.size(); ++i) index_of.emplace_back(decided[i].basin.pit.vertex, i);
  std::sort(index_of.begin(), index_of.end());
  std::vector<std::pair<LatticePoint, std::uint64_t>> size_of;
  for (const Pit& pit : plateaus) size_of.emplace_back(pit.representative, pit.num_vertices);
  std::sort(size_of.begin(), size_of.end());
  std::vector<PitBasin> out;
  out.reserve(decided.size());
  for (const DecidedPit& pit : decided) {
    PitBasin& basin = out.emplace_back(pit.basin);
    if (pit.parent != kNoPoint) {
      const auto at = std::lower_bound(index_of.begin(), index_of.end(), std::pair{pit.parent, 0U});
      if (at != index_of.end() && at->first == pit.parent) basin.parent = at->second;
    }
    const auto size =
        std::lower_bound(size_of.begin(), size_of.end(), std::pair{basin.pit.representative, std::uint64_t{0}});
    if (size != size_of.end() && size->first == basin.pit.representative) basin.pit.num_vertices = size->second;
    const auto price = std::lower_bound(prices.begin(), prices.end(),
                                        std::pair{basin.pit.vertex, std::numeric_limits<std::int64_t>::min()});
    if (price != prices.end() && price->first == basin.pit.vertex) basin.price = price->second;
  }
  return out;
}

}  // namespace hydrotin
