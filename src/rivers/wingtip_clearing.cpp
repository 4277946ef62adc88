#include "hydrotin/wingtip_clearing.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>

#include "editable_terrain.h"
#include "exact_ratio.h"

namespace hydrotin {
namespace {

constexpr auto kNone = static_cast<std::uint32_t>(-1);

/// River edges at each vertex, as they change.
class Shortener {
 public:
  Shortener(const LatticeTerrain& terrain, CleanNetwork& network)
      : t_(terrain),
        network_(network),
        next_(terrain.num_vertices(), kNone),
        above_(terrain.num_vertices(), kNone),
        num_in_(terrain.num_vertices(), 0),
        num_out_(terrain.num_vertices(), 0) {
    for (std::uint32_t e = 0; e < network.edge.size(); ++e) {
      const auto [from, to] = network.edge[e];
      next_[from] = e;
      above_[to] = e;
      ++num_out_[from];
      ++num_in_[to];
      pairs_.insert(std::minmax(from, to));
    }
  }

  std::uint64_t run() {
    const auto by_place = [this](std::uint32_t a, std::uint32_t b) { return t_.position[a] < t_.position[b]; };
    std::set<std::uint32_t, decltype(by_place)> open(by_place);
    for (const auto& edge : network_.edge) open.insert(edge.to);
    find_third_edges();
    std::uint64_t taken = 0;
    while (!open.empty()) {
      const std::uint32_t middle = *open.begin();
      open.erase(open.begin());
      if (num_in_[middle] != 1 || num_out_[middle] != 1) continue;
      const std::uint32_t up = above_[middle], down = next_[middle];
      const std::uint32_t a = network_.edge[up].from, c = network_.edge[down].to;
      if (!is_triangle(a, middle, c) || pairs_.contains(std::minmax(a, c))) continue;
      replace(up, down, a, middle, c);
      ++taken;
      open.insert(a);
      open.insert(c);
    }
    compact();
    return taken;
  }

 private:
  // Triangles with two river edges at some time: all triangles of river vertices only.
  void find_third_edges() {
    for (std::uint32_t t = 0; t < t_.triangle.size(); t += 3) {
      std::array<std::uint32_t, 3> v = {t_.triangle[t], t_.triangle[t + 1], t_.triangle[t + 2]};
      for (const std::uint32_t w : v)
        if (num_in_[w] + num_out_[w] == 0) v[0] = kNone;
      if (v[0] == kNone) continue;
      std::sort(v.begin(), v.end());
      triangles_.push_back(v);
    }
    std::sort(triangles_.begin(), triangles_.end());
  }

  [[nodiscard]] bool is_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    std::array<std::uint32_t, 3> v = {a, b, c};
    std::sort(v.begin(), v.end());
    return std::binary_search(triangles_.begin(), triangles_.end(), v);
  }

  void replace(std::uint32_t up, std::uint32_t down, std::uint32_t a, std::uint32_t middle, std::uint32_t c) {
    pairs_.erase(std::minmax(a, middle));
    pairs_.erase(std::minmax(middle, c));
    pairs_.insert(std::minmax(a, c));
    network_.edge[up] = {a, c};
    network_.edge[down] = {kNone, kNone};
    if (above_[c] == down) above_[c] = up;
    num_in_[middle] = num_out_[middle] = 0;
  }

  void compact() {
    std::vector<std::uint32_t> order;
    for (std::uint32_t e = 0; e < network_.edge.size(); ++e)
      if (network_.edge[e].from != kNone) order.push_back(e);
    std::sort(order.begin(), order.end(), [&](std::uint32_t x, std::uint32_t y) {
      const RiverEdge &a = network_.edge[x], &b = network_.edge[y];
      return std::pair(t_.position[a.from], t_.position[a.to]) < std::pair(t_.position[b.from], t_.position[b.to]);
    });
    std::vector<RiverEdge> edge;
    std::vector<std::uint32_t> line;
    for (const std::uint32_t e : order) {
      edge.push_back(network_.edge[e]);
      line.push_back(network_.line[e]);
    }
    network_.edge = std::move(edge);
    network_.line = std::move(line);
  }

  const LatticeTerrain& t_;
  CleanNetwork& network_;
  std::vector<std::uint32_t> next_, above_;  ///< an edge down, an edge up; the only one where there is one
  std::vector<std::uint32_t> num_in_, num_out_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

class Splitter {
 public:
  Splitter(LatticeTerrain& terrain, std::span<const RiverEdge> rivers, std::span<const RiverEdge> chain,
           std::span<const std::uint32_t> lake)
      : result_(terrain),
        is_way_(terrain.num_vertices(), 0),
        lake_(lake.begin(), lake.end()),
        mesh_(std::move(terrain)) {
    lake_.resize(is_way_.size(), 0);
    for (const auto& edges : {rivers, chain})
      for (const auto& [from, to] : edges) {
        is_way_[from] = is_way_[to] = 1;
        if (const std::uint32_t h = mesh_.find_edge(from, to); h != kNoHalfedge) mesh_.constrain(h);
      }
    for (const auto& [from, to] : rivers) rivers_.push_back(std::minmax({from, to}));
    std::sort(rivers_.begin(), rivers_.end());
  }

  ClearedWingtips run() {
    const LatticeTerrain& t = mesh_.terrain();
    std::vector<std::array<LatticePoint, 3>> bad;
    std::vector<std::uint32_t> number;
    for (std::uint32_t i = 0; i < t.triangle.size() / 3; ++i) {
      if (!is_bad(i)) continue;
      bad.push_back(
          {t.position[t.triangle[3 * i]], t.position[t.triangle[3 * i + 1]], t.position[t.triangle[3 * i + 2]]});
      std::sort(bad.back().begin(), bad.back().end());
      number.push_back(i);
    }
    std::vector<std::uint32_t> order(bad.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return bad[a] < bad[b]; });
    // A split makes no new bad triangle: a triangle keeps its number while it is bad.
    for (const std::uint32_t i : order)
      if (is_bad(number[i]) && !split(number[i])) ++cleared_.num_left;
    result_ = mesh_.take();
    return cleared_;
  }

 private:
  [[nodiscard]] bool is_bad(std::uint32_t triangle) const {
    const LatticeTerrain& t = mesh_.terrain();
    for (std::uint32_t h = 3 * triangle; h < 3 * triangle + 3; ++h) {
      const std::uint32_t a = t.origin(h), b = t.target(h), w = t.apex(h);
      if (is_way_[w] == 0 && lake_[w] == 0) continue;
      if (lake_[w] != 0 && lake_[a] == lake_[w] && lake_[b] == lake_[w]) continue;
      if (mesh_.is_constrained(h) && std::binary_search(rivers_.begin(), rivers_.end(), std::minmax({a, b})))
        return true;
    }
    return false;
  }

  bool split(std::uint32_t triangle) {
    const LatticeTerrain& t = mesh_.terrain();
    std::vector<std::uint32_t> edges;
    for (std::uint32_t h = 3 * triangle; h < 3 * triangle + 3; ++h)
      if (!mesh_.is_constrained(h) && (lake_[t.origin(h)] == 0 || lake_[t.origin(h)] != lake_[t.target(h)]))
        edges.push_back(h);
    // Inner edges first, longer ones first, ties by place.
    const auto key = [&](std::uint32_t h) {
      const auto [a, b] = std::minmax(t.position[t.origin(h)], t.position[t.target(h)]);
      return std::tuple(t.twin[h] == kNoHalfedge, -dot_from(a, b, b), a, b);
    };
    std::sort(edges.begin(), edges.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    for (const std::uint32_t h : edges) {
      const auto [a, b] = std::minmax(t.position[t.origin(h)], t.position[t.target(h)]);
      for (const LatticePoint& p : middles(std::int64_t{a.x} + b.x, std::int64_t{a.y} + b.y, 2)) {
        if (!mesh_.can_split_edge(h, p)) continue;
        if (t.twin[h] == kNoHalfedge && doubled_area(t.position[t.origin(h)], t.position[t.target(h)], p) < 0) continue;
        const double low = std::min(t.height[t.origin(h)], t.height[t.target(h)]);
        const double high = std::max(t.height[t.origin(h)], t.height[t.target(h)]);
        return finish(mesh_.split_edge(h, p, low + (high - low) / 2));
      }
    }
    const std::uint32_t* v = t.triangle.data() + 3 * std::size_t{triangle};
    const LatticePoint a = t.position[v[0]], b = t.position[v[1]], c = t.position[v[2]];
    for (const LatticePoint& p : middles(std::int64_t{a.x} + b.x + c.x, std::int64_t{a.y} + b.y + c.y, 3))
      if (doubled_area(a, b, p) > 0 && doubled_area(b, c, p) > 0 && doubled_area(c, a, p) > 0)
        return finish(mesh_.split_triangle(triangle, p, interpolate(t, triangle, p)));
    return false;
  }

  bool finish(std::uint32_t) {
    is_way_.push_back(0);
    lake_.push_back(0);
    ++cleared_.num_points;
    return true;
  }

  // The lattice points around (x, y) / n.
  static std::vector<LatticePoint> middles(std::int64_t x, std::int64_t y, std::int64_t n) {
    const auto below = [n](std::int64_t s) { return static_cast<std::int32_t>(s >= 0 ? s / n : -((-s + n - 1) / n)); };
    const std::int32_t west = below(x), south = below(y);
    std::vector<LatticePoint> points;
    for (std::int32_t dx = 0; dx <= (x % n != 0 ? 1 : 0); ++dx)
      for (std::int32_t dy = 0; dy <= (y % n != 0 ? 1 : 0); ++dy) points.push_back({west + dx, south + dy});
    return points;
  }

  LatticeTerrain& result_;
  std::vector<std::uint8_t> is_way_;  ///< on a river or an outlet chain
  std::vector<std::uint32_t> lake_;
  EditableTerrain mesh_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> rivers_;
  ClearedWingtips cleared_;
};

}  // namespace

std::uint64_t take_third_edges(const LatticeTerrain& terrain, CleanNetwork& network) {
  return Shortener(terrain, network).run();
}

ClearedWingtips clear_wingtips(LatticeTerrain& terrain, std::span<const RiverEdge> rivers,
                               std::span<const RiverEdge> chain, std::span<const std::uint32_t> lake) {
  return Splitter(terrain, rivers, chain, lake).run();
}

}  // namespace hydrotin
