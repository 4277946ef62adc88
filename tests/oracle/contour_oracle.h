#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "hydrotin/lattice.h"

/// Contours from their definition: the level set between two vertices next to each other in the order (z, x, y)
/// consists of the edges that cross the level; two of them belong together if a triangle has both.
namespace hydrotin::oracle {

/// Arcs (lower, upper) of the Reeb graph of the terrain, by following each contour from level to level.
inline std::multiset<std::pair<std::uint32_t, std::uint32_t>> contour_arcs(const std::vector<std::uint32_t>& triangle,
                                                                           const std::vector<std::int32_t>& height,
                                                                           const std::vector<LatticePoint>& position) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  const auto n = static_cast<std::uint32_t>(height.size());
  std::set<std::tuple<std::int32_t, LatticePoint, std::uint32_t>> sorted;
  for (std::uint32_t v = 0; v < n; ++v) sorted.insert({height[v], position[v], v});
  std::vector<std::uint32_t> order, rank(n);
  for (const auto& [z, p, v] : sorted) {
    rank[v] = static_cast<std::uint32_t>(order.size());
    order.push_back(v);
  }
  std::multiset<Edge> arcs;
  std::set<std::pair<std::set<Edge>, std::uint32_t>> contours;  // edges crossed now, vertex it came from
  for (std::uint32_t level = 0; level < n; ++level) {
    const std::uint32_t v = order[level];
    std::set<Edge> crossing;
    for (std::size_t t = 0; t < triangle.size(); ++t) {
      std::uint32_t a = triangle[t], b = triangle[t - t % 3 + (t + 1) % 3];
      if (rank[a] > rank[b]) std::swap(a, b);
      if (rank[a] <= level && level < rank[b]) crossing.insert({a, b});
    }
    std::set<std::set<Edge>> pieces;
    for (const Edge& e : crossing) pieces.insert({e});
    for (std::size_t t = 0; t < triangle.size(); t += 3) {
      std::set<Edge> joined;
      std::set<std::set<Edge>> rest;
      for (const auto& piece : pieces) {
        bool touches = false;
        for (const Edge& e : piece) {
          int shared = 0;
          for (std::size_t i = 0; i < 3; ++i) shared += triangle[t + i] == e.first || triangle[t + i] == e.second;
          touches |= shared == 2;
        }
        if (touches)
          joined.insert(piece.begin(), piece.end());
        else
          rest.insert(piece);
      }
      if (!joined.empty()) rest.insert(joined);
      pieces = rest;
    }
    // Contours that touched v end there. A new one that keeps a crossing of an old one that did not is its
    // continuation.
    std::set<std::pair<std::set<Edge>, std::uint32_t>> next;
    for (const auto& [edges, from] : contours) {
      bool ends = false;
      for (const Edge& e : edges) ends |= e.second == v;
      if (ends) arcs.insert({from, v});
    }
    for (const auto& piece : pieces) {
      std::uint32_t from = v;
      for (const auto& [edges, old_from] : contours) {
        bool ends = false, same = false;
        for (const Edge& e : edges) {
          ends |= e.second == v;
          same |= piece.contains(e);
        }
        if (same && !ends) from = old_from;
      }
      next.insert({piece, from});
    }
    contours = next;
  }
  return arcs;
}

}  // namespace hydrotin::oracle
