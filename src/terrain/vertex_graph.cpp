#include "hydrotin/vertex_graph.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

namespace hydrotin {
namespace {

using Ids = std::vector<std::uint32_t>;

// In every triangle each corner is once the origin and once the target of an edge: lists of outgoing and of incoming
// edges have the same lengths and share their offsets.
Ids count_corners(std::uint32_t num_vertices, std::span<const std::uint32_t> triangle_vertex) {
  Ids begin(std::size_t{num_vertices} + 1, 0);
  for (const std::uint32_t v : triangle_vertex) {
    assert(v < num_vertices && "a triangle names a vertex beyond num_vertices");
    ++begin[std::size_t{v} + 1];
  }
  for (std::size_t v = 0; v < num_vertices; ++v) begin[v + 1] += begin[v];
  return begin;
}

Ids outgoing(const Ids& begin, std::span<const std::uint32_t> triangle_vertex) {
  Ids cursor(begin.begin(), begin.end() - 1);
  Ids target(triangle_vertex.size());
  for (std::size_t t = 0; t + 3 <= triangle_vertex.size(); t += 3) {
    const std::uint32_t a = triangle_vertex[t], b = triangle_vertex[t + 1], c = triangle_vertex[t + 2];
    target[cursor[a]++] = b;
    target[cursor[b]++] = c;
    target[cursor[c]++] = a;
  }
  return target;
}

// Reverses all edges. Origins are visited in ascending order, so the lists of the result are ascending: two
// transpositions sort all lists in linear time.
void transpose(const Ids& begin, const Ids& target, Ids& origin) {
  Ids cursor(begin.begin(), begin.end() - 1);
  origin.resize(target.size());
  for (std::uint32_t v = 0; v + 1 < begin.size(); ++v)
    for (std::uint32_t i = begin[v]; i < begin[v + 1]; ++i) origin[cursor[target[i]]++] = v;
}

// Directed edges v -> w of `out` that have no w -> v, which would be a w in the incoming list of v. Both lists ascend.
std::vector<DirectedEdge> edges_without_twin(const Ids& begin, const Ids& out, const Ids& in) {
  std::vector<DirectedEdge> single;
  for (std::uint32_t v = 0; v + 1 < begin.size(); ++v) {
    const auto first = out.begin() + begin[v], last = out.begin() + begin[v + 1];
    if (std::equal(first, last, in.begin() + begin[v])) continue;
    std::uint32_t j = begin[v];
    for (auto w = first; w != last; ++w) {
      if (w != first && *w == *(w - 1)) continue;
      while (j < begin[v + 1] && in[j] < *w) ++j;
      if (j == begin[v + 1] || in[j] != *w) single.push_back({v, *w});
    }
  }
  return single;
}

}  // namespace

VertexGraph make_vertex_graph(std::uint32_t num_vertices, std::span<const std::uint32_t> triangle_vertex) {
  assert(triangle_vertex.size() % 3 == 0 && "three vertices per triangle");
  assert(triangle_vertex.size() < (std::size_t{1} << 31) && "offsets are 32-bit");
  VertexGraph graph;
  Ids corner_begin = count_corners(num_vertices, triangle_vertex);
  Ids in;
  {
    Ids out = outgoing(corner_begin, triangle_vertex);
    transpose(corner_begin, out, in);
    transpose(corner_begin, in, out);
    graph.boundary = edges_without_twin(corner_begin, out, in);
  }
  // Neighbours of v: its incoming origins, and the targets of its outgoing edges without twin.
  graph.begin.resize(std::size_t{num_vertices} + 1);
  graph.neighbor.resize(triangle_vertex.size() + graph.boundary.size());
  std::uint32_t filled = 0;
  auto single = graph.boundary.begin();
  for (std::uint32_t v = 0; v < num_vertices; ++v) {
    graph.begin[v] = filled;
    const auto first = in.begin() + corner_begin[v], last = in.begin() + corner_begin[v + 1];
    const auto append = [&, start = filled](std::uint32_t w) {
      if (filled == start || graph.neighbor[filled - 1] != w) graph.neighbor[filled++] = w;
    };
    for (auto u = first; u != last; ++u) {
      for (; single != graph.boundary.end() && single->origin == v && single->target < *u; ++single)
        append(single->target);
      append(*u);
    }
    for (; single != graph.boundary.end() && single->origin == v; ++single) append(single->target);
  }
  graph.begin[num_vertices] = filled;
  graph.neighbor.resize(filled);  // shorter only if an edge was used twice in one direction
  return graph;
}

}  // namespace hydrotin
