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

/// One sweep: `sequence` visits the vertices, `before` tells which of two it visits first.
template <class Sequence, class Before>
Ids merge_tree(const VertexGraph& graph, Basins basins, Sequence sequence, Before before) {
  const std::uint32_t n = graph.num_vertices();
  Ids& parent = basins.parent;
  Ids next(n, kNoVertex), last(n);                                            // last: of a set, at its root
  constexpr std::uint32_t kFetchVertex = 32, kFetchRoot = 16, kFetchEnd = 8;  // visits ahead
  for (std::uint32_t i = 0; i < n; ++i) {
    if (i + kFetchVertex < n) {  // neighbours in height are far from each other in memory, but known ahead
      __builtin_prefetch(&parent[sequence(i + kFetchVertex)]);
      __builtin_prefetch(&last[parent[sequence(i + kFetchRoot)]]);
      __builtin_prefetch(&next[last[parent[sequence(i + kFetchEnd)]]]);
    }
    const std::uint32_t v = sequence(i);
    const std::uint32_t root = find(parent, v);
    if (root != v) next[last[root]] = v;
    if (basins.may_join[v]) {
      for (const std::uint32_t w : graph.neighbors(v)) {
        if (!before(w, v)) continue;
        const std::uint32_t other = find(parent, w);
        if (other == root) continue;
        next[last[other]] = v;
        parent[other] = root;
      }
    }
    last[root] = v;
  }
  return next;
}

Ids join_tree(const VertexGraph& graph, std::span<const std::uint32_t> ascending, const Ids& rank, Basins basins) {
  return merge_tree(
      graph, std::move(basins), [&](std::uint32_t i) { return ascending[i]; },
      [&](std::uint32_t v, std::uint32_t w) { return rank[v] < rank[w]; });
}

Ids split_tree(const VertexGraph& graph, std::span<const std::uint32_t> ascending, const Ids& rank, Basins basins) {
  return merge_tree(
      graph, std::move(basins), [&](std::uint32_t i) { return ascending[ascending.size() - 1 - i]; },
      [&](std::uint32_t v, std::uint32_t w) { return rank[v] > rank[w]; });
}

/// A vertex in both trees while they are merged.
struct Node {
  std::uint32_t up = kNoVertex, down = kNoVertex;  // next in the join tree and in the split tree, maybe merged already
  std::uint32_t num_below = 0, num_above = 0;      // nodes whose up, down is this one; kMerged
};
constexpr std::uint32_t kMerged = kNoVertex;

std::uint32_t skip_merged(std::vector<Node>& node, std::uint32_t v, std::uint32_t Node::*next) {
  while (node[v].*next != kNoVertex && node[node[v].*next].num_below == kMerged)
    node[v].*next = node[node[v].*next].*next;
  return node[v].*next;
}

/// Merges a vertex that is a leaf of one tree and on a path of the other: its only arc left is that of the leaf.
/// Returns the other end of the arc, kNoVertex if v is no such vertex.
std::uint32_t merge_leaf(std::vector<Node>& node, std::uint32_t v) {
  if (node[v].num_below == 0 && node[v].num_above == 1) {
    const std::uint32_t w = skip_merged(node, v, &Node::up);
    if (w == kNoVertex) return kNoVertex;
    --node[w].num_below;
    node[v].num_below = kMerged;
    return w;
  }
  if (node[v].num_above == 0 && node[v].num_below == 1) {
    const std::uint32_t w = skip_merged(node, v, &Node::down);
    if (w == kNoVertex) return kNoVertex;
    --node[w].num_above;
    node[v].num_below = kMerged;
    return w;
  }
  return kNoVertex;
}

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
  return join_tree(graph, ascending, rank, std::move(up));
}

Ids split_tree(const VertexGraph& graph, std::span<const std::uint32_t> ascending) {
  assert(ascending.size() == graph.num_vertices() && "all vertices");
  const Ids rank = ranks_of(ascending);
  Basins down;
  find_basins<false, true>(graph, rank, nullptr, &down);
  return split_tree(graph, ascending, rank, std::move(down));
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
      const Ids up = join_tree(graph, tree.ascending, rank, std::move(joining));
      node.resize(n);
      for (std::uint32_t v = 0; v < n; ++v) {
        node[v].up = up[v];
        if (up[v] != kNoVertex) ++node[up[v]].num_below;
      }
    }
    const Ids down = split_tree(graph, tree.ascending, rank, std::move(splitting));
    for (std::uint32_t v = 0; v < n; ++v) {
      node[v].down = down[v];
      if (down[v] != kNoVertex) ++node[down[v]].num_above;
    }
  }
  tree.other.assign(n, kNoVertex);
  for (std::uint32_t seed = 0; seed < n; ++seed) {
    if (node[seed].num_below == kMerged) continue;
    for (std::uint32_t v = seed; v != kNoVertex;) {
      const std::uint32_t w = merge_leaf(node, v);
      if (w != kNoVertex) {
        tree.other[v] = w;
        --num_left;
      }
      v = w;
    }
  }
  // What is left of a tree is one vertex; a cycle leaves more.
  for (std::uint32_t v = 0; v < n; ++v)
    if (node[v].num_below == 0 && node[v].num_above == 0) --num_left;
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
