#include "hydrotin/simple_polygon.h"

#include <algorithm>
#include <cmath>

#include "hydrotin/error.h"
#include "hydrotin/evaluate.h"
#include "hydrotin/predicates.h"
#include "polygon_candidates.h"

namespace hydrotin {
namespace {

// One attempt with the triangles of one order.
class Attempt {
 public:
  Attempt(const SoundPolygon& polygon, std::uint32_t k) : polygon_(polygon), all_(candidate_triangles(polygon, k)) {
    const auto first = std::upper_bound(all_.order.begin(), all_.order.end(), 0U) - all_.order.begin();
    num_delaunay_ = static_cast<std::size_t>(first);
    for (std::size_t t = num_delaunay_; t < all_.order.size(); ++t)
      order_.push_back(static_cast<std::uint8_t>(std::min(all_.order[t], 255U)));
    find_wishes();
    count_degrees();
  }

  PolygonResult solve(const PolygonOptions& options, std::span<const ReferencePoint> reference,
                      std::vector<std::array<std::uint32_t, 3>>& triangles) const {
    PolygonProblem problem;
    problem.position = polygon_.given.position;
    problem.height = polygon_.given.height;
    problem.wants_lower = wants_;
    problem.delaunay = std::span(all_.triangle).first(num_delaunay_);
    problem.others = std::span(all_.triangle).subspan(num_delaunay_);
    problem.others_order = order_;
    problem.components = polygon_.components;
    problem.reference = reference;
    problem.base_degree = degree_;
    problem.rim = polygon_.rim;
    problem.num_triangles = num_triangles();
    PolygonSolver solver(options);
    return solver.solve(problem, triangles);
  }

  // Of any triangulation, by Euler's formula.
  [[nodiscard]] std::uint32_t num_triangles() const {
    const auto n = static_cast<std::uint32_t>(polygon_.given.position.size());
    return 2 * (n - polygon_.given.boundary) + polygon_.given.boundary - 2;
  }

  // Vertices below which no edge leads that any triangulation has.
  [[nodiscard]] std::uint32_t hopeless() const {
    std::vector<std::uint8_t> has(wants_.size(), 0);
    for (const auto& t : all_.triangle)
      for (std::size_t i = 0; i < 3; ++i)
        for (const std::size_t j : {(i + 1) % 3, (i + 2) % 3}) has[t[i]] |= lower(t[j], t[i]);
    for (const auto& e : polygon_.rim) has[e[0]] |= lower(e[1], e[0]);
    return static_cast<std::uint32_t>(std::count(has.begin(), has.end(), std::uint8_t{0}));
  }

 private:
  [[nodiscard]] bool lower(std::uint32_t p, std::uint32_t q) const {
    const SimplePolygon& g = polygon_.given;
    return is_lower(g.height[p], g.position[p], g.height[q], g.position[q]);
  }

  void find_wishes() {
    wants_.assign(polygon_.given.position.size(), 2);
    for (const auto& e : polygon_.rim) wants_[lower(e[0], e[1]) ? e[1] : e[0]] = 0;
  }

  void count_degrees() {
    degree_.assign(polygon_.given.position.size(), 0);
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (const auto& e : polygon_.rim) edges.push_back({std::min(e[0], e[1]), std::max(e[0], e[1])});
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (const auto& e : edges) {
      ++degree_[e[0]];
      ++degree_[e[1]];
    }
  }

  const SoundPolygon& polygon_;
  CandidateTriangles all_;
  std::size_t num_delaunay_ = 0;
  std::vector<std::uint8_t> order_, wants_;
  std::vector<std::uint32_t> degree_;
};

// Reference points inside the polygon; those on its sides are on the rim.
struct PolygonReference {
  std::vector<ReferencePoint> point;
  std::uint64_t outside = 0, at_vertices = 0, beyond_limit = 0;
  TriangleError vertex_error;
};

class ReferenceSplit {
 public:
  explicit ReferenceSplit(const SoundPolygon& polygon) : polygon_(polygon) {
    for (std::uint32_t v = 0; v < polygon.given.position.size(); ++v) vertex_.push_back({polygon.given.position[v], v});
    std::sort(vertex_.begin(), vertex_.end());
  }

  void add(LatticePoint p, std::int32_t height, const ErrorLimit* limit, PolygonReference& out) const {
    const auto at = std::lower_bound(vertex_.begin(), vertex_.end(), std::pair{p, 0U});
    if (at != vertex_.end() && at->first == p) {
      ++out.at_vertices;
      const VerticalDistance distance{std::int64_t{height} - polygon_.given.height[at->second], 1};
      out.vertex_error.add(distance, limit);
      if (limit != nullptr && !limit->allows(distance)) ++out.beyond_limit;
      return;
    }
    bool inside = false, on_side = false;
    const auto& ring = polygon_.ring;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const LatticePoint a = polygon_.given.position[ring[i]], b = polygon_.given.position[ring[(i + 1) % ring.size()]];
      const int side = orientation(a, b, p);
      on_side = on_side || (side == 0 && std::min(a, b) <= p && p <= std::max(a, b));
      if ((a.y > p.y) != (b.y > p.y) && (b.y > a.y) == (side > 0)) inside = !inside;
    }
    if (inside || on_side)
      out.point.push_back({p, height, 0, on_side});
    else
      ++out.outside;
  }

 private:
  const SoundPolygon& polygon_;
  std::vector<std::pair<LatticePoint, std::uint32_t>> vertex_;
};

PolygonReference split_reference(const SoundPolygon& polygon, const ReferenceSet& set, const ErrorLimit* limit) {
  PolygonReference out;
  const ReferenceSplit split(polygon);
  for (std::size_t i = 0; i < set.position.size(); ++i) split.add(set.position[i], set.height[i], limit, out);
  return out;
}

double value_of(Objective objective, const PointSetTriangulation& out, const Surface& surface) {
  if (objective == Objective::min_squared_error) return out.error.squared;
  if (objective == Objective::min_absolute_error) return out.error.absolute;
  if (objective == Objective::min_max_error) return out.error.largest;
  if (objective == Objective::min_max_order) return out.max_order;
  return evaluate(objective, surface);
}

void judge(const Attempt& attempt, const PolygonOptions& options, const PolygonResult& result,
           PointSetTriangulation& out) {
  const Objective first = options.objectives.front();
  const double value = out.value();
  out.optimal = result.optimal && !result.limit_missed;
  out.bound = value;
  if (out.optimal) return;
  switch (kind_of(first)) {
    case ObjectiveKind::sum: {
      const double gap = first == Objective::min_weight ? result.gap / 2 : result.gap;
      out.bound = is_maximised(first) ? value + gap : value - gap;
      break;
    }
    case ObjectiveKind::quadrilateral_sum:
      out.bound = value + result.gap;
      break;
    case ObjectiveKind::minima:
      out.bound = attempt.hopeless();
      break;
    case ObjectiveKind::bottleneck:
      out.bound = measure_of_score(first, result.bound);
      break;
    case ObjectiveKind::degree:
    case ObjectiveKind::quadrilateral_bottleneck:
      out.bound = std::min(value, result.bound);
      break;
    case ObjectiveKind::none:
      out.optimal = true;
      break;
  }
  out.optimal = out.optimal || out.bound == value;
}

// The smallest order for which the polygon has a triangulation: doubled until there is one, then the least order in it.
std::uint32_t smallest_order(const SoundPolygon& polygon, std::uint32_t k) {
  const auto n = static_cast<std::uint32_t>(polygon.given.position.size());
  PolygonOptions options;
  options.objectives = {Objective::min_max_order};
  for (std::uint32_t next = std::max(2 * k, k + 1);; next *= 2) {
    const Attempt attempt(polygon, std::min(next, n));
    std::vector<std::array<std::uint32_t, 3>> triangles;
    const PolygonResult result = attempt.solve(options, {}, triangles);
    if (result.is_triangulated) return result.max_order;
    if (next >= n) throw Error(ErrorKind::check, "a simple polygon must have a triangulation of some order");
  }
}

}  // namespace

SimplePolygonTriangulation triangulate_polygon(const SimplePolygon& given, const PointSetOptions& options,
                                               const ReferenceSet& set) {
  const SoundPolygon polygon = check_polygon(given);
  SimplePolygonTriangulation out;
  const ErrorLimit* limit = options.polygon.max_error ? &*options.polygon.max_error : nullptr;
  const PolygonReference reference = split_reference(polygon, set, limit);
  const Attempt attempt(polygon, static_cast<std::uint32_t>(options.order));
  PointSetTriangulation& best = out.best;
  const PolygonResult result = attempt.solve(options.polygon, reference.point, best.triangles);
  if (!result.is_triangulated) {
    out.smallest_order = smallest_order(polygon, static_cast<std::uint32_t>(options.order));
    return out;
  }
  out.found = true;
  best.max_order = result.max_order;
  best.polygons = 1;
  best.max_polygon = static_cast<std::uint32_t>(best.triangles.size());
  best.components = best.max_components = polygon.components;
  best.fallbacks = result.fell_back;
  best.limit_missed = result.limit_missed;
  best.error = result.error;
  best.error.squared += reference.vertex_error.squared;
  best.error.absolute += reference.vertex_error.absolute;
  best.error.largest = std::max(best.error.largest, reference.vertex_error.largest);
  best.reference_outside = reference.outside;
  best.reference_at_vertices = reference.at_vertices;
  best.vertices_beyond_limit = reference.beyond_limit;
  const Surface surface{given.position, given.height, best.triangles, options.polygon.z_per_xy};
  for (const Objective objective : options.polygon.objectives)
    best.values.push_back(value_of(objective, best, surface));
  judge(attempt, options.polygon, result, best);
  return out;
}

}  // namespace hydrotin
