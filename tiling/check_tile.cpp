#include "check_tile.h"

#include <algorithm>
#include <numeric>

#include "hydrotin/predicates.h"
#include "hydrotin/vertex_graph.h"
#include "hydrotin/wide.h"
#include "river_edges.h"
#include "terrain_file.h"

namespace hydrotin {
namespace {

Area twice_area(LatticePoint a, LatticePoint b, LatticePoint c) {
  const Wide bx = std::int64_t{b.x} - a.x, by = std::int64_t{b.y} - a.y;
  const Wide cx = std::int64_t{c.x} - a.x, cy = std::int64_t{c.y} - a.y;
  const Wide area = bx * cy - by * cx;
  return area > 0 ? static_cast<Area>(area) : 0;
}

class TileCheck {
 public:
  TileCheck(const DatasetIndex& index, const TerrainTile& tile, TileFacts& facts)
      : index_(index), tile_(tile), facts_(facts) {}

  void run() {
    check_boxes();
    check_triangles();
    check_vertices();
    find_open_edges();
    read_hull();
    summarize();
    collect_foreign();
    check_rivers();
  }

 private:
  void problem(const std::string& kind, const std::string& text) {
    facts_.problems.add(kind, tile_.path + ": " + text);
  }
  [[nodiscard]] std::string at(std::uint32_t v) const { return index_.place(tile_.position[v]); }

  void check_boxes() {
    std::vector<LatticeBox> block(tile_.block_box.size()), run(tile_.triangle_box.size());
    LatticeBox all;
    for (std::uint32_t i = 0; i < tile_.num_own; ++i) block[i / kBlockPoints].extend(tile_.position[i]);
    for (const LatticeBox& b : block) all.extend(b);
    for (std::size_t i = 0; i < tile_.triangle.size(); ++i)
      run[i / (std::size_t{3} * kRunTriangles)].extend(tile_.position[tile_.triangle[i]]);
    if (block != tile_.block_box) problem("boxes", "a block box is not the box of its points");
    if (run != tile_.triangle_box) problem("boxes", "a triangle box is not the box of its triangles");
    if (!(all == index_.box[tile_.tile])) problem("boxes", "the index gives another box of its points");
  }

  void check_triangles() {
    facts_.bins.assign(kSampleBins, 0);
    const auto corner = [&](std::uint32_t v) {
      return Fingerprint::Corner{tile_.position[v].x, tile_.position[v].y, tile_.height[v]};
    };
    for (std::size_t i = 0; i < tile_.triangle.size(); i += 3) {
      const std::uint32_t a = tile_.triangle[i], b = tile_.triangle[i + 1], c = tile_.triangle[i + 2];
      const LatticePoint pa = tile_.position[a], pb = tile_.position[b], pc = tile_.position[c];
      if (orientation(pa, pb, pc) <= 0)
        problem("orientation", "triangle " + std::to_string(i / 3) + " at " + at(a) + " is not counter-clockwise");
      facts_.twice_area += twice_area(pa, pb, pc);
      facts_.fingerprint.add({corner(a), corner(b), corner(c)});
      if (!std::binary_search(tile_.added_triangle.begin(), tile_.added_triangle.end(), i / 3))
        ++facts_.bins[sample_key(pa, pb, pc) >> 48];
    }
    if (facts_.fingerprint.hex() != tile_.fingerprint)
      problem("fingerprint", "its triangles do not have the fingerprint " + tile_.fingerprint + " that it states");
  }

  // A vertex of a triangle has a final height, nothing else has.
  void check_vertices() {
    is_used_.assign(tile_.num_vertices(), 0);
    for (const std::uint32_t v : tile_.triangle) is_used_[v] = 1;
    for (std::uint32_t v = 0; v < tile_.num_vertices(); ++v) {
      const bool has_height = tile_.height[v] != kUnusedHeight;
      if (has_height != (is_used_[v] != 0))
        problem("use of vertices", "the vertex at " + at(v) +
                                       (has_height ? " has a height but no triangle" : " is used but has no height"));
      if (has_height && tile_.pit_method == "lift" && tile_.height[v] < tile_.embedded[v])
        problem("heights", "the vertex at " + at(v) + " ends lower than it was measured");
    }
  }

  // Half-edges by origin, targets ascending.
  void find_open_edges() {
    std::vector<std::uint32_t> begin(std::size_t{tile_.num_vertices()} + 1, 0), target(tile_.triangle.size());
    for (const std::uint32_t v : tile_.triangle) ++begin[v + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<std::uint32_t> fill(begin.begin(), begin.end() - 1);
    for (std::size_t h = 0; h < tile_.triangle.size(); ++h)
      target[fill[tile_.triangle[h]]++] = tile_.triangle[h % 3 == 2 ? h - 2 : h + 1];
    const auto list = [&](std::uint32_t v) {
      return std::pair{target.begin() + begin[v], target.begin() + begin[v + 1]};
    };
    for (std::uint32_t v = 0; v < tile_.num_vertices(); ++v) std::sort(list(v).first, list(v).second);
    for (std::uint32_t v = 0; v < tile_.num_vertices(); ++v) {
      const auto [first, last] = list(v);
      for (auto w = first; w != last; ++w) {
        if (w != first && *w == *(w - 1))
          problem("topology", "two triangles lie on one side of the edge from " + at(v) + " to " + at(*w));
        const auto [back_first, back_last] = list(*w);
        if (!std::binary_search(back_first, back_last, v)) open_.push_back({v, *w});
      }
    }
    for (const DirectedEdge& e : open_)
      facts_.open.push_back(
          {tile_.id(e.origin), tile_.id(e.target), tile_.position[e.origin], tile_.position[e.target]});
  }

  void read_hull() {
    is_hull_.assign(tile_.num_vertices(), 0);
    std::vector<std::pair<std::uint64_t, std::uint64_t>> stated;
    for (std::size_t i = 0; i < tile_.hull_edge.size(); i += 2)
      stated.emplace_back(tile_.hull_edge[i], tile_.hull_edge[i + 1]);
    std::sort(stated.begin(), stated.end());
    if (std::adjacent_find(stated.begin(), stated.end()) != stated.end())
      problem("hull", "a hull edge is listed twice");
    is_rim_.assign(tile_.num_vertices(), 0);
    for (std::size_t i = 0; i < open_.size(); ++i) {
      const auto [v, w] = open_[i];
      const bool on_hull =
          std::binary_search(stated.begin(), stated.end(), std::pair{facts_.open[i].origin, facts_.open[i].target});
      if (on_hull) facts_.hull.push_back(facts_.open[i]);
      (on_hull ? is_hull_ : is_rim_)[v] = 1;
      (on_hull ? is_hull_ : is_rim_)[w] = 1;
    }
    if (facts_.hull.size() < stated.size())
      problem("hull", "a hull edge that it lists is no boundary edge of its triangles");
  }

  void summarize() {
    const bool by_lowest = tile_.outlets == "lowest", by_layer = tile_.outlets == "layer";
    if (tile_.outlets != "hull" && !by_lowest && !by_layer)
      problem("outlets", "the outlets '" + tile_.outlets + "' are not known");
    if (tile_.pits_removed != (index_.outlets != "none") || (tile_.pits_removed && tile_.outlets != index_.outlets))
      problem("outlets", "the index states other outlets");
    std::vector<std::uint8_t> is_outlet =
        by_lowest || by_layer ? std::vector<std::uint8_t>(tile_.num_vertices(), 0) : is_hull_;
    std::vector<std::uint64_t> id(tile_.num_vertices());
    for (std::uint32_t v = 0; v < id.size(); ++v) {
      id[v] = tile_.id(v);
      if (!is_used_[v] || (by_lowest && id[v] == index_.lowest.value)) is_outlet[v] = 1;  // unused ones are no pits
    }
    for (const std::uint32_t v : tile_.outlet_vertex) is_outlet[v] = 1;
    for (std::uint32_t v = 0; v < id.size(); ++v)
      if (is_used_[v] && is_outlet[v] && tile_.height[v] != tile_.embedded[v])
        problem("outlets", "the outlet at " + at(v) + " was moved");
    const VertexGraph graph = make_vertex_graph(tile_.num_vertices(), tile_.triangle);
    const std::vector<std::uint8_t> base = is_outlet;
    check_kept(graph, is_outlet);
    facts_.plateaus = summarize_plateaus(graph, tile_.height, tile_.position, is_outlet, id, is_rim_);
    if (index_.pits_kept == 0 && tile_.kept_vertex.empty()) return;
    facts_.before = summarize_plateaus(graph, tile_.embedded, tile_.position, base, id, is_rim_);
    facts_.unkept = summarize_plateaus(graph, tile_.embedded, tile_.position, is_outlet, id, is_rim_);
  }

  // Kept pits are whole pits of the terrain as measured, and stayed where they were.
  void check_kept(const VertexGraph& graph, std::vector<std::uint8_t>& is_outlet) {
    std::vector<std::uint8_t> is_kept(tile_.num_vertices(), 0);
    for (const std::uint32_t v : tile_.kept_vertex) is_kept[v] = 1;
    for (const std::uint32_t v : tile_.kept_vertex) {
      if (!is_used_[v] || tile_.height[v] != tile_.embedded[v])
        problem("kept pits", "the vertex of a kept pit at " + at(v) + " was moved");
      for (const std::uint32_t w : graph.neighbors(v))
        if (tile_.embedded[w] < tile_.embedded[v] || (tile_.embedded[w] == tile_.embedded[v] && !is_kept[w]))
          problem("kept pits", "the vertex at " + at(v) + " is said to be of a kept pit, but water leaves it");
      is_outlet[v] = 1;
    }
  }

  void check_rivers() {
    std::vector<RiverEdge> river;
    for (std::size_t i = 0; i < tile_.river_edge.size(); i += 2)
      river.push_back({tile_.river_edge[i], tile_.river_edge[i + 1]});
    std::vector<std::pair<std::uint32_t, std::uint32_t>> side;
    for (std::size_t h = 0; h < tile_.triangle.size() && !river.empty(); ++h)
      side.push_back(std::minmax(tile_.triangle[h], tile_.triangle[h % 3 == 2 ? h - 2 : h + 1]));
    std::sort(side.begin(), side.end());
    for (const auto& [from, to] : river)
      if (!std::binary_search(side.begin(), side.end(),
                              std::pair<std::uint32_t, std::uint32_t>(std::minmax(from, to)))) {
        problem("rivers", "the river edge from " + at(from) + " to " + at(to) + " is no edge of a triangle");
        return;
      }
    const auto invalid = invalid_river_edges(tile_.position, tile_.height, tile_.triangle, river, index_.river_flow,
                                             index_.river_valley);
    for (const auto& [list, out] :
         {std::pair<const std::vector<RiverEdge>*, decltype(&facts_.river)>{&river, &facts_.river},
          {&invalid, &facts_.invalid_river}}) {
      for (const auto& [from, to] : *list) out->emplace_back(tile_.id(from), tile_.id(to));
      std::sort(out->begin(), out->end());
    }
  }

  void collect_foreign() {
    for (std::uint32_t v = tile_.num_own; v < tile_.num_vertices(); ++v)
      facts_.foreign.push_back({tile_.id(v), tile_.position[v], tile_.measured[v], tile_.height[v], tile_.tile});
  }

  const DatasetIndex& index_;
  const TerrainTile& tile_;
  TileFacts& facts_;
  std::vector<std::uint8_t> is_used_, is_hull_, is_rim_;
  std::vector<DirectedEdge> open_;
};

bool has_degenerate_triangle(const TerrainTile& tile) {
  for (std::size_t i = 0; i < tile.triangle.size(); i += 3)
    if (tile.triangle[i] == tile.triangle[i + 1] || tile.triangle[i + 1] == tile.triangle[i + 2] ||
        tile.triangle[i] == tile.triangle[i + 2])
      return true;
  return false;
}

}  // namespace

std::uint64_t sample_key(LatticePoint a, LatticePoint b, LatticePoint c) {
  Fingerprint key;
  key.add({Fingerprint::Corner{a.x, a.y, 0}, Fingerprint::Corner{b.x, b.y, 0}, Fingerprint::Corner{c.x, c.y, 0}});
  return key.high;
}

TileFacts check_tile(const DatasetIndex& index, std::uint32_t tile) {
  TileFacts facts;
  try {
    const TerrainTile file = load_terrain_tile(index, tile);
    if (has_degenerate_triangle(file))
      throw Error(ErrorKind::storage, file.path + ": a triangle names a vertex twice; delete the file and run again");
    TileCheck(index, file, facts).run();
    facts.is_readable = true;
  } catch (const Error& error) {
    facts = {};
    facts.problems.add("unreadable", error.what());
  }
  return facts;
}

}  // namespace hydrotin
