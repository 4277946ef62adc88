#include "hydrotin/river_mouths.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <unordered_map>

#include "hydrotin/vertex_graph.h"

namespace hydrotin {
namespace {

constexpr auto kNone = static_cast<std::uint32_t>(-1);

/// Which vertices have a way out, and at what level; each lake as one vertex.
class Drainage {
 public:
  Drainage(const RiverTerrain& terrain, std::span<const RiverEdge> rivers, std::span<const std::uint8_t> is_outlet,
           std::span<const std::uint32_t> lake)
      : terrain_(terrain),
        is_outlet_(is_outlet),
        lake_(lake.begin(), lake.end()),
        is_river_(terrain.num_vertices(), 0),
        num_open_(terrain.num_vertices(), 0),
        level_(terrain.num_vertices(), kDry) {
    lake_.resize(terrain.num_vertices(), 0);
    find_lakes();
    for (const auto& [from, to] : rivers) {
      is_river_[from] = is_river_[to] = 1;
      if (lake_[from] != 0 && lake_[from] == lake_[to]) continue;
      edges_.push_back({node_of(to), node_of(from)});
      ++num_open_[node_of(from)];
    }
    std::sort(edges_.begin(), edges_.end());
    num_down_ = num_open_;
  }

  /// The first member stands for a lake.
  [[nodiscard]] std::uint32_t node_of(std::uint32_t v) const {
    return lake_[v] == 0 ? v : members_[lake_begin_[lake_[v]]].second;
  }
  [[nodiscard]] bool is_drained(std::uint32_t v) const { return level_[node_of(v)] != kDry; }
  [[nodiscard]] double level(std::uint32_t v) const { return level_[node_of(v)]; }
  /// A river vertex that no river edge leaves; in a lake the lake's river edges count.
  [[nodiscard]] bool is_mouth(std::uint32_t v) const { return is_river_[v] != 0 && num_down_[node_of(v)] == 0; }
  [[nodiscard]] bool is_lake(std::uint32_t v) const { return lake_[v] != 0; }
  /// A vertex that water cannot cross unseen: of a river or a lake.
  [[nodiscard]] bool is_water(std::uint32_t v) const { return is_river_[v] != 0 || lake_[v] != 0; }
  /// An outlet or a lake, and no river leaves it. (A chain could lead a river that leaves an outlet back to it.)
  [[nodiscard]] bool ends(std::uint32_t v) const {
    return num_down_[node_of(v)] == 0 && (is_outlet_[v] != 0 || lake_[v] != 0);
  }

  /// Gives a node and all rivers above that now have a way out everywhere their levels; lists these nodes.
  void drain(std::uint32_t v, double level, std::vector<std::uint32_t>& drained) {
    const std::uint32_t node = node_of(v);
    if (level_[node] != kDry) return;
    level_[node] = std::max(level, surface(node));
    const std::size_t first = drained.size();
    drained.push_back(node);
    for (std::size_t i = first; i < drained.size(); ++i) {
      const std::uint32_t d = drained[i];
      for (auto e = std::lower_bound(edges_.begin(), edges_.end(), RiverEdge{d, 0}); e != edges_.end() && e->from == d;
           ++e) {
        // Of a river that parts every branch must have a way out first: else a chain could lead back into the river.
        if (--num_open_[e->to] != 0) continue;
        level_[e->to] = surface(e->to);
        for (const std::uint32_t below : below_of(e->to)) level_[e->to] = std::max(level_[e->to], level_[below]);
        drained.push_back(e->to);
      }
    }
  }

  /// All nodes that end, and the rivers above them.
  void drain_ends() {
    std::vector<std::uint32_t> drained;
    for (std::uint32_t v = 0; v < terrain_.num_vertices(); ++v)
      if (ends(v)) drain(v, terrain_.height[v], drained);
  }

 private:
  static constexpr double kDry = std::numeric_limits<double>::infinity();

  void find_lakes() {
    for (std::uint32_t v = 0; v < lake_.size(); ++v)
      if (lake_[v] != 0) members_.emplace_back(lake_[v], v);
    std::sort(members_.begin(), members_.end());
    lake_begin_.assign(members_.empty() ? 1 : std::size_t{members_.back().first} + 2, 0);
    for (const auto& [lake, v] : members_) ++lake_begin_[lake + 1];
    for (std::size_t i = 1; i < lake_begin_.size(); ++i) lake_begin_[i] += lake_begin_[i - 1];
  }

  [[nodiscard]] double surface(std::uint32_t node) const {
    double water = terrain_.height[node];
    if (lake_[node] == 0) return water;
    for (std::size_t m = lake_begin_[lake_[node]]; m < lake_begin_[lake_[node] + 1]; ++m)
      water = std::min(water, terrain_.height[members_[m].second]);
    return water;
  }

  // Built when first asked for: the river edges downstream.
  [[nodiscard]] std::vector<std::uint32_t> below_of(std::uint32_t node) {
    if (downstream_.empty()) {
      for (const auto& [to, from] : edges_) downstream_.push_back({from, to});
      std::sort(downstream_.begin(), downstream_.end());
    }
    std::vector<std::uint32_t> below;
    for (auto e = std::lower_bound(downstream_.begin(), downstream_.end(), RiverEdge{node, 0});
         e != downstream_.end() && e->from == node; ++e)
      below.push_back(e->to);
    return below;
  }

  const RiverTerrain& terrain_;
  std::span<const std::uint8_t> is_outlet_;
  std::vector<std::uint32_t> lake_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> members_;  ///< (lake, vertex)
  std::vector<std::size_t> lake_begin_;                           ///< first member of each lake
  std::vector<std::uint8_t> is_river_;
  std::vector<std::uint32_t> num_open_, num_down_;  ///< of a node: river edges to places without a way out; in all
  std::vector<double> level_;                       ///< of a node
  std::vector<RiverEdge> edges_;  ///< between nodes, turned round: from the lower end to the upper one
  std::vector<RiverEdge> downstream_;
};

/// Looks for ways out of all mouths at once, always on from where the water stands lowest.
class ChainSearch {
 public:
  ChainSearch(const RiverTerrain& terrain, std::span<const RiverEdge> rivers, std::span<const std::uint8_t> is_outlet,
              std::span<const std::uint32_t> lake, std::span<const std::uint8_t> is_complete)
      : terrain_(terrain),
        is_complete_(is_complete),
        drainage_(terrain, rivers, is_outlet, lake),
        graph_(make_vertex_graph(terrain.num_vertices(), terrain.triangle)),
        next_(terrain.num_vertices(), kNone) {}

  OutletChains run() {
    list_mouths();
    drainage_.drain_ends();
    for (std::uint32_t m = 0; m < result_.mouth.size(); ++m)
      if (result_.mouth[m].kind == MouthKind::closed) visit(m, result_.mouth[m].vertex, kNone, -kInfinity);
    while (!open_.empty()) {
      const Step step = open_.top();
      open_.pop();
      if (result_.mouth[step.mouth].kind != MouthKind::closed) continue;
      if (!came_from_.emplace(key(step.mouth, step.vertex), step.parent).second) continue;
      if (step.parent != kNone && drainage_.is_drained(step.vertex))
        settle(step);
      else
        expand(step);
    }
    std::sort(result_.edge.begin(), result_.edge.end(), [&](const RiverEdge& a, const RiverEdge& b) {
      return terrain_.position[a.from] < terrain_.position[b.from];
    });
    std::sort(result_.incomplete.begin(), result_.incomplete.end());
    result_.incomplete.erase(std::unique(result_.incomplete.begin(), result_.incomplete.end()),
                             result_.incomplete.end());
    return std::move(result_);
  }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  struct Step {
    double level = 0;   ///< highest vertex on the way so far, and beyond where that is known
    double height = 0;  ///< of the vertex: downhill first, so that a way through a plain stays narrow
    std::uint32_t vertex = 0, parent = 0, mouth = 0;
  };

  /// By places: no numbering of vertices decides.
  struct Later {
    const RiverTerrain* terrain;
    bool operator()(const Step& a, const Step& b) const {
      if (a.level != b.level) return a.level > b.level;
      if (a.height != b.height) return a.height > b.height;
      if (a.vertex != b.vertex) return terrain->position[a.vertex] > terrain->position[b.vertex];
      if (a.mouth != b.mouth) return a.mouth > b.mouth;
      if (a.parent == kNone || b.parent == kNone) return a.parent != kNone;
      return terrain->position[a.parent] > terrain->position[b.parent];
    }
  };

  [[nodiscard]] static std::uint64_t key(std::uint32_t mouth, std::uint32_t v) {
    return (std::uint64_t{mouth} << 32) | v;
  }

  void list_mouths() {
    for (std::uint32_t v = 0; v < terrain_.num_vertices(); ++v)
      if (drainage_.is_mouth(v))
        result_.mouth.push_back({v, drainage_.ends(v) ? MouthKind::outlet : MouthKind::closed});
    std::sort(result_.mouth.begin(), result_.mouth.end(), [&](const RiverMouth& a, const RiverMouth& b) {
      return terrain_.position[a.vertex] < terrain_.position[b.vertex];
    });
  }

  /// Water of mouth m comes from `parent` to v.
  void visit(std::uint32_t m, std::uint32_t v, std::uint32_t parent, double level) {
    if (came_from_.contains(key(m, v))) return;
    const bool is_start = parent == kNone;
    if (!is_start && drainage_.is_drained(v))
      level = std::max(level, drainage_.level(v));
    else if (!is_start && drainage_.is_water(v)) {
      waiting_[drainage_.node_of(v)].push_back({level, terrain_.height[v], v, parent, m});
      return;
    } else {
      level = std::max(level, terrain_.height[v]);
    }
    open_.push({level, terrain_.height[v], v, parent, m});
  }

  void expand(const Step& step) {
    if (!is_complete_.empty() && is_complete_[step.vertex] == 0) result_.incomplete.push_back(step.vertex);
    for (const std::uint32_t w : graph_.neighbors(step.vertex)) visit(step.mouth, w, step.vertex, step.level);
  }

  /// A mouth has its way: down to where an earlier chain goes on, or to its end.
  void settle(const Step& step) {
    RiverMouth& mouth = result_.mouth[step.mouth];
    mouth.kind = MouthKind::chained;
    mouth.climb = step.level - terrain_.height[mouth.vertex];
    std::vector<std::uint32_t> way{step.vertex};
    for (std::uint32_t v = step.parent; v != kNone; v = came_from_.at(key(step.mouth, v))) way.push_back(v);
    for (std::size_t i = way.size() - 1; i > 0 && next_[way[i]] == kNone; --i) {
      next_[way[i]] = way[i - 1];
      result_.edge.push_back({way[i], way[i - 1]});
      ++mouth.length;
    }
    std::vector<std::uint32_t> drained;
    drainage_.drain(mouth.vertex, step.level, drained);
    for (const std::uint32_t node : drained) {
      const auto found = waiting_.find(node);
      if (found == waiting_.end()) continue;
      const std::vector<Step> steps = std::move(found->second);
      waiting_.erase(found);
      for (const Step& s : steps) visit(s.mouth, s.vertex, s.parent, s.level);
    }
  }

  const RiverTerrain& terrain_;
  std::span<const std::uint8_t> is_complete_;
  Drainage drainage_;
  VertexGraph graph_;
  std::vector<std::uint32_t> next_;                               ///< along chains
  std::unordered_map<std::uint64_t, std::uint32_t> came_from_;    ///< of (mouth, vertex)
  std::unordered_map<std::uint32_t, std::vector<Step>> waiting_;  ///< at nodes without a way out yet
  std::priority_queue<Step, std::vector<Step>, Later> open_{Later{&terrain_}};
  OutletChains result_;
};

}  // namespace

OutletChains find_outlet_chains(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                                std::span<const std::uint8_t> is_outlet, std::span<const std::uint32_t> lake,
                                std::span<const std::uint8_t> is_complete) {
  return ChainSearch(terrain, rivers, is_outlet, lake, is_complete).run();
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
