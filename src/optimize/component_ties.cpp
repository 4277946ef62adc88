#include "component_ties.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "hydrotin/predicates.h"

namespace hydrotin {
namespace {

// Rightmost vertices of the components that do not hang on the outer boundary, in (x, y) order.
std::vector<std::uint32_t> component_ends(const PolygonProblem& problem) {
  const auto n = static_cast<std::uint32_t>(problem.position.size());
  std::vector<std::uint32_t> root(n);
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (std::size_t t = 0; t < problem.delaunay.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      if (problem.fixed[t] >> i & 1U) root[find(problem.delaunay[t][i])] = find(problem.delaunay[t][(i + 1) % 3]);
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

void add_ties(const PolygonProblem& problem, const PolygonGraph& graph, std::uint32_t u, ComponentTies& out) {
  const auto at = [&](std::uint32_t v) { return problem.position[v]; };
  std::uint32_t v = kNoEdge;
  for (const auto& t : problem.delaunay)
    for (std::size_t i = 0; i < 3; ++i)
      for (const std::uint32_t w : {t[(i + 1) % 3], t[(i + 2) % 3]})
        if (t[i] == u && at(u) < at(w) && (v == kNoEdge || at(w) < at(v))) v = w;
  assert(v != kNoEdge && "the region right of a component belongs to the polygon");
  std::vector<std::uint32_t> ends;
  for (const auto& t : problem.others)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t x = t[(i + 1) % 3], y = t[(i + 2) % 3];
      if (t[i] == u && properly_cross(at(u), at(v), at(x), at(y))) ends.push_back(at(x) < at(y) ? y : x);
    }
  std::sort(ends.begin(), ends.end(), [&](std::uint32_t a, std::uint32_t b) { return at(a) < at(b); });
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  std::erase(ends, v);
  out.tie.push_back({graph.find(u, v), graph.find(v, u)});
  for (const std::uint32_t z : ends) out.tie.push_back({graph.find(u, z), graph.find(z, u)});
  out.begin.push_back(static_cast<std::uint32_t>(out.tie.size()));
}

}  // namespace

ComponentTies find_component_ties(const PolygonProblem& problem, const PolygonGraph& graph) {
  ComponentTies out;
  for (const std::uint32_t u : component_ends(problem)) add_ties(problem, graph, u, out);
  return out;
}

}  // namespace hydrotin
