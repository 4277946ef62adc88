#include "hydrotin/contour_tree.h"

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

/// One sweep: `sequence` visits the vertices, `before` tells which of two it visits first.
///
/// Sets of visited vertices are kept by union-find, whose first unions are known without any sweep: each vertex belongs
/// to the set of the earliest of its neighbours. These are made in the order of the ids, where neighbours lie near each
/// other in memory. Only a vertex whose earlier neighbours lie in several of these basins may join sets later.
template <class Sequence, class Before>
Ids merge_tree(const VertexGraph& graph, Sequence sequence, Before before) {
  const std::uint32_t n = graph.num_vertices();
  Ids parent(n);
  for (std::uint32_t v = 0; v < n; ++v) {
    std::uint32_t earliest = v;
    for (const std::uint32_t w : graph.neighbors(v))
      if (before(w, earliest)) earliest = w;
    parent[v] = earliest;
  }
  for (std::uint32_t v = 0; v < n; ++v) parent[v] = find(parent, v);
  std::vector<bool> may_join(n);
  for (std::uint32_t v = 0; v < n; ++v) {
    bool several = false;
    for (const std::uint32_t w : graph.neighbors(v)) several |= parent[w] != parent[v] && before(w, v);
    may_join[v] = several;
  }
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
    if (may_join[v]) {
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

Ids join_tree(const VertexGraph& graph, std::span<const std::uint32_t> ascending, const Ids& rank) {
  return merge_tree(
      graph, [&](std::uint32_t i) { return ascending[i]; },
      [&](std::uint32_t v, std::uint32_t w) { return rank[v] < rank[w]; });
}

Ids split_tree(const VertexGraph& graph, std::span<const std::uint32_t> ascending, const Ids& rank) {
  return merge_tree(
      graph, [&](std::uint32_t i) { return ascending[ascending.size() - 1 - i]; },
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
  return join_tree(graph, ascending, ranks_of(ascending));
}

Ids split_tree(const VertexGraph& graph, std::span<const std::uint32_t> ascending) {
  assert(ascending.size() == graph.num_vertices() && "all vertices");
  return split_tree(graph, ascending, ranks_of(ascending));
}

std::optional<ContourTree> contour_tree(const VertexGraph& graph, std::span<const std::int32_t> height,
                                        std::span<const LatticePoint> position) {
  assert(height.size() == graph.num_vertices() && position.size() == height.size() && "one entry per vertex");
  const std::uint32_t n = graph.num_vertices();
  ContourTree tree{{}, order_vertices(height, position)};
  std::vector<Node> node(n);
  std::uint32_t num_left = n;
  {
    const Ids rank = ranks_of(tree.ascending);
    {
      const Ids up = join_tree(graph, tree.ascending, rank);
      for (std::uint32_t v = 0; v < n; ++v) {
        node[v].up = up[v];
        if (up[v] != kNoVertex) ++node[up[v]].num_below;
      }
    }
    const Ids down = split_tree(graph, tree.ascending, rank);
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
