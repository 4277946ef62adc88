#include "component_ties.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

// Rightmost vertices of the components that do not hang on the outer boundary, in (x, y) order.
std::vector<std::uint32_t> component_ends(const PolygonProblem& problem, const PolygonGraph& graph) {
  const auto n = static_cast<std::uint32_t>(problem.position.size());
  std::vector<std::uint32_t> root(n);
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (std::uint32_t e = 0; e < graph.num_edges(); ++e)
    if (graph.edge(e).is_boundary) root[find(graph.edge(e).origin)] = find(graph.edge(e).target);
  const auto by_position = [&](std::uint32_t a, std::uint32_t b) { return problem.position[a] < problem.position[b]; };
  std::vector<std::uint32_t> order(n), end(n, kNoEdge), ends;
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), by_position);
  for (const std::uint32_t v : order) end[find(v)] = v;
  // The smallest vertex of a polygon lies on its outer boundary.
  for (std::uint32_t v = 0; v < n; ++v)
    if (end[v] != kNoEdge && v != find(order.front())) ends.push_back(end[v]);
  std::sort(ends.begin(), ends.end(), by_position);
  return ends;
}

// The ends of the ties of u, the first first.
std::vector<std::uint32_t> tie_ends(const PolygonProblem& problem, const PolygonGraph& graph, std::uint32_t u) {
  const auto at = [&](std::uint32_t v) { return problem.position[v]; };
  std::vector<std::uint32_t> ends;
  std::uint32_t v = kNoEdge;
  if (problem.rim.empty()) {
    for (const auto& t : problem.delaunay)
      for (std::size_t i = 0; i < 3; ++i)
        for (const std::uint32_t w : {t[(i + 1) % 3], t[(i + 2) % 3]})
          if (t[i] == u && at(u) < at(w) && (v == kNoEdge || at(w) < at(v))) v = w;
    assert(v != kNoEdge && "the region right of a component belongs to the polygon");
    for (const auto& t : problem.others)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t x = t[(i + 1) % 3], y = t[(i + 2) % 3];
        if (t[i] == u && properly_cross(at(u), at(v), at(x), at(y))) ends.push_back(at(x) < at(y) ? y : x);
      }
  } else {
    for (std::uint32_t e = 0; e < graph.num_edges(); ++e)
      if (graph.edge(e).origin == u && at(u) < at(graph.edge(e).target)) ends.push_back(graph.edge(e).target);
  }
  std::sort(ends.begin(), ends.end(), [&](std::uint32_t a, std::uint32_t b) { return at(a) < at(b); });
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  if (v != kNoEdge) {
    std::erase(ends, v);
    ends.insert(ends.begin(), v);
  }
  return ends;
}

std::vector<LatticeBox> boxes_of(const PolygonProblem& problem, const PolygonGraph& graph) {
  std::vector<LatticeBox> out(graph.num_triangles());
  for (std::uint32_t t = 0; t < graph.num_triangles(); ++t)
    for (const std::uint32_t v : graph.triangle(t)) out[t].extend(problem.position[v]);
  return out;
}

// Triangles that the segment ab properly cuts.
void add_blocked(const PolygonProblem& problem, const PolygonGraph& graph, const std::vector<LatticeBox>& reach,
                 LatticePoint a, LatticePoint b, std::vector<std::uint32_t>& out) {
  LatticeBox box;
  box.extend(a);
  box.extend(b);
  for (std::uint32_t t = 0; t < reach.size(); ++t) {
    if (!reach[t].intersects(box)) continue;
    const auto& v = graph.triangle(t);
    const std::array<LatticePoint, 3> p{problem.position[v[0]], problem.position[v[1]], problem.position[v[2]]};
    if (properly_cross(a, b, p[0], p[1]) || properly_cross(a, b, p[1], p[2]) || properly_cross(a, b, p[2], p[0]))
      out.push_back(t);
  }
}

}  // namespace

std::uint64_t ComponentTies::num_ways(std::uint64_t most) const {
  std::uint64_t ways = 1;
  for (std::uint32_t c = 0; c < num_components(); ++c) {
    ways *= begin[c + 1] - begin[c];
    if (ways > most) return most + 1;
  }
  return ways;
}

ComponentTies find_component_ties(const PolygonProblem& problem, const PolygonGraph& graph) {
  ComponentTies out;
  const std::vector<LatticeBox> reach = boxes_of(problem, graph);
  for (const std::uint32_t u : component_ends(problem, graph)) {
    for (const std::uint32_t w : tie_ends(problem, graph, u)) {
      const std::uint32_t tie = graph.find(u, w);
      out.tie.push_back({tie, PolygonGraph::twin(tie)});
      add_blocked(problem, graph, reach, problem.position[u], problem.position[w], out.blocked);
      out.blocked_begin.push_back(static_cast<std::uint32_t>(out.blocked.size()));
    }
    out.begin.push_back(static_cast<std::uint32_t>(out.tie.size()));
  }
  return out;
}

TieInfluence influence_of(const ComponentTies& ties, const PolygonGraph& graph) {
  TieInfluence out;
  std::vector<std::uint32_t> seen(graph.num_edges(), kNoEdge);
  for (std::uint32_t c = 0; c < ties.num_components(); ++c) {
    const auto reach = [&](std::uint32_t e) {
      if (seen[e] == c) return;
      seen[e] = c;
      out.edge.push_back(e);
    };
    for (std::uint32_t t = ties.begin[c]; t < ties.begin[c + 1]; ++t) {
      reach(ties.tie[t].edge);
      reach(ties.tie[t].twin);
      for (std::uint32_t i = ties.blocked_begin[t]; i < ties.blocked_begin[t + 1]; ++i)
        for (std::size_t side = 0; side < 3; ++side) reach(graph.side(ties.blocked[i], side));
    }
    // What depends on an edge: the other sides of the triangles beyond it.
    for (std::size_t i = out.begin.back(); i < out.edge.size(); ++i) {
      const std::uint32_t twin = PolygonGraph::twin(out.edge[i]);
      for (std::uint32_t o = graph.edge(twin).first_option; o != kNoEdge; o = graph.option(o).next)
        for (std::size_t side = 0; side < 3; ++side)
          if (const std::uint32_t e = graph.side(graph.option(o).triangle, side); e != twin) reach(e);
    }
    out.begin.push_back(static_cast<std::uint32_t>(out.edge.size()));
  }
  return out;
}

}  // namespace hydrotin
