#include "river_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "declines.h"

namespace hydrotin {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr auto kNone = static_cast<std::uint32_t>(-1);
constexpr double kStorageSlack = 1e-8;  // beyond the quantum: what the simplex may leave open
constexpr std::uint64_t kListed = std::uint64_t{1} << 63, kTriangle = kListed | (std::uint64_t{1} << 62);

using Plane = std::array<double, 2>;

Plane operator-(const Plane& a, const Plane& b) {
  return {a[0] - b[0], a[1] - b[1]};
}
double dot(const Plane& a, const Plane& b) {
  return a[0] * b[0] + a[1] * b[1];
}
double cross(const Plane& a, const Plane& b) {
  return a[0] * b[1] - a[1] * b[0];
}
double norm(const Plane& a) {
  return std::hypot(a[0], a[1]);
}

}  // namespace

const char* name_of(RowKind kind) {
  static constexpr const char* kNames[] = {"flow", "valley",   "slope limit", "triangle slope", "contiguous",
                                           "lake", "drainage", "curvature",   "outlet chain"};
  return kNames[static_cast<std::size_t>(kind)];
}

RowCatalog::RowCatalog(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                       const RiverConstraints& constraints, double quantum)
    : terrain_(terrain), constraints_(constraints), quantum_(quantum), links_(link_terrain(terrain)) {
  is_river_.assign(terrain.num_vertices(), 0);
  for (const auto& edge : rivers) is_river_[edge.from] = is_river_[edge.to] = 1;
  for (const auto& edge : constraints.chain) is_river_[edge.from] = is_river_[edge.to] = 1;
  mark_lakes();
  take_declines(rivers);
  add_flow_and_valley(rivers);
  add_chains();
  if (constraints.contiguity != Contiguity::none) add_contiguous(rivers);
  add_lakes();
  add_preserved();
  index_rows();
}

void RowCatalog::take_declines(std::span<const RiverEdge> rivers) {
  Declines declines = find_declines(terrain_, rivers, constraints_);
  decline_ = std::move(declines.drop);
  clamped_ = std::move(declines.clamped);
  for (std::size_t e = 0; e < rivers.size(); ++e) {
    const auto [from, to] = rivers[e];
    if (lake_of_[from] != 0 && lake_of_[from] == lake_of_[to]) decline_[e] = 0;
  }
}

void RowCatalog::mark_lakes() {
  lake_of_.assign(terrain_.num_vertices(), 0);
  for (std::size_t i = 0; i < constraints_.lakes.size(); ++i)
    for (const std::uint32_t v : constraints_.lakes[i].vertex) lake_of_[v] = static_cast<std::uint32_t>(i + 1);
}

// Turns sides for heights into sides for displacements: only differences of heights count.
void RowCatalog::close(Row& row, double lower, double upper) const {
  double old = 0, weight = 0;
  for (std::uint32_t i = 0; i < row.size; ++i) {
    old += row.coefficient[i] * (terrain_.height[row.vertex[i]] - terrain_.height[row.vertex[0]]);
    weight += std::abs(row.coefficient[i]);
  }
  row.lower = lower - old;
  row.upper = upper - old;
  row.margin = quantum_ > 0 ? weight * quantum_ / 2 + kStorageSlack : 0;
}

void RowCatalog::list(Row row) {
  row.key = kListed | listed_.size();
  listed_.push_back(row);
}

Row RowCatalog::valley_row(std::uint32_t a, std::uint32_t b, std::uint32_t w, double& distance) const {
  const Plane edge = terrain_.position[b] - terrain_.position[a], tip = terrain_.position[w] - terrain_.position[a];
  const double t = dot(tip, edge) / dot(edge, edge), scale = std::max({1.0, std::abs(t), std::abs(1 - t)});
  distance = std::abs(cross(edge, tip)) / norm(edge) / scale;
  Row row;
  row.kind = RowKind::valley;
  row.size = 3;
  row.vertex = {w, a, b, 0};
  row.coefficient = {1 / scale, -(1 - t) / scale, -t / scale, 0};
  return row;
}

void RowCatalog::add_flow_and_valley(std::span<const RiverEdge> rivers) {
  for (std::size_t e = 0; e < rivers.size(); ++e) {
    const auto [from, to] = rivers[e];
    const bool in_lake = lake_of_[from] != 0 && lake_of_[from] == lake_of_[to];
    if (constraints_.flow) {
      Row row;
      row.size = 2;
      row.vertex = {from, to, 0, 0};
      row.coefficient = {1, -1, 0, 0};
      row.strict = decline_[e];
      close(row, decline_[e], kInfinity);
      if (in_lake) row.margin = 0;  // both are written with one level
      list(row);
    }
    if (!constraints_.valley) continue;
    const Wingtips tips = wingtips(terrain_, links_, from, to);
    for (int i = 0; i < tips.count; ++i) {
      double distance = 0;
      Row row = valley_row(from, to, tips.vertex[i], distance);
      row.strict = in_lake ? 0 : constraints_.side_slope * distance;
      // Inside one lake everything is level: the row holds as it stands, to the last bit.
      if (in_lake && lake_of_[tips.vertex[i]] == lake_of_[from]) continue;
      close(row, row.strict, kInfinity);
      list(row);
    }
  }
}

void RowCatalog::add_chains() {
  for (const auto& [from, to] : constraints_.chain) {
    if (lake_of_[from] != 0 && lake_of_[from] == lake_of_[to]) continue;
    Row row;
    row.kind = RowKind::chain;
    row.size = 2;
    row.vertex = {from, to, 0, 0};
    row.coefficient = {1, -1, 0, 0};
    close(row, 0, kInfinity);
    list(row);
  }
}

// From the vertex of the corner to the point that divides the opposite side by `share`, at most `factor` times as steep
// as the river edge to `down`.
Row RowCatalog::way_row(std::uint32_t corner, std::uint32_t down, double share, double factor) const {
  const std::uint32_t v = terrain_.triangle[corner];
  const auto [u, w] = opposite(terrain_, corner);
  const Plane a = terrain_.position[u] - terrain_.position[v], b = terrain_.position[w] - terrain_.position[v];
  const Plane way = {(1 - share) * a[0] + share * b[0], (1 - share) * a[1] + share * b[1]};
  const double c = factor * norm(way) / norm(terrain_.position[down] - terrain_.position[v]);
  const double scale = std::max(1.0, c);
  Row row;
  row.kind = RowKind::contiguous;
  row.size = 4;
  row.vertex = {v, u, w, down};
  row.coefficient = {(c - 1) / scale, (1 - share) / scale, share / scale, -c / scale};
  close(row, 0, kInfinity);
  return row;
}

void RowCatalog::add_contiguous(std::span<const RiverEdge> rivers) {
  std::vector<std::uint8_t> ways(terrain_.num_vertices(), 0);
  down_of_.assign(terrain_.num_vertices(), kNone);
  for (const auto& [from, to] : rivers) {
    ways[from] = static_cast<std::uint8_t>(std::min(2, ways[from] + 1));
    down_of_[from] = to;
  }
  for (std::uint32_t v = 0; v < terrain_.num_vertices(); ++v)
    if (ways[v] != 1 || lake_of_[v] != 0) down_of_[v] = kNone;
  if (constraints_.contiguity != Contiguity::imaginary_points) return;
  for (const auto& edge : rivers) {
    const std::uint32_t v = edge.from, down = down_of_[v];
    if (down == kNone) continue;
    for (const std::uint32_t corner : links_.corners(v)) {
      const auto [u, w] = opposite(terrain_, corner);
      if (u == down || w == down) continue;
      const Plane a = terrain_.position[u] - terrain_.position[v], b = terrain_.position[w] - terrain_.position[v];
      const double angle = std::atan2(std::abs(cross(a, b)), dot(a, b));
      const std::uint32_t parts = constraints_.imaginary_points + 1;
      const double step = angle / parts;
      for (std::uint32_t i = 0; i <= parts; ++i) {
        // The ray at angle i * step from a meets the opposite side by the law of sines.
        const double near = norm(b) * std::sin(angle - i * step), far = norm(a) * std::sin(i * step);
        const double share = i == 0 ? 0 : i == parts ? 1 : far / (near + far);
        list(way_row(corner, down, share, std::cos(step / 2)));
      }
    }
  }
}

void RowCatalog::add_lakes() {
  for (const Lake& lake : constraints_.lakes) {
    std::vector<std::uint32_t> shore = lake.vertex;
    std::sort(shore.begin(), shore.end(),
              [&](std::uint32_t a, std::uint32_t b) { return terrain_.position[a] < terrain_.position[b]; });
    Row row;
    row.kind = RowKind::lake;
    for (std::size_t i = 1; i < shore.size(); ++i) {
      row.size = 2;
      row.vertex = {shore[i - 1], shore[i], 0, 0};
      row.coefficient = {1, -1, 0, 0};
      close(row, 0, 0);
      row.margin = 0;
      list(row);
    }
    if (!lake.has_level || shore.empty()) continue;
    row.size = 1;
    row.vertex = {shore[0], 0, 0, 0};
    row.coefficient = {1, 0, 0, 0};
    row.lower = row.upper = lake.level - terrain_.height[shore[0]];
    list(row);
  }
}

void RowCatalog::add_preserved() {
  for (PreservedEdge edge : constraints_.preserve) {
    if (terrain_.position[edge.b] < terrain_.position[edge.a]) std::swap(edge.a, edge.b);
    const Wingtips tips = wingtips(terrain_, links_, edge.a, edge.b);
    const auto keep_sign = [&](Row row) {
      close(row, 0, kInfinity);
      if (row.lower == 0) return;  // level: every type allows it, none is asked for
      if (row.lower > 0) {
        for (double& c : row.coefficient) c = -c;
        row.lower = -row.lower;
      }
      if (row.lower + row.margin <= 0) list(row);
    };
    double distance = 0;
    if (edge.drainage)
      for (int i = 0; i < tips.count; ++i) {
        Row row = valley_row(edge.a, edge.b, tips.vertex[i], distance);
        row.kind = RowKind::drainage;
        keep_sign(row);
      }
    if (!edge.curvature || tips.count < 2) continue;
    // The second wingtip against the plane of the first triangle.
    const Plane& origin = terrain_.position[edge.a];
    const Plane along = terrain_.position[edge.b] - origin, first = terrain_.position[tips.vertex[0]] - origin;
    const Plane second = terrain_.position[tips.vertex[1]] - origin;
    const double share = cross(along, second) / cross(along, first), b = cross(second, first) / cross(along, first);
    const double scale = std::max({1.0, std::abs(share), std::abs(b), std::abs(1 - share - b)});
    Row row;
    row.kind = RowKind::curvature;
    row.size = 4;
    row.vertex = {edge.a, edge.b, tips.vertex[0], tips.vertex[1]};
    row.coefficient = {-(1 - share - b) / scale, -b / scale, -share / scale, 1 / scale};
    keep_sign(row);
  }
}

void RowCatalog::index_rows() {
  begin_.assign(std::size_t{terrain_.num_vertices()} + 1, 0);
  for (const Row& row : listed_)
    for (std::uint32_t i = 0; i < row.size; ++i) ++begin_[row.vertex[i] + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  row_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t r = 0; r < listed_.size(); ++r)
    for (std::uint32_t i = 0; i < listed_[r].size; ++i) row_[next[listed_[r].vertex[i]]++] = r;
}

void RowCatalog::visit_edge(std::uint32_t a, std::uint32_t b, const Sink& sink) const {
  if (is_river_[a] || is_river_[b] || lake_of_[a] != 0 || lake_of_[b] != 0) return;
  const double width = constraints_.edge_slope_change * std::abs(terrain_.height[a] - terrain_.height[b]);
  if (!(width > 0)) return;  // flat
  Row row;
  row.kind = RowKind::slope_limit;
  row.size = 2;
  row.vertex = terrain_.position[a] < terrain_.position[b] ? std::array{a, b, 0u, 0u} : std::array{b, a, 0u, 0u};
  row.coefficient = {1, -1, 0, 0};
  row.key = (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
  row.margin = quantum_ > 0 ? quantum_ + kStorageSlack : 0;
  row.lower = -width;
  row.upper = width;
  if (width > row.margin) sink(row);  // narrower than two margins counts as flat
}

void RowCatalog::visit_triangle(std::uint32_t t, const Sink& sink) const {
  if (constraints_.directions.empty()) return;
  std::array<std::uint32_t, 3> v = {terrain_.triangle[3 * t], terrain_.triangle[3 * t + 1],
                                    terrain_.triangle[3 * t + 2]};
  for (const std::uint32_t corner : v)
    if (is_river_[corner] || lake_of_[corner] != 0) return;
  std::sort(v.begin(), v.end(),
            [&](std::uint32_t a, std::uint32_t b) { return terrain_.position[a] < terrain_.position[b]; });
  const Plane a = terrain_.position[v[1]] - terrain_.position[v[0]];
  const Plane b = terrain_.position[v[2]] - terrain_.position[v[0]];
  for (std::size_t i = 0; i < constraints_.directions.size(); ++i) {
    const Plane r = {std::cos(constraints_.directions[i]), std::sin(constraints_.directions[i])};
    // Slope along r = x (h1 - h0) + y (h2 - h0).
    const double x = cross(r, b) / cross(a, b), y = cross(a, r) / cross(a, b);
    const double scale = std::max({std::abs(x), std::abs(y), std::abs(x + y)});
    Row row;
    row.kind = RowKind::triangle_slope;
    row.size = 3;
    row.vertex = {v[0], v[1], v[2], 0};
    row.coefficient = {-(x + y) / scale, x / scale, y / scale, 0};
    row.key = kTriangle | (std::uint64_t{i} << 32) | t;
    close(row, 0, 0);  // its sides are now minus the old slope
    const double width = constraints_.triangle_slope_change * std::abs(row.lower);
    row.lower = -width;
    row.upper = width;
    if (width > row.margin) sink(row);
  }
}

// For each triangle at v the row of the steepest way down over it.
void RowCatalog::visit_cut(std::uint32_t v, std::span<const double> d, const Sink& sink) const {
  const std::uint32_t down = down_of_[v];
  if (down == kNone) return;
  const auto rise = [&](std::uint32_t w) { return terrain_.height[w] - terrain_.height[v] + (d[w] - d[v]); };
  for (const std::uint32_t corner : links_.corners(v)) {
    const auto [u, w] = opposite(terrain_, corner);
    if (u == down || w == down) continue;
    const Plane a = terrain_.position[u] - terrain_.position[v], b = terrain_.position[w] - terrain_.position[v];
    const double area = cross(a, b), hu = rise(u), hw = rise(w);
    const Plane descent = {-(hu * b[1] - hw * a[1]) / area, -(a[0] * hw - b[0] * hu) / area};
    const double x = cross(descent, b) / area, y = cross(a, descent) / area;
    if (x > 0 && y > 0) sink(way_row(corner, down, y / (x + y), 1));
    sink(way_row(corner, down, 0, 1));
    sink(way_row(corner, down, 1, 1));
  }
}

void RowCatalog::visit(std::uint32_t v, std::span<const double> d, const Sink& sink) const {
  for (std::uint32_t i = begin_[v]; i < begin_[v + 1]; ++i) sink(listed_[row_[i]]);
  const bool exact = constraints_.contiguity == Contiguity::exact;
  if (exact) visit_cut(v, d, sink);
  for (const std::uint32_t corner : links_.corners(v)) {
    const auto [u, w] = opposite(terrain_, corner);
    if (constraints_.limit_edge_slope) {
      visit_edge(v, u, sink);
      visit_edge(v, w, sink);
    }
    visit_triangle(corner / 3, sink);
    if (!exact) continue;
    visit_cut(u, d, sink);
    visit_cut(w, d, sink);
  }
}

void RowCatalog::visit_all(std::span<const double> d, const Sink& sink) const {
  for (const Row& row : listed_) sink(row);
  for (std::uint32_t t = 0; t < terrain_.num_triangles(); ++t) {
    // Limits of slopes allow that nothing moves: where nothing did they hold.
    const std::uint32_t* v = terrain_.triangle.data() + 3 * std::size_t{t};
    if (d[v[0]] == 0 && d[v[1]] == 0 && d[v[2]] == 0) continue;
    if (constraints_.limit_edge_slope)
      for (std::uint32_t i = 0; i < 3; ++i)
        visit_edge(terrain_.triangle[3 * t + i], terrain_.triangle[3 * t + (i + 1) % 3], sink);
    visit_triangle(t, sink);
  }
  if (constraints_.contiguity == Contiguity::exact)
    for (std::uint32_t v = 0; v < terrain_.num_vertices(); ++v) visit_cut(v, d, sink);
}

}  // namespace hydrotin
