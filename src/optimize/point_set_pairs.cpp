#include <algorithm>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <vector>

#include "point_set_polygons.h"

namespace hydrotin {
namespace {

constexpr int kRounds = 8;

using Triangle = std::array<std::uint32_t, 3>;

std::uint64_t key(std::uint32_t origin, std::uint32_t target) {
  return std::uint64_t{origin} << 32 | target;
}

// Polygons by the (x, y) of the corners of their first triangle in that order.
std::vector<std::uint32_t> polygons_in_order(const PointSetGround& ground) {
  const TriangulationView& tri = ground.tri;
  std::vector<std::array<LatticePoint, 3>> first(ground.subdivision.size());
  for (std::uint32_t f = 0; f < first.size(); ++f) {
    bool any = false;
    for (const TriangleId t : ground.subdivision.triangles_of(f)) {
      const HalfedgeId h = first_halfedge(t);
      std::array<LatticePoint, 3> corners{tri.position[tri.origin[h]], tri.position[tri.target(h)],
                                          tri.position[tri.apex(h)]};
      std::sort(corners.begin(), corners.end());
      if (!any || corners < first[f]) first[f] = corners;
      any = true;
    }
  }
  std::vector<std::uint32_t> order(first.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t f, std::uint32_t g) { return first[f] < first[g]; });
  return order;
}

// The third vertex of the triangle on the left of every directed edge of the current answers.
class Apexes {
 public:
  void add(std::span<const Triangle> triangles) {
    for (const Triangle& t : triangles)
      for (std::size_t i = 0; i < 3; ++i) apex_[key(t[i], t[(i + 1) % 3])] = t[(i + 2) % 3];
  }
  void remove(std::span<const Triangle> triangles) {
    for (const Triangle& t : triangles)
      for (std::size_t i = 0; i < 3; ++i) apex_.erase(key(t[i], t[(i + 1) % 3]));
  }
  [[nodiscard]] std::optional<std::uint32_t> left_of(std::uint32_t origin, std::uint32_t target) const {
    const auto found = apex_.find(key(origin, target));
    return found == apex_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  std::unordered_map<std::uint64_t, std::uint32_t> apex_;
};

class Pairs {
 public:
  Pairs(const PointSetGround& ground, const PointSetOptions& options, PointSetPolygons& polygons)
      : ground_(ground), options_(options), polygons_(polygons) {
    apexes_.add(polygons.answers());
  }

  // Over all triangulations: what the pairs inside polygons and the pairs across fixed edges reach at best.
  [[nodiscard]] double bound() const {
    double bound = is_sum() ? inner_total() : -std::numeric_limits<double>::infinity();
    const auto options = options_on_fixed_edges();
    for (const auto& [edge, left] : options) {
      const auto a = static_cast<std::uint32_t>(edge >> 32), b = static_cast<std::uint32_t>(edge);
      if (a > b) continue;
      const auto right = options.find(key(b, a));
      if (right == options.end()) continue;
      double least = std::numeric_limits<double>::infinity();
      for (const std::uint32_t c : left)
        for (const std::uint32_t d : right->second) least = std::min(least, score(a, b, c, d));
      bound = is_sum() ? bound + least : std::max(bound, least);
    }
    return bound;
  }

  void couple() {
    const std::vector<std::uint32_t> order = polygons_in_order(ground_);
    for (int round = 0; round < kRounds; ++round) {
      bool changed = false;
      for (const std::uint32_t f : order) {
        if (ground_.candidates.begin[f] == ground_.candidates.begin[f + 1]) continue;
        find_beyond(f);
        const std::vector<Triangle> before(polygons_.answer(f).begin(), polygons_.answer(f).end());
        if (!polygons_.solve_within(f, {.beyond = beyond_})) continue;
        changed = true;
        apexes_.remove(before);
        apexes_.add(polygons_.answer(f));
      }
      if (!changed) return;
    }
  }

 private:
  [[nodiscard]] Objective objective() const { return options_.polygon.objectives.front(); }
  [[nodiscard]] bool is_sum() const { return kind_of(objective()) == ObjectiveKind::quadrilateral_sum; }
  [[nodiscard]] SurfacePoint point(std::uint32_t v) const {
    return {ground_.tri.position[VertexId{v}], ground_.height[v]};
  }
  [[nodiscard]] double score(std::uint32_t a, std::uint32_t b, std::uint32_t left, std::uint32_t right) const {
    return quadrilateral_score(objective(), point(a), point(b), point(left), point(right), options_.polygon.z_per_xy);
  }
  [[nodiscard]] bool is_fixed(HalfedgeId h) const { return !ground_.crossings.crossed[h.value]; }

  // Of the pairs across edges that are not fixed, less what polygons may have left.
  [[nodiscard]] double inner_total() const {
    std::unordered_map<std::uint64_t, bool> fixed;
    for (HalfedgeId h{0}; h.value < ground_.tri.origin.size(); ++h.value)
      if (is_fixed(h)) fixed[key(ground_.tri.origin[h].value, ground_.tri.target(h).value)] = true;
    double total = 0;
    for (const Triangle& t : polygons_.answers())
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = t[i], b = t[(i + 1) % 3];
        const auto right = apexes_.left_of(b, a);
        if (a > b || !right || fixed.contains(key(a, b))) continue;
        total += score(a, b, t[(i + 2) % 3], *right);
      }
    for (std::uint32_t f = 0; f < polygons_.size(); ++f) total -= polygons_.result(f).gap;
    return total;
  }

  // The third vertices of all order-k triangles on fixed edges.
  [[nodiscard]] std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> options_on_fixed_edges() const {
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> options;
    const TriangulationView& tri = ground_.tri;
    for (HalfedgeId h{0}; h.value < tri.origin.size(); ++h.value)
      if (is_fixed(h)) options[key(tri.origin[h].value, tri.target(h).value)] = {tri.apex(h).value};
    for (const auto& v : ground_.triangles.vertices)
      for (std::size_t i = 0; i < 3; ++i)
        if (const auto found = options.find(key(v[i].value, v[(i + 1) % 3].value)); found != options.end())
          found->second.push_back(v[(i + 2) % 3].value);
    return options;
  }

  void find_beyond(std::uint32_t f) {
    const auto triangles = ground_.subdivision.triangles_of(f);
    beyond_.assign(3 * triangles.size(), std::nullopt);
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (std::uint32_t i = 0; i < 3; ++i) {
        const HalfedgeId h{first_halfedge(triangles[t]).value + i};
        const HalfedgeId twin = ground_.tri.twin[h];
        if (!is_fixed(h) || twin.is_none() || ground_.subdivision.polygon[triangle_of(twin).value] == f) continue;
        const auto apex = apexes_.left_of(ground_.tri.origin[twin].value, ground_.tri.target(twin).value);
        if (apex) beyond_[3 * t + i] = point(*apex);
      }
  }

  const PointSetGround& ground_;
  const PointSetOptions& options_;
  PointSetPolygons& polygons_;
  Apexes apexes_;
  std::vector<std::optional<SurfacePoint>> beyond_;
};

}  // namespace

double couple_pairs(const PointSetGround& ground, const PointSetOptions& options, PointSetPolygons& polygons) {
  Pairs pairs(ground, options, polygons);
  const double bound = pairs.bound();
  pairs.couple();
  return bound;
}

void couple_degrees(const PointSetGround& ground, PointSetPolygons& polygons) {
  std::vector<std::uint32_t> degree = ground.base_degree;
  // Inner edges are met once in each direction; fixed ones are counted already.
  const auto count = [&](std::uint32_t f, std::uint32_t change) {
    std::unordered_map<std::uint64_t, bool> fixed;
    for (const TriangleId t : ground.subdivision.triangles_of(f))
      for (std::uint32_t i = 0; i < 3; ++i) {
        const HalfedgeId h{first_halfedge(t).value + i};
        if (!ground.crossings.crossed[h.value])
          fixed[key(ground.tri.origin[h].value, ground.tri.target(h).value)] = true;
      }
    for (const Triangle& t : polygons.answer(f))
      for (std::size_t i = 0; i < 3; ++i)
        if (!fixed.contains(key(t[i], t[(i + 1) % 3]))) degree[t[i]] += change;
  };
  for (std::uint32_t f = 0; f < polygons.size(); ++f) count(f, 1);
  const std::vector<std::uint32_t> order = polygons_in_order(ground);
  for (int round = 0; round < kRounds; ++round) {
    bool changed = false;
    for (const std::uint32_t f : order) {
      if (ground.candidates.begin[f] == ground.candidates.begin[f + 1]) continue;
      count(f, static_cast<std::uint32_t>(-1));
      changed |= polygons.solve_within(f, {.degree = degree});
      count(f, 1);
    }
    if (!changed) return;
  }
}

}  // namespace hydrotin
