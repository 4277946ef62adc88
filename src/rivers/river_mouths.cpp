#include "hydrotin/river_mouths.h"

#include <algorithm>
#include <queue>
#include <tuple>

#include "hydrotin/vertex_graph.h"

namespace hydrotin {
namespace {

constexpr auto kNone = static_cast<std::uint32_t>(-1);

class Flood {
 public:
  Flood(const RiverTerrain& terrain, std::span<const RiverEdge> rivers, std::span<const std::uint8_t> is_outlet)
      : t_(terrain),
        rivers_(rivers),
        is_outlet_(is_outlet),
        graph_(make_vertex_graph(terrain.num_vertices(), terrain.triangle)),
        is_river_(terrain.num_vertices(), 0),
        num_down_(terrain.num_vertices(), 0),
        next_(terrain.num_vertices(), kNone),
        level_(terrain.num_vertices(), 0),
        is_reached_(terrain.num_vertices(), 0) {
    for (const auto& [from, to] : rivers) {
      is_river_[from] = is_river_[to] = 1;
      ++num_down_[from];
    }
    num_open_ = num_down_;
    edges_.assign(rivers.begin(), rivers.end());
    std::sort(edges_.begin(), edges_.end());
  }

  OutletChains run() {
    OutletChains result;
    std::size_t wanted = 0;
    for (std::uint32_t v = 0; v < t_.num_vertices(); ++v) {
      if (is_river_[v] == 0 || num_down_[v] != 0) continue;
      result.mouth.push_back({v, is_outlet_[v] != 0 ? MouthKind::outlet : MouthKind::closed});
      wanted += is_outlet_[v] != 0 ? 0 : 1;
    }
    std::sort(result.mouth.begin(), result.mouth.end(),
              [&](const RiverMouth& a, const RiverMouth& b) { return t_.position[a.vertex] < t_.position[b.vertex]; });
    if (wanted > 0) flood(wanted);
    std::vector<std::uint8_t> is_in_chain(t_.num_vertices(), 0);
    for (RiverMouth& mouth : result.mouth) {
      if (is_outlet_[mouth.vertex] != 0 || is_reached_[mouth.vertex] == 0) continue;
      mouth.kind = MouthKind::chained;
      mouth.climb = level_[mouth.vertex] - t_.height[mouth.vertex];
      std::uint32_t v = mouth.vertex;
      while (next_[v] != kNone && is_in_chain[v] == 0 && num_down_[v] == 0) {
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
  void flood(std::size_t wanted) {
    using Entry = std::tuple<double, std::array<double, 2>, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    for (std::uint32_t v = 0; v < t_.num_vertices(); ++v) {
      if (is_outlet_[v] == 0 || num_down_[v] != 0) continue;  // a chain to a source on the rim could close a circle
      is_reached_[v] = 1;
      level_[v] = t_.height[v];
      open.emplace(level_[v], t_.position[v], v);
    }
    while (!open.empty() && wanted > 0) {
      const std::uint32_t v = std::get<2>(open.top());
      open.pop();
      for (const std::uint32_t w : graph_.neighbors(v)) {
        if (is_reached_[w] != 0) continue;
        // Of a river that parts every branch must have a way out first: else a chain could lead back into the river.
        if (num_down_[w] != 0) {
          if (!std::binary_search(edges_.begin(), edges_.end(), RiverEdge{w, v}) || --num_open_[w] != 0) continue;
        }
        is_reached_[w] = 1;
        next_[w] = v;
        level_[w] = std::max(level_[v], t_.height[w]);
        open.emplace(level_[w], t_.position[w], w);
        if (is_river_[w] != 0 && num_down_[w] == 0) --wanted;
      }
    }
  }

  const RiverTerrain& t_;
  std::span<const RiverEdge> rivers_;
  std::span<const std::uint8_t> is_outlet_;
  VertexGraph graph_;
  std::vector<std::uint8_t> is_river_;
  std::vector<std::uint32_t> num_down_, num_open_;  ///< river edges down: all, and to vertices not yet reached
  std::vector<std::uint32_t> next_;
  std::vector<double> level_;
  std::vector<std::uint8_t> is_reached_;
  std::vector<RiverEdge> edges_;
};

}  // namespace

OutletChains find_outlet_chains(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                std::span<const std::uint8_t> is_outlet) {
  return Flood(terrain, rivers, is_outlet).run();
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
