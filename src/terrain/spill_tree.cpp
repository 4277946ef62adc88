#include "hydrotin/spill_tree.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>

#include "flood.h"
#include "height_key.h"
#include "hydrotin/lifting.h"
#include "radix_sort.h"
#include "union_find.h"

namespace hydrotin {
namespace {

// The vertices of a rim in ascending order of their global ids.
std::vector<std::uint32_t> sorted_rim(std::span<const std::uint64_t> global_id, std::span<const std::uint8_t> is_rim) {
  std::vector<std::uint32_t> rim;
  for (std::uint32_t v = 0; v < is_rim.size(); ++v)
    if (is_rim[v]) rim.push_back(v);
  std::sort(rim.begin(), rim.end(), [&](std::uint32_t a, std::uint32_t b) { return global_id[a] < global_id[b]; });
  return rim;
}

// Terminals are numbered 0 .. R - 1 as the rim, R for the outlets, and nothing beyond.
constexpr std::uint32_t kUnlabelled = kOutlet;

// Edges of the part between catchments of different terminals, as spill edges with terminal numbers.
//
// d(v) = the minimax height from v to the nearest terminal, label(v) = a terminal that attains it; both come from a
// flood with all terminals as sources at their own heights. An edge vw of the part stands for a path label(v) - v - w -
// label(w) of height max(d(v), d(w)). These edges keep all minimax heights between terminals, whatever labels attain a
// tie:
// - none is too low, being a path of that height;
// - if terminals a and b are joined by a path of height t, each vertex u of it has d(u) <= t (go on to b), so each edge
// of
//   the path is an edge of height <= t between labels or joins equal labels, and leads from label(a) = a to label(b) =
//   b. (A terminal is its own nearest: every path contains its start.)
//
// Of the edges between two catchments only the lowest counts. They are found one after the other along the border of
// the two, so a table of a few pairs, each overwritten by the next that falls on its place, drops most of the others.
class SpillEdges {
 public:
  void add(std::uint32_t a, std::uint32_t b, std::int32_t height) {
    const SpillEdge edge{std::min(a, b), std::max(a, b), height};
    std::uint32_t& last = last_[(edge.a * 0x9e3779b1u + edge.b * 0x85ebca77u) >> (32 - kTableBits)];
    if (last < edge_.size() && edge_[last].a == edge.a && edge_[last].b == edge.b) {
      edge_[last].height = std::min(edge_[last].height, height);
      return;
    }
    last = static_cast<std::uint32_t>(edge_.size());
    edge_.push_back(edge);
  }
  [[nodiscard]] std::vector<SpillEdge>& edges() { return edge_; }

 private:
  static constexpr int kTableBits = 12;
  std::vector<SpillEdge> edge_;
  std::vector<std::uint32_t> last_ = std::vector<std::uint32_t>(std::size_t{1} << kTableBits, 0);  // places in `edge_`
};

/// Hands labels on, and collects the edges between catchments.
struct CatchmentVisitor {
  std::span<std::uint32_t> label;
  std::span<const std::int32_t> level;
  SpillEdges& between;

  void reach(std::uint32_t v, std::uint32_t w) const { label[w] = label[v]; }
  [[nodiscard]] bool parts(std::uint32_t v, std::uint32_t w) const { return label[v] != label[w]; }
  void meet(std::uint32_t v, std::uint32_t w) const { between.add(label[v], label[w], std::max(level[v], level[w])); }
};

}  // namespace

SpillTree reduce_to_rim(const VertexGraph& graph, std::span<const std::int32_t> height,
                        std::span<const std::uint64_t> global_id, std::span<const std::uint8_t> is_rim,
                        std::span<const std::uint8_t> is_outlet, Catchments* catchments) {
  assert(height.size() == graph.num_vertices() && is_outlet.size() == height.size() && "one entry per vertex");
  assert(global_id.size() == height.size() && is_rim.size() == height.size() && "one entry per vertex");
  SpillTree tree;
  const std::vector<std::uint32_t> rim = sorted_rim(global_id, is_rim);
  const auto outlets = static_cast<std::uint32_t>(rim.size());
  std::vector<std::int32_t> level(height.begin(), height.end());
  std::vector<std::uint32_t> label(height.size(), kUnlabelled);
  Flood flood(graph, level);
  for (std::uint32_t r = 0; r < outlets; ++r) {
    tree.rim.push_back(global_id[rim[r]]);
    assert((r == 0 || tree.rim[r - 1] < tree.rim[r]) && "global ids are distinct");
    label[rim[r]] = r;
    flood.add_source(rim[r], height[rim[r]]);
  }
  SpillEdges between;
  for (std::uint32_t v = 0; v < height.size(); ++v) {
    assert(height[v] != kNoLevel && "this height means no level");
    if (!is_outlet[v]) continue;
    if (is_rim[v]) {
      between.add(label[v], outlets, height[v]);
    } else {
      label[v] = outlets;
      flood.add_source(v, height[v]);
    }
  }
  flood.run(CatchmentVisitor{label, level, between});
  std::vector<SpillEdge>& edges = between.edges();

  // Kruskal. Any order of equal heights gives a minimax forest: at each height the same sets of terminals are joined.
  radix_sort(edges, [](const SpillEdge& e) { return biased(e.height); });
  UnionFind joined(std::size_t{outlets} + 1);
  for (SpillEdge e : edges) {
    if (!joined.unite(e.a, e.b)) continue;
    if (e.b == outlets) e.b = kOutlet;
    tree.edge.push_back(e);
  }
  if (catchments != nullptr) {
    for (std::uint32_t& terminal : label)
      if (terminal == outlets) terminal = kOutlet;
    *catchments = {std::move(level), std::move(label)};
  }
  return tree;
}

// With m = minimax heights inside the part, d(v) = m(v, l) the level of v's catchment and l its terminal:
// f(v) = max(d(v), f(l)). Not more: the way through l climbs to that. Not less: let t be the first terminal on v's best
// way out, f(v) = max(m(v, t), f(t)). Then d(v) <= m(v, t), and from l through v to t, f(l) <= max(d(v), m(v, t), f(t))
// = f(v). For the terminal of the outlets f(l) <= d(v) already.
std::vector<std::int32_t> lift_catchments(const Catchments& catchments, std::span<const std::int32_t> rim_level) {
  std::vector<std::int32_t> level = catchments.level;
  for (std::size_t v = 0; v < level.size(); ++v) {
    const std::uint32_t terminal = catchments.terminal[v];
    if (terminal == kOutlet) continue;
    assert(terminal < rim_level.size() && "one level per rim vertex");
    level[v] = std::max(level[v], rim_level[terminal]);
  }
  return level;
}

std::vector<std::int32_t> RimLevels::of(std::span<const std::uint64_t> ids) const {
  std::vector<std::int32_t> result;
  result.reserve(ids.size());
  auto from = vertex.begin();
  std::uint64_t previous = 0;
  for (const std::uint64_t id : ids) {
    if (id < previous) from = vertex.begin();
    previous = id;
    from = std::lower_bound(from, vertex.end(), id);
    assert(from != vertex.end() && *from == id && "the vertex is on no rim");
    result.push_back(level[static_cast<std::size_t>(from - vertex.begin())]);
  }
  return result;
}

bool is_valid(const SpillTree& tree) {
  const std::size_t num_rim = tree.rim.size();
  return num_rim < kOutlet && tree.edge.size() <= num_rim &&
         std::adjacent_find(tree.rim.begin(), tree.rim.end(), std::greater_equal<>{}) == tree.rim.end() &&
         std::all_of(tree.edge.begin(), tree.edge.end(), [&](const SpillEdge& e) {
           return e.a < num_rim && (e.b < num_rim || e.b == kOutlet) && e.height != kNoLevel;
         });
}

namespace {

std::vector<std::uint64_t> distinct_rim(std::span<const SpillTree> parts) {
  std::vector<std::uint64_t> vertex;
  std::size_t total = 0;
  for (const SpillTree& part : parts) total += part.rim.size();
  vertex.reserve(total);
  for (const SpillTree& part : parts) vertex.insert(vertex.end(), part.rim.begin(), part.rim.end());
  radix_sort(vertex, [](std::uint64_t id) { return id; });
  vertex.erase(std::unique(vertex.begin(), vertex.end()), vertex.end());
  return vertex;
}

// The edges of all trees with ends numbered as `vertex`, ascending by height.
std::vector<SpillEdge> sorted_edges(std::span<const SpillTree> parts, const std::vector<std::uint64_t>& vertex) {
  std::vector<SpillEdge> edges;
  std::size_t total = 0;
  for (const SpillTree& part : parts) total += part.edge.size();
  edges.reserve(total);
  std::vector<std::uint32_t> number;
  for (const SpillTree& part : parts) {
    number.clear();
    auto from = vertex.begin();
    for (const std::uint64_t id : part.rim) {
      from = std::lower_bound(from, vertex.end(), id);
      number.push_back(static_cast<std::uint32_t>(from - vertex.begin()));
    }
    for (const SpillEdge& e : part.edge)
      edges.push_back({number[e.a], e.b == kOutlet ? kOutlet : number[e.b], e.height});
  }
  radix_sort(edges, [](const SpillEdge& e) { return biased(e.height); });
  return edges;
}

}  // namespace

RimLevels drain(std::span<const SpillTree> parts) {
  RimLevels result;
  result.vertex = distinct_rim(parts);
  assert(result.vertex.size() < kOutlet && "rim vertices are numbered with 32 bits");
  const std::vector<SpillEdge> edges = sorted_edges(parts, result.vertex);

  // Ascending heights: a set of rim vertices gets its level, all at once and for ever, when it first meets an outlet or
  // a set that has a level already. Sets with a level are not united any more, so the level at the root is that of all
  // members.
  UnionFind set(result.vertex.size());
  result.level.assign(result.vertex.size(), kNoLevel);
  for (const SpillEdge& e : edges) {
    const std::uint32_t a = set.find(e.a);
    const std::uint32_t b = e.b == kOutlet ? kOutlet : set.find(e.b);
    const bool a_drains = result.level[a] != kNoLevel;
    const bool b_drains = b == kOutlet || result.level[b] != kNoLevel;
    if (a_drains && b_drains) continue;
    if (a_drains) {
      result.level[b] = e.height;
    } else if (b_drains) {
      result.level[a] = e.height;
    } else {
      set.unite(a, b);
    }
  }
  for (std::uint32_t v = 0; v < result.level.size(); ++v) result.level[v] = result.level[set.find(v)];
  return result;
}

}  // namespace hydrotin
