#include "hydrotin/point_set.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hydrotin/evaluate.h"
#include "point_set_polygons.h"

namespace hydrotin {
namespace {

bool contains(const Objectives& objectives, Objective objective) {
  return std::find(objectives.begin(), objectives.end(), objective) != objectives.end();
}

// Edges at each vertex that are in every triangulation.
std::vector<std::uint32_t> fixed_degrees(const PointSetGround& ground) {
  std::vector<std::uint32_t> degree(ground.tri.num_vertices(), 0);
  for (std::uint32_t v = 0; v < degree.size(); ++v)
    for (std::uint32_t i = ground.links.begin[v]; i < ground.links.begin[v + 1]; ++i) {
      const HalfedgeId spoke = ground.links.spoke[i];
      degree[v] += spoke.is_none() || !ground.crossings.crossed[spoke.value];
    }
  return degree;
}

PolygonSource source_of(const PointSetGround& ground, const PointSetOptions& options) {
  PolygonSource source{ground.tri,         ground.height,    ground.crossings,
                       ground.subdivision, ground.triangles, ground.candidates};
  if (contains(options.polygon.objectives, Objective::local_minima)) source.assignment = &ground.assignment;
  if (!ground.reference.point.empty()) source.reference = &ground.reference;
  source.base_degree = ground.base_degree;
  return source;
}

// The value of the first objective that stands for a score of polygons and pairs.
double measure(Objective objective, double score) {
  return objective == Objective::max_convex_edges ? -score : measure_of_score(objective, score);
}

double value_of(Objective objective, const PointSetTriangulation& out, const Surface& surface) {
  switch (objective) {
    case Objective::min_squared_error:
      return out.error.squared.value();
    case Objective::min_absolute_error:
      return out.error.absolute.value();
    case Objective::min_max_error:
      return out.error.largest;
    case Objective::min_max_order:
      return out.max_order;
    default:
      return evaluate(objective, surface);
  }
}

void add_figures(const PointSetGround& ground, const PointSetPolygons& polygons, PointSetTriangulation& out) {
  out.polygons = polygons.size();
  for (std::uint32_t f = 0; f < polygons.size(); ++f) {
    const PolygonResult& result = polygons.result(f);
    out.max_order = std::max(out.max_order, result.max_order);
    out.fallbacks += result.fell_back;
    out.limit_missed += result.limit_missed;
    out.max_polygon = std::max(out.max_polygon, static_cast<std::uint32_t>(polygons.answer(f).size()));
    out.components += ground.subdivision.components[f];
    out.max_components = std::max(out.max_components, ground.subdivision.components[f]);
    out.error.add(result.error);
  }
  out.error.add(ground.reference.vertex_error);
  out.reference_outside = ground.reference.outside;
  out.reference_at_vertices = ground.reference.at_vertices;
  out.vertices_beyond_limit = ground.reference.beyond_limit;
}

// Vertices that no triangulation can save: no edge leads down, or none of an admissible triangle.
std::size_t minima_bound(const PointSetGround& ground, const PointSetPolygons& polygons, bool limited) {
  const auto& fate = ground.assignment.fate;
  const auto always = std::count(fate.begin(), fate.end(), MinimumFate::always);
  if (!limited) return static_cast<std::size_t>(always);
  std::vector<std::uint8_t> can(fate.size(), 0);
  for (const VertexId v : polygons.servable()) can[v.value] = 1;
  std::size_t hopeless = static_cast<std::size_t>(always);
  for (std::size_t v = 0; v < fate.size(); ++v) hopeless += fate[v] == MinimumFate::assigned && !can[v];
  return hopeless;
}

void judge(const PointSetGround& ground, const PointSetOptions& options, const PointSetPolygons& polygons,
           double pair_bound, PointSetTriangulation& out) {
  const Objective first = options.polygon.objectives.front();
  bool all_optimal = true;
  double gap = 0, bound = pair_bound;
  for (std::uint32_t f = 0; f < polygons.size(); ++f) {
    const PolygonResult& result = polygons.result(f);
    all_optimal = all_optimal && result.optimal;
    gap += result.gap;
    bound = std::max(bound, result.bound);
  }
  switch (kind_of(first)) {
    case ObjectiveKind::none:
      out.optimal = true;
      break;
    case ObjectiveKind::minima:
      out.bound = static_cast<double>(minima_bound(ground, polygons, options.polygon.max_error.has_value()));
      out.optimal = out.value() == out.bound;
      break;
    case ObjectiveKind::sum:
      out.optimal = all_optimal;
      // Every inner edge is counted from both sides.
      if (first == Objective::min_weight) gap /= 2;
      out.bound = is_maximised(first) ? out.value() + gap : out.value() - gap;
      break;
    case ObjectiveKind::quadrilateral_sum:
      out.bound = -pair_bound;
      out.optimal = out.value() == out.bound;
      break;
    case ObjectiveKind::degree:
      out.bound = bound;
      out.optimal = out.value() == out.bound;
      break;
    case ObjectiveKind::bottleneck:
      if (needs_reference(first)) bound = std::max(bound, ground.reference.vertex_error.largest);
      out.optimal = all_optimal;
      out.bound = all_optimal ? out.value() : measure(first, bound);
      break;
    case ObjectiveKind::quadrilateral_bottleneck:
      out.bound = std::min(out.value(), bound);
      out.optimal = out.value() == out.bound;
      break;
  }
}

}  // namespace

PointSetGround::PointSetGround(std::span<const LatticePoint> position, std::span<const std::int32_t> heights,
                               const PointSetOptions& options, const ReferenceSet& set)
    : owner(delaunay(position)), tri(owner.view()), height(heights) {
  if (tri.num_triangles() == 0) return;
  const int k = options.order;
  links = vertex_links(tri);
  edges = useful_edges(tri, links, k);
  triangles = order_k_triangles(tri, edges);
  crossings = find_crossings(tri, edges);
  subdivision = subdivide(tri, crossings.crossed);
  candidates = candidates_by_polygon(subdivision, triangles);
  const Objectives& objectives = options.polygon.objectives;
  if (contains(objectives, Objective::local_minima)) assignment = assign_minima(tri, links, edges, crossings, height);
  if (!set.position.empty()) {
    const auto& limit = options.polygon.max_error;
    reference = locate_reference(tri, height, set.position, set.height, limit ? &*limit : nullptr);
  }
  if (contains(objectives, Objective::min_max_degree)) base_degree = fixed_degrees(*this);
}

PointSetPolygons::PointSetPolygons(const PointSetGround& ground, const PointSetOptions& options)
    : ground_(ground), source_(source_of(ground, options)), extractor_(source_), solver_(options.polygon) {
  result_.resize(size());
}

void PointSetPolygons::solve_all() {
  answer_.reserve(ground_.tri.num_triangles());
  for (std::uint32_t f = 0; f < size(); ++f) {
    const std::size_t first = answer_.size();
    result_[f] = solver_.solve(extractor_.extract(f), answer_);
    for (std::size_t t = first; t < answer_.size(); ++t)
      for (auto& v : answer_[t]) v = extractor_.vertices()[v].value;
    for (const std::uint32_t v : solver_.unserved()) unserved_.push_back(extractor_.vertices()[v]);
    for (const std::uint32_t v : solver_.servable()) servable_.push_back(extractor_.vertices()[v]);
  }
}

void PointSetPolygons::keep(std::uint32_t f, const PolygonResult& result) {
  result_[f] = result;
  auto out = answer_.begin() + ground_.subdivision.begin[f];
  for (auto t : scratch_) {
    for (auto& v : t) v = extractor_.vertices()[v].value;
    *out++ = t;
  }
}

void PointSetPolygons::adopt(std::uint32_t f, std::span<const VertexId> vertices) {
  extractor_.extract(f);
  const PolygonProblem& problem = extractor_.adopt(vertices);
  scratch_.clear();
  const PolygonResult result = solver_.solve(problem, scratch_);
  if (result.served >= result_[f].served) keep(f, result);
}

bool PointSetPolygons::solve_within(std::uint32_t f, const Surroundings& surroundings) {
  PolygonProblem problem = extractor_.extract(f);
  problem.beyond = surroundings.beyond;
  std::vector<std::uint32_t> base;
  if (!surroundings.degree.empty()) {
    for (const VertexId v : extractor_.vertices()) base.push_back(surroundings.degree[v.value]);
    problem.base_degree = base;
  }
  scratch_.clear();
  const PolygonResult result = solver_.solve(problem, scratch_);
  const PolygonResult before = result_[f];
  const auto sorted = [](std::span<const std::array<std::uint32_t, 3>> triangles) {
    std::vector<std::array<std::uint32_t, 3>> out(triangles.begin(), triangles.end());
    for (auto& t : out) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(out.begin(), out.end());
    return out;
  };
  const auto old = sorted(answer(f));
  keep(f, result);
  // Bounds stay those of the polygon alone.
  result_[f].bound = before.bound;
  result_[f].gap = before.gap;
  result_[f].optimal = before.optimal;
  return sorted(answer(f)) != old;
}

std::uint32_t count_minima(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                           std::span<const std::array<std::uint32_t, 3>> triangles) {
  return static_cast<std::uint32_t>(evaluate(Objective::local_minima, {position, height, triangles}));
}

PointSetTriangulation triangulate(std::span<const LatticePoint> position, std::span<const std::int32_t> height,
                                  const PointSetOptions& options, const ReferenceSet& reference) {
  PointSetTriangulation out;
  const PointSetGround ground(position, height, options, reference);
  if (ground.tri.num_triangles() == 0) return out;
  PointSetPolygons polygons(ground, options);
  polygons.solve_all();
  const Objectives& objectives = options.polygon.objectives;
  const ObjectiveKind kind = kind_of(objectives.front());
  if (contains(objectives, Objective::local_minima)) repair_minima(ground, polygons);
  double pair_bound = -std::numeric_limits<double>::infinity();
  if (kind == ObjectiveKind::quadrilateral_bottleneck || kind == ObjectiveKind::quadrilateral_sum)
    pair_bound = couple_pairs(ground, options, polygons);
  if (kind == ObjectiveKind::degree) couple_degrees(ground, polygons);
  out.triangles = polygons.answers();
  add_figures(ground, polygons, out);
  const Surface surface{position, height, out.triangles, options.polygon.z_per_xy};
  for (const Objective objective : objectives) out.values.push_back(value_of(objective, out, surface));
  judge(ground, options, polygons, pair_bound, out);
  return out;
}

PointSetTriangulation triangulate(std::span<const LatticePoint> position, std::span<const std::int32_t> height, int k,
                                  Objective objective) {
  return triangulate(position, height, PointSetOptions{.order = k, .polygon = {.objectives = {objective}}});
}

}  // namespace hydrotin
