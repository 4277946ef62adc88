#include "hydrotin/contour_tree.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>

#include "vertex_order.h"

namespace hydrotin {
namespace {

using Ids = std::vector<std::uint32_t>;

Ids ranks_of(std::span<const std::uint32_t> ascending) {
  Ids rank(ascending.size());
  for (std::uint32_t i = 0; i < ascending.size(); ++i) rank[ascending[i]] = i;
  return rank;
}

std::uint32_t find(Ids& parent, std::uint32_t v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

/// What is known of the sets of a sweep before it begins.
///
/// Sets of visited vertices are kept by union-find, whose first unions need no sweep: each vertex belongs to the set of
/// the earliest of its neighbours. These are made in the order of the ids, where neighbours lie near each other in
/// memory. Only a vertex whose earlier neighbours lie in several of these basins may join sets later.
struct Basins {
  Ids parent;                  // union-find
  std::vector<bool> may_join;  // [n]
};

/// The basins of the sweep upwards, of that downwards, or of both, for which neighbours are looked at once.
template <bool kUp, bool kDown>
void find_basins(const VertexGraph& graph, const Ids& rank, Basins* up, Basins* down) {
  const std::uint32_t n = graph.num_vertices();
  if constexpr (kUp) up->parent.resize(n), up->may_join.resize(n);
  if constexpr (kDown) down->parent.resize(n), down->may_join.resize(n);
  for (std::uint32_t v = 0; v < n; ++v) {
    std::uint32_t lowest = v, highest = v, least = rank[v], most = rank[v];
    for (const std::uint32_t w : graph.neighbors(v)) {  // without branches: which neighbour it is cannot be guessed
      const std::uint32_t r = rank[w];
      if constexpr (kUp) lowest = r < least ? w : lowest, least = std::min(least, r);
      if constexpr (kDown) highest = r > most ? w : highest, most = std::max(most, r);
    }
    if constexpr (kUp) up->parent[v] = lowest;
    if constexpr (kDown) down->parent[v] = highest;
  }
  for (std::uint32_t v = 0; v < n; ++v) {
    if constexpr (kUp) up->parent[v] = find(up->parent, v);
    if constexpr (kDown) down->parent[v] = find(down->parent, v);
  }
  for (std::uint32_t v = 0; v < n; ++v) {
    unsigned joins = 0, splits = 0;
    for (const std::uint32_t w : graph.neighbors(v)) {
      const auto is_lower = static_cast<unsigned>(rank[w] < rank[v]);
      if constexpr (kUp) joins |= is_lower & static_cast<unsigned>(up->parent[w] != up->parent[v]);
      if constexpr (kDown) splits |= (is_lower ^ 1U) & static_cast<unsigned>(down->parent[w] != down->parent[v]);
    }
    if constexpr (kUp) up->may_join[v] = joins != 0;
    if constexpr (kDown) down->may_join[v] = splits != 0;
  }
}

/// One sweep over the vertices, upwards or downwards. The result is by ranks, as are the ends of sets: what a sweep has
/// just met has a rank near by, so it lies near in memory.
/// @return  [n] for each rank that of the next vertex in the merge tree.
template <bool kUp>
Ids merge_tree(const VertexGraph& graph, Basins basins, std::span<const std::uint32_t> ascending, const Ids& rank) {
  const std::uint32_t n = graph.num_vertices();
  const auto rank_at = [n](std::uint32_t i) { return kUp ? i : n - 1 - i; };
  Ids& parent = basins.parent;
  Ids next(n, kNoVertex), last(n);                             // last: rank of the last vertex of a set, at its root
  constexpr std::uint32_t kFetchVertex = 32, kFetchRoot = 16;  // visits ahead
  for (std::uint32_t i = 0; i < n; ++i) {
    if (i + kFetchVertex < n) {  // neighbours in height are far from each other in memory, but known ahead
      __builtin_prefetch(&parent[ascending[rank_at(i + kFetchVertex)]]);
      __builtin_prefetch(&last[parent[ascending[rank_at(i + kFetchRoot)]]]);
    }
    const std::uint32_t own = rank_at(i), v = ascending[own];
    const std::uint32_t root = find(parent, v);
    if (root != v) next[last[root]] = own;
    if (basins.may_join[v]) {
      for (const std::uint32_t w : graph.neighbors(v)) {
        if (kUp ? rank[w] > own : rank[w] < own) continue;
        const std::uint32_t other = find(parent, w);
        if (other == root) continue;
        next[last[other]] = own;
        parent[other] = root;
      }
    }
    last[root] = own;
  }
  return next;
}

/// From ranks to vertices.
Ids by_vertex(const Ids& next, std::span<const std::uint32_t> ascending) {
  Ids out(next.size(), kNoVertex);
  for (std::uint32_t i = 0; i < next.size(); ++i)
    if (next[i] != kNoVertex) out[ascending[i]] = ascending[next[i]];
  return out;
}

/// A vertex in both trees while they are merged; by rank.
struct Node {
  std::uint32_t up = kNoVertex, down = kNoVertex;  // next in the join tree and in the split tree, maybe merged already
  std::uint32_t num_below = 0, num_above = 0;      // nodes whose up, down is this one; merged: kMerged, end of the arc
};
constexpr std::uint32_t kMerged = kNoVertex;

/// Merges a join tree and a split tree. Whatever the order, a leaf of one that is on a path of the other can be taken
/// away with its arc, so many walks from leaf to leaf go on in turns: each of them waits for memory, but not for the
/// others.
class TreeMerger {
 public:
  explicit TreeMerger(std::vector<Node>& node) : node_(node) {}

  void run() {
    constexpr std::size_t kWalks = 16;
    std::uint32_t walk[kWalks];
    std::size_t num_walks = 0;
    for (std::uint32_t seed = 0; seed < node_.size() || num_walks > 0;) {
      while (num_walks < kWalks && seed < node_.size()) {
        if (is_leaf(node_[seed])) fetch_next(walk[num_walks++] = seed);
        ++seed;
      }
      for (std::size_t i = 0; i < num_walks;) {
        walk[i] = merge_leaf(walk[i]);
        if (walk[i] == kNoVertex)
          walk[i] = walk[--num_walks];
        else
          fetch_next(walk[i++]);
      }
    }
  }

 private:
  [[nodiscard]] static bool is_leaf(const Node& v) {
    return (v.num_below == 0 && v.num_above == 1) || (v.num_above == 0 && v.num_below == 1);
  }

  void fetch_next(std::uint32_t v) const {
    const std::uint32_t w = node_[v].num_below == 0 ? node_[v].up : node_[v].down;
    if (w != kNoVertex) __builtin_prefetch(&node_[w]);
  }

  std::uint32_t skip_merged(std::uint32_t v, std::uint32_t Node::*next) {
    while (node_[v].*next != kNoVertex && node_[node_[v].*next].num_below == kMerged)
      node_[v].*next = node_[node_[v].*next].*next;
    return node_[v].*next;
  }

  /// Merges a vertex that is a leaf of one tree and on a path of the other: its only arc left is that of the leaf.
  /// Returns the other end of the arc if that has become such a vertex, kNoVertex if not or if v is none.
  std::uint32_t merge_leaf(std::uint32_t v) {
    std::uint32_t w = kNoVertex;
    if (node_[v].num_below == 0 && node_[v].num_above == 1) {
      w = skip_merged(v, &Node::up);
      if (w != kNoVertex) --node_[w].num_below;
    } else if (node_[v].num_above == 0 && node_[v].num_below == 1) {
      w = skip_merged(v, &Node::down);
      if (w != kNoVertex) --node_[w].num_above;
    }
    if (w == kNoVertex) return kNoVertex;
    node_[v].num_below = kMerged;
    node_[v].num_above = w;
    return is_leaf(node_[w]) ? w : kNoVertex;
  }

  std::vector<Node>& node_;
};

}  // namespace

Ids ascending_vertices(std::span<const std::int32_t> height, std::span<const LatticePoint> position) {
  assert(height.size() == position.size() && "one entry per vertex");
  return order_vertices(height, position);
}

Ids join_tree(const VertexGraph& graph, std::span<const std::uint32_t> ascending) {
  assert(ascending.size() == graph.num_vertices() && "all vertices");
  const Ids rank = ranks_of(ascending);
  Basins up;
  find_basins<true, false>(graph, rank, &up, nullptr);
  return by_vertex(merge_tree<true>(graph, std::move(up), ascending, rank), ascending);
}

Ids split_tree(const VertexGraph& graph, std::span<const std::uint32_t> ascending) {
  assert(ascending.size() == graph.num_vertices() && "all vertices");
  const Ids rank = ranks_of(ascending);
  Basins down;
  find_basins<false, true>(graph, rank, nullptr, &down);
  return by_vertex(merge_tree<false>(graph, std::move(down), ascending, rank), ascending);
}

std::optional<ContourTree> contour_tree(const VertexGraph& graph, std::span<const std::int32_t> height,
                                        std::span<const LatticePoint> position) {
  assert(height.size() == graph.num_vertices() && position.size() == height.size() && "one entry per vertex");
  const std::uint32_t n = graph.num_vertices();
  ContourTree tree{{}, order_vertices(height, position)};
  std::vector<Node> node;
  std::uint32_t num_left = n;
  {
    const Ids rank = ranks_of(tree.ascending);
    Basins joining, splitting;
    find_basins<true, true>(graph, rank, &joining, &splitting);
    {
      const Ids up = merge_tree<true>(graph, std::move(joining), tree.ascending, rank);
      node.resize(n);
      for (std::uint32_t v = 0; v < n; ++v) {
        node[v].up = up[v];
        if (up[v] != kNoVertex) ++node[up[v]].num_below;
      }
    }
    const Ids down = merge_tree<false>(graph, std::move(splitting), tree.ascending, rank);
    for (std::uint32_t v = 0; v < n; ++v) {
      node[v].down = down[v];
      if (down[v] != kNoVertex) ++node[down[v]].num_above;
    }
  }
  TreeMerger(node).run();
  tree.other.assign(n, kNoVertex);
  constexpr std::uint32_t kAhead = 32;
  for (std::uint32_t v = 0; v < n; ++v) {
    if (v + kAhead < n) __builtin_prefetch(&tree.other[tree.ascending[v + kAhead]], 1);
    if (node[v].num_below != kMerged) continue;
    tree.other[tree.ascending[v]] = tree.ascending[node[v].num_above];
    --num_left;
  }
  // What is left of a tree is one vertex; a cycle leaves more.
  for (const Node& v : node)
    if (v.num_below == 0 && v.num_above == 0) --num_left;
  if (num_left != 0) return std::nullopt;
  return tree;
}

ContourDegrees contour_degrees(const ContourTree& tree) {
  const Ids rank = ranks_of(tree.ascending);
  ContourDegrees degrees{Ids(rank.size(), 0), Ids(rank.size(), 0)};
  for (std::uint32_t v = 0; v < rank.size(); ++v) {
    std::uint32_t lower = v, upper = tree.other[v];
    if (upper == kNoVertex) continue;
    if (rank[lower] > rank[upper]) std::swap(lower, upper);
    ++degrees.above[lower];
    ++degrees.below[upper];
  }
  return degrees;
}

}  // namespace hydrotin
