#include "hydrotin/simple_polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "hydrotin/error.h"
#include "hydrotin/evaluate.h"
#include "hydrotin/predicates.h"
#include "polygon_candidates.h"

namespace hydrotin {
namespace {

// One face of the polygon: what lies between edges that must be there.
struct Face {
  std::vector<std::uint32_t> vertex;  // given numbers
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
  std::vector<std::uint8_t> wants;
  std::vector<std::uint32_t> degree;
  std::vector<std::array<std::uint32_t, 3>> triangle;  // by order
  std::vector<std::uint8_t> order;                     // of those from `num_delaunay` on
  std::size_t num_delaunay = 0;
  std::vector<std::array<std::uint32_t, 2>> rim;
  std::uint32_t components = 0;
};

std::uint64_t key(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{a} << 32 | b;
}

std::uint32_t find_root(std::vector<std::uint32_t>& root, std::uint32_t v) {
  while (root[v] != v) v = root[v] = root[root[v]];
  return v;
}

// One attempt with the triangles of one order.
class Attempt {
 public:
  Attempt(const SoundPolygon& polygon, std::uint32_t k) : polygon_(polygon), all_(candidate_triangles(polygon, k)) {
    find_wishes();
    count_degrees();
    cut_into_faces();
  }

  PolygonResult solve(const PolygonOptions& options, std::span<const ReferencePoint> reference,
                      std::vector<std::array<std::uint32_t, 3>>& triangles) const {
    PolygonSolver solver(options);
    PolygonResult total;
    total.bound = -std::numeric_limits<double>::infinity();
    for (const Face& face : faces_) {
      const std::size_t first = triangles.size();
      const PolygonResult result = solver.solve(problem(face, reference), triangles);
      total.is_triangulated = total.is_triangulated && result.is_triangulated;
      if (!result.is_triangulated) break;
      for (std::size_t t = first; t < triangles.size(); ++t)
        for (auto& v : triangles[t]) v = face.vertex[v];
      add(result, total);
    }
    if (triangles.size() != num_triangles()) total.is_triangulated = false;
    if (!total.is_triangulated) triangles.clear();
    const ObjectiveKind kind = kind_of(options.objectives.front());
    // Edges between faces couple what is not a matter of single triangles.
    if (faces_.size() > 1 && kind != ObjectiveKind::sum && kind != ObjectiveKind::bottleneck) total.optimal = false;
    if (kind == ObjectiveKind::quadrilateral_sum) total.gap += static_cast<double>(polygon_.given.edges.size());
    return total;
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
    for (const std::uint32_t v : polygon_.ring) degree_[v] += 2;
    for (const auto& e : polygon_.given.edges) {
      ++degree_[e[0]];
      ++degree_[e[1]];
    }
  }

  [[nodiscard]] std::unordered_set<std::uint64_t> rim_keys() const {
    std::unordered_set<std::uint64_t> rim;
    for (const auto& e : polygon_.rim) rim.insert(key(e[0], e[1]));
    return rim;
  }

  template <class Visit>
  static void for_sides(const std::array<std::uint32_t, 3>& t, Visit visit) {
    for (std::size_t i = 0; i < 3; ++i) visit(t[i], t[(i + 1) % 3]);
  }

  // Drops triangles with an edge that has nothing on its other side, again and again.
  void prune(const std::unordered_set<std::uint64_t>& rim) {
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> left;
    for (std::uint32_t t = 0; t < all_.triangle.size(); ++t)
      for_sides(all_.triangle[t], [&](std::uint32_t a, std::uint32_t b) { left[key(a, b)].push_back(t); });
    std::unordered_map<std::uint64_t, std::size_t> count;
    for (const auto& [edge, triangles] : left) count[edge] = triangles.size();
    std::vector<std::uint8_t> dead(all_.triangle.size(), 0);
    std::vector<std::uint32_t> stack;
    const auto kill = [&](std::uint32_t t) {
      if (std::exchange(dead[t], std::uint8_t{1}) == 0) stack.push_back(t);
    };
    for (const auto& [edge, triangles] : left) {
      const std::uint64_t twin = edge << 32 | edge >> 32;
      if (!rim.contains(edge) && !left.contains(twin))
        for (const std::uint32_t t : triangles) kill(t);
    }
    while (!stack.empty()) {
      const std::uint32_t t = stack.back();
      stack.pop_back();
      for_sides(all_.triangle[t], [&](std::uint32_t a, std::uint32_t b) {
        if (--count[key(a, b)] > 0 || rim.contains(key(b, a))) return;
        if (const auto found = left.find(key(b, a)); found != left.end())
          for (const std::uint32_t other : found->second) kill(other);
      });
    }
    CandidateTriangles alive;
    for (std::uint32_t t = 0; t < dead.size(); ++t)
      if (!dead[t]) {
        alive.triangle.push_back(all_.triangle[t]);
        alive.order.push_back(all_.order[t]);
      }
    all_ = std::move(alive);
  }

  // Triangles hang together across edges that need not be there, and over the sides on which they stand.
  void cut_into_faces() {
    const std::unordered_set<std::uint64_t> rim = rim_keys();
    prune(rim);
    std::vector<std::uint32_t> root(all_.triangle.size());
    std::iota(root.begin(), root.end(), 0U);
    std::unordered_map<std::uint64_t, std::uint32_t> first;  // a triangle at each directed side, or undirected edge
    for (std::uint32_t t = 0; t < all_.triangle.size(); ++t)
      for_sides(all_.triangle[t], [&](std::uint32_t a, std::uint32_t b) {
        const bool side = rim.contains(key(a, b));
        const auto [found, fresh] = first.try_emplace(side ? key(a, b) : key(std::min(a, b), std::max(a, b)), t);
        if (!fresh) root[find_root(root, t)] = find_root(root, found->second);
      });
    std::unordered_map<std::uint32_t, std::uint32_t> number;
    for (std::uint32_t t = 0; t < all_.triangle.size(); ++t) {
      const auto [found, fresh] = number.try_emplace(find_root(root, t), static_cast<std::uint32_t>(faces_.size()));
      if (fresh) faces_.emplace_back();
      Face& face = faces_[found->second];
      face.triangle.push_back(all_.triangle[t]);
      if (all_.order[t] == 0)
        ++face.num_delaunay;
      else
        face.order.push_back(static_cast<std::uint8_t>(std::min(all_.order[t], 255U)));
    }
    for (Face& face : faces_) complete(face, rim);
  }

  void complete(Face& face, const std::unordered_set<std::uint64_t>& rim) const {
    std::unordered_map<std::uint32_t, std::uint32_t> local;
    std::unordered_set<std::uint64_t> sides;
    for (auto& t : face.triangle) {
      for (std::size_t i = 0; i < 3; ++i)
        if (rim.contains(key(t[i], t[(i + 1) % 3]))) sides.insert(key(t[i], t[(i + 1) % 3]));
      for (auto& v : t) {
        const auto [found, fresh] = local.try_emplace(v, static_cast<std::uint32_t>(face.vertex.size()));
        if (fresh) add_vertex(face, v);
      }
    }
    for (auto& t : face.triangle)
      for (auto& v : t) v = local.at(v);
    for (const auto& e : polygon_.rim)
      if (sides.contains(key(e[0], e[1]))) face.rim.push_back({local.at(e[0]), local.at(e[1])});
    std::vector<std::uint32_t> root(face.vertex.size());
    std::iota(root.begin(), root.end(), 0U);
    for (const auto& e : face.rim) root[find_root(root, e[0])] = find_root(root, e[1]);
    for (std::uint32_t v = 0; v < root.size(); ++v) face.components += find_root(root, v) == v;
    --face.components;
  }

  void add_vertex(Face& face, std::uint32_t v) const {
    face.vertex.push_back(v);
    face.position.push_back(polygon_.given.position[v]);
    face.height.push_back(polygon_.given.height[v]);
    face.wants.push_back(wants_[v]);
    face.degree.push_back(degree_[v]);
  }

  [[nodiscard]] static PolygonProblem problem(const Face& face, std::span<const ReferencePoint> reference) {
    PolygonProblem problem;
    problem.position = face.position;
    problem.height = face.height;
    problem.wants_lower = face.wants;
    problem.delaunay = std::span(face.triangle).first(face.num_delaunay);
    problem.others = std::span(face.triangle).subspan(face.num_delaunay);
    problem.others_order = face.order;
    problem.components = face.components;
    problem.reference = reference;
    problem.base_degree = face.degree;
    problem.rim = face.rim;
    // Euler's formula: a side more is a triangle more, a component more is two.
    problem.num_triangles = static_cast<std::uint32_t>(face.rim.size()) + 2 * face.components - 2;
    return problem;
  }

  static void add(const PolygonResult& result, PolygonResult& total) {
    total.optimal = total.optimal && result.optimal;
    total.fell_back = total.fell_back || result.fell_back;
    total.limit_missed = total.limit_missed || result.limit_missed;
    total.max_order = std::max(total.max_order, result.max_order);
    total.gap += result.gap;
    total.bound = std::max(total.bound, result.bound);
    total.error.add(result.error);
  }

  const SoundPolygon& polygon_;
  CandidateTriangles all_;
  std::vector<std::uint8_t> wants_;
  std::vector<std::uint32_t> degree_;
  std::vector<Face> faces_;
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
  if (objective == Objective::min_squared_error) return out.error.squared.value();
  if (objective == Objective::min_absolute_error) return out.error.absolute.value();
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
  best.error.add(reference.vertex_error);
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
