#include "hydrotin/river_mouths.h"

#include <algorithm>
#include <queue>
#include <tuple>

#include "hydrotin/vertex_graph.h"

namespace hydrotin {
namespace {

constexpr auto kNone = static_cast<std::uint32_t>(-1);

/// Vertices, each lake as one: its members are reached together.
class Flood {
 public:
  Flood(const RiverTerrain& terrain, std::span<const RiverEdge> rivers, std::span<const std::uint8_t> is_outlet,
        std::span<const std::uint32_t> lake)
      : t_(terrain),
        is_outlet_(is_outlet),
        lake_(lake.begin(), lake.end()),
        graph_(make_vertex_graph(terrain.num_vertices(), terrain.triangle)),
        is_river_(terrain.num_vertices(), 0),
        num_open_(terrain.num_vertices(), 0),
        next_(terrain.num_vertices(), kNone),
        level_(terrain.num_vertices(), 0),
        is_reached_(terrain.num_vertices(), 0) {
    lake_.resize(terrain.num_vertices(), 0);
    for (std::uint32_t v = 0; v < lake_.size(); ++v)
      if (lake_[v] != 0) members_.emplace_back(lake_[v], v);
    std::sort(members_.begin(), members_.end());
    for (const auto& [from, to] : rivers) {
      is_river_[from] = is_river_[to] = 1;
      if (lake_[from] != 0 && lake_[from] == lake_[to]) continue;
      edges_.push_back({to, from});
      ++num_open_[node_of(from)];
    }
    std::sort(edges_.begin(), edges_.end());
    num_down_ = num_open_;
  }

  OutletChains run() {
    OutletChains result;
    std::size_t wanted = 0;
    for (std::uint32_t v = 0; v < t_.num_vertices(); ++v) {
      if (is_river_[v] == 0 || num_down_[node_of(v)] != 0) continue;
      const bool is_there = is_outlet_[v] != 0 || lake_[v] != 0;
      result.mouth.push_back({v, is_there ? MouthKind::outlet : MouthKind::closed});
      wanted += is_there ? 0 : 1;
    }
    std::sort(result.mouth.begin(), result.mouth.end(),
              [&](const RiverMouth& a, const RiverMouth& b) { return t_.position[a.vertex] < t_.position[b.vertex]; });
    if (wanted > 0) flood(wanted);
    std::vector<std::uint8_t> is_in_chain(t_.num_vertices(), 0);
    for (RiverMouth& mouth : result.mouth) {
      if (mouth.kind == MouthKind::outlet || is_reached_[mouth.vertex] == 0) continue;
      mouth.kind = MouthKind::chained;
      mouth.climb = level_[mouth.vertex] - t_.height[mouth.vertex];
      std::uint32_t v = mouth.vertex;
      while (next_[v] != kNone && is_in_chain[v] == 0) {
        is_in_chain[v] = 1;
        result.edge.push_back({v, next_[v]});
        ++mouth.length;
        v = next_[v];
      }
    }
    std::sort(result.edge.begin(), result.edge.end(),
              [&](const RiverEdge& a, const RiverEdge& b) { return t_.position[a.from] < t_.position[b.from]; });
    return result;
  }

 private:
  /// The first member stands for a lake.
  [[nodiscard]] std::uint32_t node_of(std::uint32_t v) const {
    return lake_[v] == 0 ? v : std::lower_bound(members_.begin(), members_.end(), std::pair(lake_[v], 0u))->second;
  }

  void flood(std::size_t wanted) {
    // A river that leaves a source on the rim could be led back to it by a chain: such a vertex is none.
    for (std::uint32_t v = 0; v < t_.num_vertices(); ++v)
      if (num_down_[node_of(v)] == 0 && (is_outlet_[v] != 0 || lake_[v] != 0)) reach(v, t_.height[v], kNone);
    while (!open_.empty() && wanted > 0) {
      const std::uint32_t v = std::get<2>(open_.top());
      open_.pop();
      // Of a river that parts every branch must have a way out first: else a chain could lead back into the river.
      for (auto e = std::lower_bound(edges_.begin(), edges_.end(), RiverEdge{v, 0}); e != edges_.end() && e->from == v;
           ++e)
        if (--num_open_[node_of(e->to)] == 0) reach(e->to, level_[v], kNone);
      for (const std::uint32_t w : graph_.neighbors(v)) {
        if (is_reached_[w] != 0 || num_down_[node_of(w)] != 0) continue;
        reach(w, level_[v], v);
        wanted -= is_river_[w] != 0 && lake_[w] == 0 ? 1 : 0;
      }
    }
  }

  void reach(std::uint32_t v, double level, std::uint32_t next) {
    if (is_reached_[v] != 0) return;
    if (lake_[v] == 0) {
      put(v, std::max(level, t_.height[v]), next);
      return;
    }
    const auto first = std::lower_bound(members_.begin(), members_.end(), std::pair(lake_[v], 0u));
    double water = t_.height[v];
    for (auto m = first; m != members_.end() && m->first == lake_[v]; ++m)
      water = std::min(water, t_.height[m->second]);
    for (auto m = first; m != members_.end() && m->first == lake_[v]; ++m)
      put(m->second, std::max(level, water), kNone);
  }

  void put(std::uint32_t v, double level, std::uint32_t next) {
    is_reached_[v] = 1;
    level_[v] = level;
    next_[v] = next;
    open_.emplace(level, t_.position[v], v);
  }

  using Entry = std::tuple<double, std::array<double, 2>, std::uint32_t>;

  const RiverTerrain& t_;
  std::span<const std::uint8_t> is_outlet_;
  std::vector<std::uint32_t> lake_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> members_;  ///< (lake, vertex)
  VertexGraph graph_;
  std::vector<std::uint8_t> is_river_;
  std::vector<std::uint32_t> num_open_, num_down_;  ///< of a node: river edges out of it; those to places not yet taken
  std::vector<std::uint32_t> next_;                 ///< on the way out, for what is no river; none elsewhere
  std::vector<double> level_;
  std::vector<std::uint8_t> is_reached_;
  std::vector<RiverEdge> edges_;  ///< turned round: from the lower end to the upper one
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open_;
};

}  // namespace

OutletChains find_outlet_chains(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                std::span<const std::uint8_t> is_outlet, std::span<const std::uint32_t> lake) {
  return Flood(terrain, rivers, is_outlet, lake).run();
}

std::vector<std::uint8_t> rim_vertices(const RiverTerrain& terrain) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(terrain.triangle.size());
  for (std::size_t t = 0; t < terrain.triangle.size(); t += 3)
    for (std::size_t i = 0; i < 3; ++i)
      edges.push_back(std::minmax({terrain.triangle[t + i], terrain.triangle[t + (i + 1) % 3]}));
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint8_t> on_rim(terrain.num_vertices(), 0);
  for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
    while (j < edges.size() && edges[j] == edges[i]) ++j;
    if (j == i + 1) on_rim[edges[i].first] = on_rim[edges[i].second] = 1;
  }
  return on_rim;
}

}  // namespace hydrotin
