#include "hydrotin/polygon.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "degree_program.h"
#include "polygon_flips.h"
#include "polygon_search.h"
#include "quadrilateral_program.h"
#include "reference_errors.h"

namespace hydrotin {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

struct PolygonSolver::Impl {
  explicit Impl(PolygonOptions given) : options(std::move(given)) {}

  PolygonOptions options;
  const PolygonProblem* problem = nullptr;
  PolygonGraph graph{};
  PolygonSearch search{};
  PolygonCosts costs{};
  PolygonAnswer answer{};
  std::vector<Objective> slots{};  // objectives with a slot of `costs`, in their order
  std::vector<std::uint8_t> blocked{}, scratch{}, served{};
  std::vector<TriangleError> error{};
  std::vector<double> score{};
  std::vector<std::uint32_t> unserved{}, servable{};

  [[nodiscard]] Objective first() const { return options.objectives.front(); }
  [[nodiscard]] bool by_minima() const {
    return std::find(options.objectives.begin(), options.objectives.end(), Objective::local_minima) !=
           options.objectives.end();
  }
  [[nodiscard]] bool is_loose() const { return problem->rim.empty(); }

  // ---- what triangles cost ----

  [[nodiscard]] std::array<LatticePoint, 3> corners(std::uint32_t t) const {
    const auto& v = graph.triangle(t);
    return {problem->position[v[0]], problem->position[v[1]], problem->position[v[2]]};
  }

  [[nodiscard]] std::uint32_t order_of(std::uint32_t t) const {
    return t < problem->delaunay.size() ? 0 : problem->others_order[t - problem->delaunay.size()];
  }

  [[nodiscard]] Wide cost_of(Objective objective, std::uint32_t t) const {
    const auto [a, b, c] = corners(t);
    switch (objective) {
      case Objective::min_weight:  // every inner edge is counted twice; the sides always
        return to_fixed(edge_length(a, b)) + to_fixed(edge_length(b, c)) + to_fixed(edge_length(c, a));
      case Objective::max_sum_inradius:
        return -to_fixed(inradius(a, b, c));
      case Objective::min_sum_inradius:
        return to_fixed(inradius(a, b, c));
      case Objective::min_squared_error:
        return error[t].squared.units();
      case Objective::min_absolute_error:
        return error[t].absolute.units();
      case Objective::local_minima:
        return 0;  // counted at vertices
      default:     // the number of foreign sides
        return graph.foreign_sides(t);
    }
  }

  [[nodiscard]] double score_of(Objective objective, std::uint32_t t) const {
    if (objective == Objective::min_max_order) return order_of(t);
    if (objective == Objective::min_max_error) return error[t].largest;
    const auto [a, b, c] = corners(t);
    return triangle_score(objective, a, b, c);
  }

  // Costs with the slots so far; `delaunay` stands for the number of foreign sides.
  void make_costs() {
    costs.num_slots = std::max(1, static_cast<int>(slots.size()));
    const auto minima = std::find(slots.begin(), slots.end(), Objective::local_minima);
    costs.minima_slot = minima == slots.end() ? -1 : static_cast<int>(minima - slots.begin());
    costs.counts_foreign = slots == std::vector{Objective::local_minima, Objective::delaunay};
    costs.foreign = graph.foreign_sides();
    costs.cost.clear();
    if (costs.counts_foreign) return;
    costs.cost.assign(std::size_t{graph.num_triangles()} * static_cast<std::size_t>(costs.num_slots), 0);
    for (std::uint32_t t = 0; t < graph.num_triangles(); ++t)
      for (std::size_t s = 0; s < slots.size(); ++s)
        costs.cost[t * static_cast<std::size_t>(costs.num_slots) + s] = cost_of(slots[s], t);
  }

  void measure_errors(PolygonResult& result) {
    const bool needed = options.max_error.has_value() ||
                        std::any_of(options.objectives.begin(), options.objectives.end(), needs_reference);
    if (!needed) return;
    error = reference_errors(graph, options.max_error ? &*options.max_error : nullptr);
    for (std::uint32_t t = 0; t < graph.num_triangles(); ++t) blocked[t] = !error[t].within_limit;
    if (std::find(blocked.begin(), blocked.end(), std::uint8_t{1}) == blocked.end()) return;
    if (search.is_within_budget()) {
      slots.assign(1, Objective::delaunay);
      make_costs();
      result.limit_missed = !search.run(costs, blocked, answer);
    } else {
      result.limit_missed = true;  // unless the flips come to keep it
    }
  }

  // ---- exact search ----

  // The smallest score that some side cannot avoid.
  [[nodiscard]] double side_bound() const {
    double bound = -kInfinity;
    for (std::uint32_t e = 0; e < graph.num_edges(); ++e) {
      const std::uint32_t twin = PolygonGraph::twin(e);
      if (!graph.edge(twin).is_boundary || graph.edge(e).first_option == kNoEdge) continue;
      double least = kInfinity;
      for (std::uint32_t o = graph.edge(e).first_option; o != kNoEdge; o = graph.option(o).next)
        if (!blocked[PolygonGraph::triangle_of(o)]) least = std::min(least, score[PolygonGraph::triangle_of(o)]);
      bound = std::max(bound, least);
    }
    return bound;
  }

  [[nodiscard]] double worst_score(const std::vector<std::uint32_t>& triangles) const {
    double worst = -kInfinity;
    for (const std::uint32_t t : triangles) worst = std::max(worst, score[t]);
    return worst;
  }

  void score_triangles(Objective objective) {
    score.resize(graph.num_triangles());
    for (std::uint32_t t = 0; t < graph.num_triangles(); ++t) score[t] = score_of(objective, t);
  }

  // Blocks all triangles above the least threshold under which the slots keep their values.
  bool restrict_to_best(Objective objective) {
    score_triangles(objective);
    make_costs();
    if (!search.run(costs, blocked, answer)) return false;
    const SlotValues value = answer.value;
    const double low = side_bound(), high = worst_score(answer.triangle);
    std::vector<double> threshold{high};
    for (std::uint32_t t = 0; t < graph.num_triangles(); ++t)
      if (!blocked[t] && score[t] >= low && score[t] < high) threshold.push_back(score[t]);
    std::sort(threshold.begin(), threshold.end());
    threshold.erase(std::unique(threshold.begin(), threshold.end()), threshold.end());
    std::size_t from = 0, to = threshold.size() - 1;  // the last one is known to do
    while (from < to) {
      const std::size_t middle = (from + to) / 2;
      scratch = blocked;
      block_above(threshold[middle], scratch);
      if (search.run(costs, scratch, answer) && answer.value == value)
        to = middle;
      else
        from = middle + 1;
    }
    block_above(threshold[to], blocked);
    return true;
  }

  void block_above(double threshold, std::vector<std::uint8_t>& out) const {
    for (std::uint32_t t = 0; t < graph.num_triangles(); ++t) out[t] = out[t] || score[t] > threshold;
  }

  [[nodiscard]] std::vector<Objective> stages(const PolygonResult& result) const {
    std::vector<Objective> out = options.objectives;
    if (result.limit_missed) {
      std::erase(out, Objective::min_max_error);
      out.insert(out.begin(), Objective::min_max_error);
    }
    return out;
  }

  // Sums and minima get slots, bottlenecks block triangles; at the end one run decides among what is left.
  bool solve_by_stages(PolygonResult& result) {
    if (result.limit_missed) std::fill(blocked.begin(), blocked.end(), std::uint8_t{0});
    slots.clear();
    for (const Objective objective : stages(result)) {
      if (kind_of(objective) == ObjectiveKind::bottleneck) {
        if (!restrict_to_best(objective)) return false;
      } else {
        slots.push_back(objective);
      }
    }
    slots.push_back(Objective::delaunay);
    make_costs();
    return search.run(costs, blocked, answer);
  }

  void judge(PolygonResult& result) {
    result.optimal = search.is_proven() && !result.limit_missed;
    if (kind_of(first()) == ObjectiveKind::bottleneck) {
      score_triangles(first());
      result.bound = result.optimal ? worst_score(answer.triangle) : unrestricted_side_bound();
      result.optimal = result.optimal || worst_score(answer.triangle) <= result.bound;
    } else if (kind_of(first()) == ObjectiveKind::sum && !search.is_proven()) {
      result.gap = std::max(0.0, from_fixed(answer.value[0]) - search.first_bound());
    }
  }

  [[nodiscard]] double unrestricted_side_bound() {
    scratch.assign(graph.num_triangles(), 0);
    std::swap(scratch, blocked);
    const double bound = side_bound();
    std::swap(scratch, blocked);
    return bound;
  }

  // ---- quadrilaterals and degrees ----

  bool solve_quadrilaterals(PolygonResult& result) {
    const BeyondSides beyond = sides_beyond(graph);
    QuadrilateralProgram program;
    std::vector<std::uint32_t> triangles;
    const bool is_sum = kind_of(first()) == ObjectiveKind::quadrilateral_sum;
    double best = kInfinity, bound = kInfinity;
    std::uint64_t best_foreign = 0;
    search.for_each_way(blocked, [&](const auto& way_blocked, const auto& closed) {
      ++result.programs;
      if (!program.run(graph, options, beyond, way_blocked, closed, triangles) || triangles.size() != size()) return;
      bound = std::min(bound, program.value() - (is_sum ? num_uncounted(closed) : 0));
      const double value = quadrilateral_value(graph, options, beyond, triangles);
      const std::uint64_t foreign = num_foreign(triangles);
      if (!answer.triangle.empty() && std::pair{value, foreign} >= std::pair{best, best_foreign}) return;
      best = value;
      best_foreign = foreign;
      answer.triangle = triangles;
    });
    if (answer.triangle.empty()) return false;
    result.optimal = best <= bound;
    result.bound = bound;
    result.gap = is_sum ? std::max(0.0, best - bound) : 0;
    return true;
  }

  // Pairs across closed edges and slits, which the program leaves out.
  [[nodiscard]] double num_uncounted(const std::vector<std::uint8_t>& closed) const {
    double count = 0;
    for (std::uint32_t e = 0; e < graph.num_edges(); ++e) {
      const std::uint32_t twin = PolygonGraph::twin(e);
      count += e < twin && (closed[e] || (graph.edge(e).is_boundary && graph.edge(twin).is_boundary));
    }
    return count;
  }

  [[nodiscard]] std::uint64_t num_foreign(const std::vector<std::uint32_t>& triangles) const {
    std::uint64_t count = 0;
    for (const std::uint32_t t : triangles) count += graph.foreign_sides(t);
    return count;
  }

  [[nodiscard]] std::uint32_t most_neighbors(const std::vector<std::uint32_t>& triangles) const {
    const auto degree = degrees(graph, triangles);
    return degree.empty() ? 0 : *std::max_element(degree.begin(), degree.end());
  }

  bool try_degree(std::uint32_t most, std::vector<std::uint32_t>& triangles, PolygonResult& result) {
    bool found = false;
    search.for_each_way(blocked, [&](const auto& way_blocked, const auto& closed) {
      if (found) return;
      ++result.programs;
      found = triangulate_with_degree(graph, most, way_blocked, closed, triangles) && triangles.size() == size();
    });
    return found;
  }

  bool solve_degrees(PolygonResult& result) {
    slots.assign(1, Objective::delaunay);
    make_costs();
    if (!search.run(costs, blocked, answer)) return false;
    // The fewest neighbours that the program finds possible.
    std::uint32_t high = most_neighbors(answer.triangle), low = 2;
    for (const std::uint32_t base : problem->base_degree) low = std::max(low, base);
    std::vector<std::uint32_t> triangles;
    low = std::min(low, high);
    while (low < high) {
      const std::uint32_t middle = (low + high) / 2;
      if (!try_degree(middle, triangles, result)) {
        low = middle + 1;
        continue;
      }
      high = middle;
      if (most_neighbors(triangles) < most_neighbors(answer.triangle)) answer.triangle = triangles;
    }
    result.bound = low;
    result.optimal = most_neighbors(answer.triangle) <= low;
    return true;
  }

  // ---- where a search would take too long ----

  [[nodiscard]] bool has_delaunay() const { return is_loose() || problem->delaunay.size() == problem->num_triangles; }

  // Delaunay, improved by flips.
  void flip_delaunay(const PolygonResult& result, const BeyondSides& beyond) {
    answer.triangle.clear();
    for (std::uint32_t t = 0; t < problem->delaunay.size(); ++t) answer.triangle.push_back(t);
    slots.clear();
    std::vector<FlipCriterion> criteria;
    std::vector<std::vector<double>> scores;
    scores.reserve(options.objectives.size() + 1);
    if (result.limit_missed) scores.emplace_back(blocked.begin(), blocked.end());
    if (result.limit_missed) criteria.push_back({.score = &scores.back()});
    for (const Objective objective : options.objectives) criteria.push_back(criterion(objective, scores));
    slots.push_back(Objective::delaunay);
    criteria.push_back({.slot = static_cast<int>(slots.size()) - 1});
    make_costs();
    improve_by_flips(graph, options, costs, criteria, beyond, answer.triangle);
    answer.value = value_of(graph, costs, answer.triangle);
  }

  bool fall_back(PolygonResult& result) {
    result.fell_back = true;
    result.optimal = false;
    if (!has_delaunay()) return false;
    const BeyondSides beyond = sides_beyond(graph);
    flip_delaunay(result, beyond);
    if (result.limit_missed)
      result.limit_missed =
          std::any_of(answer.triangle.begin(), answer.triangle.end(), [&](std::uint32_t t) { return blocked[t] != 0; });
    bound_fallback(result, beyond);
    return true;
  }

  // Where a linear program or many ties would have to be tried for local minima alone, flips often do. Nothing serves
  // more vertices then, but others that serve as many may have more Delaunay edges.
  [[nodiscard]] bool flips_serve_all(const PolygonResult& result) {
    const bool costly = search.is_costly() || !search.is_within_budget();
    if (!costly || options.method != ComponentMethod::automatic || !is_loose() || options.max_error ||
        options.objectives.size() > 1 || first() != Objective::local_minima)
      return false;
    flip_delaunay(result, {});
    mark_served(graph, answer.triangle, served);
    for (std::size_t v = 0; v < served.size(); ++v)
      if (problem->wants_lower[v] && !served[v]) {
        search.offer(answer.triangle);
        return false;
      }
    return true;
  }

  FlipCriterion criterion(Objective objective, std::vector<std::vector<double>>& scores) {
    switch (kind_of(objective)) {
      case ObjectiveKind::bottleneck:
        score_triangles(objective);
        scores.push_back(score);
        return {.score = &scores.back()};
      case ObjectiveKind::degree:
        return {.by_degree = true};
      case ObjectiveKind::quadrilateral_sum:
      case ObjectiveKind::quadrilateral_bottleneck:
        return {.by_pairs = true};
      default:
        slots.push_back(objective);
        return {.slot = static_cast<int>(slots.size()) - 1};
    }
  }

  void bound_fallback(PolygonResult& result, const BeyondSides& beyond) {
    switch (kind_of(first())) {
      case ObjectiveKind::bottleneck:
        score_triangles(first());
        result.bound = unrestricted_side_bound();
        result.optimal = !result.limit_missed && worst_score(answer.triangle) <= result.bound;
        break;
      case ObjectiveKind::sum:
        result.gap = std::max(0.0, from_fixed(answer.value[0]) - density_bound());
        result.optimal = !result.limit_missed && result.gap <= 1e-12 * std::abs(from_fixed(answer.value[0]));
        break;
      case ObjectiveKind::degree:
        result.bound = 2;
        for (const std::uint32_t base : problem->base_degree) result.bound = std::max<double>(result.bound, base);
        result.optimal = most_neighbors(answer.triangle) <= result.bound;
        break;
      case ObjectiveKind::quadrilateral_sum:  // at best every pair counts
        result.gap = quadrilateral_value(graph, options, beyond, answer.triangle) + 1.5 * static_cast<double>(size());
        break;
      case ObjectiveKind::quadrilateral_bottleneck:
        result.bound = first() == Objective::min_max_area_ratio ? 1 : 0;
        break;
      default:
        break;
    }
  }

  // Every place of the polygon pays at least the least cost per area of any triangle.
  [[nodiscard]] double density_bound() const {
    double least = kInfinity, area = 0;
    for (std::uint32_t t = 0; t < graph.num_triangles(); ++t) {
      const auto [a, b, c] = corners(t);
      least = std::min(least, from_fixed(costs.of(t, 0)) / twice_area(a, b, c));
      if (t < problem->delaunay.size()) area += twice_area(a, b, c);
    }
    return least * area;
  }

  [[nodiscard]] std::size_t size() const { return is_loose() ? problem->delaunay.size() : problem->num_triangles; }

  // ---- the whole ----

  // Nothing else can serve more vertices, or has more Delaunay edges.
  [[nodiscard]] bool delaunay_serves_all() {
    const auto wants = [](std::uint8_t level) { return level != 0; };
    if (std::none_of(problem->wants_lower.begin(), problem->wants_lower.end(), wants)) return true;
    served.assign(problem->position.size(), 0);
    for (std::size_t t = 0; t < problem->delaunay.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        if (problem->fixed[t] >> i & 1U) continue;
        const std::uint32_t a = problem->delaunay[t][i], b = problem->delaunay[t][(i + 1) % 3];
        const bool a_is_lower =
            is_lower(problem->height[a], problem->position[a], problem->height[b], problem->position[b]);
        served[a_is_lower ? b : a] = 1;
      }
    for (std::size_t v = 0; v < served.size(); ++v)
      if (problem->wants_lower[v] && !served[v]) return false;
    return true;
  }

  [[nodiscard]] bool keeps_delaunay() {
    if (!is_loose() || options.max_error) return false;
    if (problem->others.empty() || first() == Objective::delaunay) return true;
    if (options.objectives.size() > 1 || first() != Objective::local_minima) return false;
    return delaunay_serves_all();
  }

  // The bound of a polygon that can be triangulated in one way only, or is not to be touched.
  void judge_delaunay(PolygonResult& result) const {
    if (kind_of(first()) == ObjectiveKind::bottleneck) {
      result.bound = first() == Objective::min_max_order ? 0 : -kInfinity;
      if (first() == Objective::min_max_error) {
        add_delaunay_errors(result);
        result.bound = std::exchange(result.error, {}).largest;
      } else if (first() != Objective::min_max_order) {
        for (const auto& [a, b, c] : problem->delaunay)
          result.bound = std::max(
              result.bound, triangle_score(first(), problem->position[a], problem->position[b], problem->position[c]));
      }
    } else if (kind_of(first()) == ObjectiveKind::degree) {
      for (const std::uint32_t base : problem->base_degree) result.bound = std::max<double>(result.bound, base);
    } else if (kind_of(first()) == ObjectiveKind::quadrilateral_bottleneck) {
      result.bound = first() == Objective::min_max_area_ratio ? 1 : 0;
    }
  }

  void add_delaunay_errors(PolygonResult& result) const {
    const ErrorLimit* limit = options.max_error ? &*options.max_error : nullptr;
    for (const ReferencePoint& p : problem->reference)
      result.error.add(distance_from(p, problem->delaunay[p.triangle]), limit);
  }

  void add_errors(PolygonResult& result) {
    if (error.empty()) error = reference_errors(graph, options.max_error ? &*options.max_error : nullptr);
    for (const std::uint32_t t : answer.triangle) result.error.add(error[t]);
  }

  [[nodiscard]] VerticalDistance distance_from(const ReferencePoint& p, const std::array<std::uint32_t, 3>& t) const {
    const auto corner = [&](std::size_t i) { return SurfacePoint{problem->position[t[i]], problem->height[t[i]]}; };
    return vertical_distance(corner(0), corner(1), corner(2), p.position, p.height);
  }

  bool solve_graph(PolygonResult& result) {
    blocked.assign(graph.num_triangles(), 0);
    answer.triangle.clear();
    error.clear();
    search.start(graph, options);
    measure_errors(result);
    const ObjectiveKind kind = kind_of(first());
    const bool staged = kind != ObjectiveKind::degree && kind != ObjectiveKind::quadrilateral_sum &&
                        kind != ObjectiveKind::quadrilateral_bottleneck;
    if (flips_serve_all(result)) return true;
    answer.triangle.clear();
    if (!search.is_within_budget() || (!staged && !search.has_few_ways())) return fall_back(result);
    if (!staged && result.limit_missed) std::fill(blocked.begin(), blocked.end(), std::uint8_t{0});
    if (kind == ObjectiveKind::degree) return solve_degrees(result);
    if (!staged) return solve_quadrilaterals(result);
    if (!solve_by_stages(result)) {
      const bool exists = !search.is_proven() && has_delaunay();
      return exists && fall_back(result);
    }
    judge(result);
    return true;
  }

  [[nodiscard]] bool has_admissible(std::uint32_t e) const {
    for (std::uint32_t o = graph.edge(e).first_option; o != kNoEdge; o = graph.option(o).next)
      if (error[PolygonGraph::triangle_of(o)].within_limit) return true;
    return false;
  }

  void find_servable() {
    served.assign(problem->position.size(), 0);
    for (std::uint32_t e = 0; e < graph.num_edges(); ++e) {
      if (!graph.is_inner(e) || !graph.edge(e).goes_down) continue;
      if (has_admissible(e) && has_admissible(PolygonGraph::twin(e))) served[graph.edge(e).origin] = 1;
    }
    for (std::uint32_t v = 0; v < served.size(); ++v)
      if (served[v]) servable.push_back(v);
  }

  void serve(PolygonResult& result) {
    if (!by_minima()) return;
    if (options.max_error) find_servable();
    mark_served(graph, answer.triangle, served);
    for (std::uint32_t v = 0; v < served.size(); ++v) {
      if (problem->wants_lower[v] != 2) continue;
      if (served[v])
        ++result.served;
      else
        unserved.push_back(v);
    }
    if (first() == Objective::local_minima && unserved.empty()) result.optimal = true;
  }
};

PolygonSolver::PolygonSolver(PolygonOptions options) : impl_(std::make_unique<Impl>(std::move(options))) {
  assert(!objection_to(impl_->options.objectives));
}
PolygonSolver::~PolygonSolver() = default;
PolygonSolver::PolygonSolver(PolygonSolver&&) noexcept = default;
PolygonSolver& PolygonSolver::operator=(PolygonSolver&&) noexcept = default;

std::span<const std::uint32_t> PolygonSolver::unserved() const {
  return impl_->unserved;
}
std::span<const std::uint32_t> PolygonSolver::servable() const {
  return impl_->servable;
}

PolygonResult PolygonSolver::solve(const PolygonProblem& problem,
                                   std::vector<std::array<std::uint32_t, 3>>& triangles) {
  Impl& self = *impl_;
  self.problem = &problem;
  self.unserved.clear();
  self.servable.clear();
  PolygonResult result;
  if (self.keeps_delaunay()) {
    triangles.insert(triangles.end(), problem.delaunay.begin(), problem.delaunay.end());
    result.served =
        static_cast<std::uint32_t>(std::count(problem.wants_lower.begin(), problem.wants_lower.end(), std::uint8_t{2}));
    self.judge_delaunay(result);
    self.add_delaunay_errors(result);
    return result;
  }
  self.graph.build(problem);
  result.is_triangulated = self.solve_graph(result);
  result.programs += self.search.programs();
  if (!result.is_triangulated) return result;
  self.serve(result);
  if (!problem.reference.empty()) self.add_errors(result);
  for (const std::uint32_t number : self.answer.triangle) {
    triangles.push_back(self.graph.triangle(number));
    result.max_order = std::max(result.max_order, self.order_of(number));
  }
  return result;
}

}  // namespace hydrotin
