#include "hydrotin/polygon_batch.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>
#include <numeric>

namespace hydrotin {

PolygonCandidates candidates_by_polygon(const Subdivision& subdivision, const OrderKTriangles& triangles) {
  PolygonCandidates out;
  out.begin.resize(subdivision.size() + 1);
  const auto polygon = [&](std::uint32_t c) { return subdivision.polygon[triangle_of(triangles.entry[c]).value]; };
  for (std::uint32_t c = 0; c < triangles.size(); ++c) ++out.begin[polygon(c) + 1];
  std::partial_sum(out.begin.begin(), out.begin.end(), out.begin.begin());
  out.candidate.resize(triangles.size());
  std::vector<std::uint32_t> at(out.begin.begin(), out.begin.end() - 1);
  for (std::uint32_t c = 0; c < triangles.size(); ++c) out.candidate[at[polygon(c)]++] = c;
  return out;
}

namespace {

// What the vertices that a polygon is to save want of it: bits.
constexpr std::uint8_t kServed = 1;    // some have what they want from the Delaunay triangles
constexpr std::uint8_t kUnserved = 2;  // some have not

}  // namespace

namespace {

constexpr std::uint32_t kVertexRange = 1U << 14;

class Chooser {
 public:
  Chooser(const TriangulationView& triangulation, const VertexLinks& links, std::span<const std::int32_t> height,
          const Crossings& crossings, const Subdivision& subdivision, const MinimaAssignment& assignment)
      : tri_(triangulation),
        links_(links),
        height_(height),
        crossings_(crossings),
        subdivision_(subdivision),
        assignment_(assignment),
        wish_(subdivision.size()) {}

  // Notes what v wants of the polygon that is to save it.
  void look_at(VertexId v) {
    const TriangleId where = assignment_.where[v.value];
    if (where.is_none()) return;
    const std::uint32_t f = subdivision_.polygon[where.value];
    // Vertices of several ranges may lie in one polygon.
    const std::atomic_ref<std::uint8_t> wish(wish_[f]);
    if (wish.load(std::memory_order_relaxed) & kUnserved) return;
    wish.fetch_or(delaunay_serves(v, f) ? kServed : kUnserved, std::memory_order_relaxed);
  }

  [[nodiscard]] bool is_to_solve(std::uint32_t f) const {
    return (wish_[f] & kUnserved) || (wish_[f] == kServed && has_repeated_vertices(f));
  }

 private:
  // Whether an inner Delaunay edge of polygon f leads down from v.
  [[nodiscard]] bool delaunay_serves(VertexId v, std::uint32_t f) const {
    for (std::uint32_t i = links_.begin[v.value]; i < links_.begin[v.value + 1]; ++i) {
      const HalfedgeId spoke = links_.spoke[i];
      if (spoke.is_none() || !crossings_.crossed[spoke.value]) continue;
      const VertexId w = links_.neighbor[i];
      if (is_lower(height_[w.value], tri_.position[w], height_[v.value], tri_.position[v]) &&
          subdivision_.polygon[triangle_of(spoke).value] == f)
        return true;
    }
    return false;
  }

  // Whether the dynamic program for f counts a vertex more than once, on a slit or where f touches itself: then it may
  // prefer another triangulation.
  [[nodiscard]] bool has_repeated_vertices(std::uint32_t f) const {
    const auto triangles = subdivision_.triangles_of(f);
    if (subdivision_.components[f] > 0) return true;
    if (triangles.size() < 3) return false;
    std::vector<VertexId> vertices;
    for (const TriangleId t : triangles)
      for (HalfedgeId h = first_halfedge(t); triangle_of(h) == t; ++h.value) vertices.push_back(tri_.origin[h]);
    std::sort(vertices.begin(), vertices.end());
    const auto num_vertices = std::unique(vertices.begin(), vertices.end()) - vertices.begin();
    return static_cast<std::size_t>(num_vertices) != triangles.size() + 2;
  }

  TriangulationView tri_;
  const VertexLinks& links_;
  std::span<const std::int32_t> height_;
  const Crossings& crossings_;
  const Subdivision& subdivision_;
  const MinimaAssignment& assignment_;
  std::vector<std::uint8_t> wish_;  // [F] of the vertices that it is to save
};

}  // namespace

std::vector<std::uint8_t> polygons_to_solve(const TriangulationView& tri, const VertexLinks& links,
                                            std::span<const std::int32_t> height, const Crossings& crossings,
                                            const Subdivision& subdivision, Objective objective,
                                            const MinimaAssignment* assignment, const Executor& executor) {
  std::vector<std::uint8_t> out(subdivision.size());
  if (objective == Objective::delaunay) return out;
  if (objective != Objective::local_minima) {
    for (std::uint32_t f = 0; f < out.size(); ++f) out[f] = subdivision.triangles_of(f).size() > 1;
    return out;
  }
  Chooser chooser(tri, links, height, crossings, subdivision, *assignment);
  for_ranges(executor, tri.num_vertices(), kVertexRange, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t v = begin; v < end; ++v) chooser.look_at(VertexId{v});
  });
  for_ranges(executor, subdivision.size(), kVertexRange, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t f = begin; f < end; ++f) out[f] = chooser.is_to_solve(f);
  });
  return out;
}

EdgesByPolygon edges_by_polygon(const Subdivision& subdivision, const UsefulEdges& edges,
                                std::span<const std::uint8_t> wanted) {
  EdgesByPolygon out;
  out.begin.resize(subdivision.size() + 1);
  const auto for_runs = [&](auto visit) {
    std::uint32_t before = static_cast<std::uint32_t>(-1);
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
      const std::uint32_t f = EdgesByPolygon::polygon_of(e, subdivision, edges);
      if (f != before && wanted[f]) visit(f, e);
      before = f;
    }
  };
  for_runs([&](std::uint32_t f, std::uint32_t) { ++out.begin[f + 1]; });
  std::partial_sum(out.begin.begin(), out.begin.end(), out.begin.begin());
  out.first.resize(out.begin.back());
  std::vector<std::uint32_t> at(out.begin.begin(), out.begin.end() - 1);
  for_runs([&](std::uint32_t f, std::uint32_t e) { out.first[at[f]++] = e; });
  return out;
}

namespace {

// Solves a range of polygons; `problem_of(f)` cuts one out.
template <class ProblemOf>
BatchFigures solve_range(const PolygonSource& source, std::span<const std::uint8_t> to_solve, std::uint32_t begin,
                         std::uint32_t end, const PolygonExtractor& extractor, PolygonSolver& solver,
                         std::span<std::array<VertexId, 3>> triangles, ProblemOf problem_of) {
  const TriangulationView& tri = source.triangulation;
  BatchFigures figures;
  std::vector<std::array<std::uint32_t, 3>> answer;
  for (std::uint32_t f = begin; f < end; ++f) {
    auto* out = triangles.data() + source.subdivision.begin[f];
    if (!to_solve[f]) {
      for (const TriangleId t : source.subdivision.triangles_of(f)) {
        const HalfedgeId h = first_halfedge(t);
        *out++ = {tri.origin[h], tri.target(h), tri.apex(h)};
      }
      continue;
    }
    answer.clear();
    const PolygonResult result = solver.solve(problem_of(f), answer);
    assert(answer.size() == source.subdivision.triangles_of(f).size());
    const auto vertex = extractor.vertices();
    for (const auto& t : answer) *out++ = {vertex[t[0]], vertex[t[1]], vertex[t[2]]};
    figures.max_order = std::max(figures.max_order, result.max_order);
    figures.fallbacks += result.fell_back;
  }
  return figures;
}

}  // namespace

BatchFigures solve_polygons(const PolygonSource& source, std::span<const std::uint8_t> to_solve, std::uint32_t begin,
                            std::uint32_t end, PolygonExtractor& extractor, PolygonSolver& solver,
                            std::span<std::array<VertexId, 3>> triangles) {
  return solve_range(source, to_solve, begin, end, extractor, solver, triangles,
                     [&](std::uint32_t f) -> const PolygonProblem& { return extractor.extract(f); });
}

BatchFigures solve_polygons(const PolygonSource& source, std::span<const std::uint8_t> to_solve,
                            const UsefulEdges& edges, const EdgesByPolygon& edges_of, std::uint32_t begin,
                            std::uint32_t end, PolygonExtractor& extractor, PolygonSolver& solver,
                            std::span<std::array<VertexId, 3>> triangles) {
  const OrderKTriangleFinder finder(source.triangulation, edges);
  OrderKTriangles others;
  return solve_range(
      source, to_solve, begin, end, extractor, solver, triangles, [&](std::uint32_t f) -> const PolygonProblem& {
        others.clear();
        edges_of.for_each(f, source.subdivision, edges, [&](std::uint32_t e) { finder.visit(e, others); });
        return extractor.extract(f, others);
      });
}

PolygonExtractor::PolygonExtractor(const PolygonSource& source) : source_(source) {}

void PolygonExtractor::make_slots(std::size_t num_vertices) {
  slot_.assign(std::bit_ceil(2 * num_vertices), Numbered{});
  for (std::uint32_t number = 0; number < vertices_.size(); ++number)
    slot_[slot_of(vertices_[number])] = {vertices_[number], number};
}

// Where the vertex stands, or the free place where it would.
inline std::size_t PolygonExtractor::slot_of(VertexId v) const {
  const std::size_t mask = slot_.size() - 1;
  std::size_t i = (v.value * std::uint64_t{0x9e3779b97f4a7c15U} >> 32) & mask;
  while (slot_[i].vertex != v && !slot_[i].vertex.is_none()) i = (i + 1) & mask;
  return i;
}

inline std::uint32_t PolygonExtractor::local(VertexId v) {
  const Numbered& slot = slot_[slot_of(v)];
  return slot.vertex == v ? slot.local : add_vertex(v);
}

std::uint32_t PolygonExtractor::add_vertex(VertexId v) {
  const auto number = static_cast<std::uint32_t>(vertices_.size());
  slot_[slot_of(v)] = {v, number};
  vertices_.push_back(v);
  position_.push_back(source_.triangulation.position[v]);
  height_.push_back(source_.height[v.value]);
  // The triangles of a piece of a polygon may have corners in other pieces.
  if (2 * vertices_.size() > slot_.size()) make_slots(2 * vertices_.size());
  return number;
}

void PolygonExtractor::extract_delaunay(std::uint32_t f) {
  const TriangulationView& tri = source_.triangulation;
  vertices_.clear();
  make_slots(source_.subdivision.triangles_of(f).size() + 2);  // a polygon of T triangles has at most T + 2 vertices
  position_.clear();
  height_.clear();
  fixed_.clear();
  delaunay_.clear();
  others_.clear();
  others_order_.clear();
  edge_before_ = {};
  for (const TriangleId t : source_.subdivision.triangles_of(f)) {
    const HalfedgeId h = first_halfedge(t);
    delaunay_.push_back({local(tri.origin[h]), local(tri.target(h)), local(tri.apex(h))});
    std::uint8_t mask = 0;
    for (std::uint32_t i = 0; i < 3; ++i)
      if (!source_.crossings.crossed[h.value + i]) mask = static_cast<std::uint8_t>(mask | 1U << i);
    fixed_.push_back(mask);
  }
}

// The triangles of one edge come one after the other, their first two corners on it, and so do the edges of a vertex.
void PolygonExtractor::add_other(const std::array<VertexId, 3>& triangle, std::uint8_t order) {
  const auto on_edge = [&](VertexId v) {
    if (v == edge_before_[0].vertex) return edge_before_[0];
    if (v == edge_before_[1].vertex) return edge_before_[1];
    return Numbered{v, local(v)};
  };
  edge_before_ = {on_edge(triangle[0]), on_edge(triangle[1])};
  others_.push_back({edge_before_[0].local, edge_before_[1].local, local(triangle[2])});
  others_order_.push_back(order);
}

const PolygonProblem& PolygonExtractor::finish(std::uint32_t f) {
  wants_lower_.assign(vertices_.size(), 0);
  if (source_.assignment)
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      const TriangleId where = source_.assignment->where[vertices_[i].value];
      if (!where.is_none() && source_.subdivision.polygon[where.value] == f) wants_lower_[i] = 2;
    }
  problem_ = {position_, height_, wants_lower_,  delaunay_,
              fixed_,    others_, others_order_, source_.subdivision.components[f]};
  if (source_.reference) add_reference(f);
  if (!source_.base_degree.empty()) {
    base_degree_.clear();
    for (const VertexId v : vertices_) base_degree_.push_back(source_.base_degree[v.value]);
    problem_.base_degree = base_degree_;
  }
  return problem_;
}

void PolygonExtractor::add_reference(std::uint32_t f) {
  reference_.clear();
  const auto triangles = source_.subdivision.triangles_of(f);
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (ReferencePoint p : source_.reference->of(triangles[t].value)) {
      p.triangle = t;
      reference_.push_back(p);
    }
  problem_.reference = reference_;
}

const PolygonProblem& PolygonExtractor::adopt(std::span<const VertexId> vertices) {
  for (std::size_t i = 0; i < vertices_.size(); ++i)
    if (wants_lower_[i] == 0 && std::find(vertices.begin(), vertices.end(), vertices_[i]) != vertices.end())
      wants_lower_[i] = 1;
  return problem_;
}

const PolygonProblem& PolygonExtractor::extract(std::uint32_t f) {
  extract_delaunay(f);
  for (std::uint32_t i = source_.candidates.begin[f]; i < source_.candidates.begin[f + 1]; ++i) {
    const std::uint32_t c = source_.candidates.candidate[i];
    add_other(source_.triangles.vertices[c], source_.triangles.order[c]);
  }
  return finish(f);
}

const PolygonProblem& PolygonExtractor::extract(std::uint32_t f, const OrderKTriangles& others) {
  extract_delaunay(f);
  for (std::uint32_t c = 0; c < others.size(); ++c) add_other(others.vertices[c], others.order[c]);
  return finish(f);
}

}  // namespace hydrotin
