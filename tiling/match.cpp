#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "hydrotin/river_lakes.h"
#include "hydrotin/river_matching.h"
#include "hydrotin/river_mouths.h"
#include "hydrotin/wingtip_clearing.h"
#include "phases.h"
#include "river_input.h"
#include "river_window.h"

namespace hydrotin {
namespace {

using Corners = std::array<std::uint32_t, 3>;

Corners canonical(Corners t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

std::vector<Corners> sorted_triangles(std::span<const std::uint32_t> triangle) {
  std::vector<Corners> out;
  for (std::size_t t = 0; t < triangle.size(); t += 3)
    out.push_back(canonical({triangle[t], triangle[t + 1], triangle[t + 2]}));
  std::sort(out.begin(), out.end());
  return out;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

// Ascending, the smaller vertex first.
std::vector<Edge> edges_of(std::span<const std::uint32_t> triangle) {
  std::vector<Edge> out;
  for (std::size_t t = 0; t < triangle.size(); t += 3)
    for (std::size_t i = 0; i < 3; ++i) out.emplace_back(std::minmax(triangle[t + i], triangle[t + (i + 1) % 3]));
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

// The network on one window. Vertices of the window keep their numbers, new ones follow.
class WindowMatch {
 public:
  WindowMatch(const RunContext& context, const RiverWindow& window, const RiverLines& lines)
      : context_(context), input_(*context.river_input), window_(window), lines_(lines) {}

  /// Vertices around which the window must grow; if there is none, the rest is there.
  std::vector<std::uint32_t> run() {
    match();
    if (!need(rivers())) return incomplete_;
    find_preserved();
    find_lakes();
    find_chains();
    if (!incomplete_.empty()) return incomplete_;
    clear_tips();
    compare();
    return incomplete_;
  }

  RiverNetwork take(std::vector<LatticeBox> bounds) {
    out_.bounds = std::move(bounds);
    list_vertices();
    list_patch();
    list_network();
    find_groups();
    return std::move(out_);
  }

 private:
  [[nodiscard]] const std::vector<RiverEdge>& rivers() const { return match_.rivers; }
  [[nodiscard]] LatticeTerrain& terrain() { return match_.terrain; }
  void count(const std::string& name, std::uint64_t number) { match_.counts.emplace_back(name, number); }

  // Old vertices without all their triangles join the list.
  void need_vertex(std::uint32_t v) {
    if (v < window_.num_vertices() && window_.is_complete[v] == 0) incomplete_.push_back(v);
  }
  bool need(const std::vector<RiverEdge>& edges) {
    for (const auto& [from, to] : edges) {
      need_vertex(from);
      need_vertex(to);
    }
    return incomplete_.empty();
  }

  void round_heights(std::size_t first) {
    for (std::size_t v = first; v < terrain().height.size(); ++v)
      terrain().height[v] = std::round(std::clamp(terrain().height[v], -2147483647.0, 2147483646.0));
  }

  void match() {
    LatticeTerrain given;
    given.position = window_.position;
    given.height.assign(window_.height.begin(), window_.height.end());
    given.triangle = window_.triangle;
    link_twins(given);
    const RiverOptions& options = context_.options.rivers;
    const Lattice& lattice = context_.plan.lattice;
    std::vector<std::pair<LatticePoint, double>> z;
    if (options.use_z) {
      z = heights_of_lines(input_, lattice, reach_of(context_.outline.bounds()));
      for (auto& [p, h] : z) h = height_of(h);
    }
    match_ = match_lines(given, lines_, input_.lines.size(), options.matching, input_.is_against, z);
    round_heights(window_.num_vertices());
    if (rivers().empty())
      throw Error(ErrorKind::input, input_.lines_path +
                                        ": no line runs along or across an edge of the terrain; check that it is of "
                                        "the same place (its CRS: rivers.crs where the file names none)");
    StepCounts counts{{"features", input_.lines.num_features},
                      {"without_geometry", input_.lines.num_null},
                      {"of_other_kinds", input_.lines.num_other},
                      {"lines", input_.lines.size()}};
    counts.insert(counts.end(), match_.counts.begin(), match_.counts.end());
    match_.counts = std::move(counts);
  }

  // In z lattice units.
  [[nodiscard]] double height_of(double z) const {
    const Lattice& l = context_.plan.lattice;
    return std::round((z - l.offset_z) / l.scale_z) - static_cast<double>(l.base_z);
  }

  void refresh_plane() {
    plane_.clear();
    for (const LatticePoint p : terrain().position)
      plane_.push_back({p.x * context_.plan.lattice.scale_xy, p.y * context_.plan.lattice.scale_xy});
  }
  [[nodiscard]] RiverTerrain plane_terrain() { return {plane_, terrain().height, terrain().triangle}; }
  [[nodiscard]] std::uint32_t num_vertices() const { return match_.terrain.num_vertices(); }

  // The edges of the terrain as measured that the lines of the file run along.
  void find_preserved() {
    if (input_.preserved.size() == 0) return;
    const std::vector<Edge> edges = edges_of(window_.triangle);
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    for (const PreservedSegment& s : preserved_segments(input_, context_.plan.lattice, context_.outline.bounds())) {
      const std::uint32_t a = window_.find(s.a), b = window_.find(s.b);
      if (a != kNone && b != kNone && std::binary_search(edges.begin(), edges.end(), Edge(std::minmax(a, b)))) {
        preserved_.emplace_back(std::minmax(a, b));
        continue;
      }
      const Lattice& l = context_.plan.lattice;
      const auto text = [&](LatticePoint p) {
        return "x " + std::to_string(l.x(p.x)) + ", y " + std::to_string(l.y(p.y));
      };
      throw Error(ErrorKind::input, input_.preserved_path + ": feature " +
                                        std::to_string(input_.preserved.feature[s.line]) + ": from " + text(s.a) +
                                        " to " + text(s.b) +
                                        " runs no edge of the terrain; draw lines along edges, from vertex to vertex");
    }
    std::sort(preserved_.begin(), preserved_.end());
    preserved_.erase(std::unique(preserved_.begin(), preserved_.end()), preserved_.end());
  }

  // An edge that an inserted line or a Steiner point cut has no type any more.
  void drop_cut_edges() {
    if (preserved_.empty()) return;
    const std::vector<Edge> edges = edges_of(terrain().triangle);
    const std::size_t cut = std::erase_if(
        preserved_, [&](const Edge& edge) { return !std::binary_search(edges.begin(), edges.end(), edge); });
    count("preserved_edges", preserved_.size());
    count("preserved_edges_cut", cut);
  }

  void find_lakes() {
    refresh_plane();
    if (input_.lakes.size() > 0) {
      const Lattice& l = context_.plan.lattice;
      std::vector<std::array<double, 2>> place;
      for (const LatticePoint p : terrain().position) place.push_back({l.x(p.x), l.y(p.y)});
      CoveredVertices covered = vertices_in(input_.polygons(), place);
      if (covered.overlaps)
        throw Error(ErrorKind::input, input_.lakes_path + ": features " +
                                          std::to_string(input_.lakes.feature[covered.first]) + " and " +
                                          std::to_string(input_.lakes.feature[covered.second]) +
                                          " cover the same vertex; lakes must not overlap");
      for (std::size_t i = 0; i < input_.lakes.size(); ++i) {
        Lake lake{std::move(covered.vertex[i]), input_.has_level[i] != 0, 0};
        if (lake.has_level) lake.level = height_of(input_.level[i]);
        for (const std::uint32_t v : lake.vertex) need_vertex(v);
        if (!lake.vertex.empty()) lakes_.push_back(std::move(lake));
      }
      ClosedLakes closed = close_lakes(plane_terrain(), rivers(), lakes_);
      lakes_ = std::move(closed.lake);
      count("lakes", lakes_.size());
      count("lakes_joined", closed.joined_lakes);
      count("vertices_joined_to_lakes", closed.joined_vertices);
    }
  }

  void find_chains() {
    const std::uint32_t old = window_.num_vertices();
    std::vector<std::uint8_t> is_outlet = window_.is_outlet, is_complete = window_.is_complete;
    is_outlet.resize(num_vertices(), 0);
    is_complete.resize(num_vertices(), 1);
    if (context_.options.pits.outlets == OutletPolicy::hull)
      for (std::uint32_t h = 0; h < terrain().triangle.size(); ++h)
        for (const std::uint32_t v : {terrain().origin(h), terrain().target(h)})
          if (terrain().twin[h] == kNoHalfedge && v >= old) is_outlet[v] = 1;
    const std::vector<std::uint8_t> by_policy = is_outlet;
    add_closed_lakes(rivers(), lake_numbers(num_vertices(), lakes_), is_outlet);
    mouths_ =
        find_outlet_chains(plane_terrain(), rivers(), is_outlet, lake_numbers(num_vertices(), lakes_), is_complete);
    for (const std::uint32_t v : mouths_.incomplete) need_vertex(v);
    if (!need(mouths_.edge) || !mouths_.incomplete.empty()) return;
    for (const RiverMouth& mouth : mouths_.mouth)
      if (mouth.kind == MouthKind::closed) is_outlet[mouth.vertex] = 1;
    for (std::uint32_t v = 0; v < num_vertices(); ++v)
      if (is_outlet[v] != 0 && by_policy[v] == 0) outlet_.push_back(v);
    if (context_.options.pits.voids_drain) keep_outlets_in_use(by_policy);
    count_mouths(mouths_, match_.counts);
  }

  // A Steiner point may cut the long edge that makes an outlet of a vertex: where water is led to one, it stays one.
  void keep_outlets_in_use(const std::vector<std::uint8_t>& by_policy) {
    for (const RiverMouth& mouth : mouths_.mouth)
      if (mouth.kind == MouthKind::outlet && by_policy[mouth.vertex] != 0) outlet_.push_back(mouth.vertex);
    for (const RiverEdge& edge : mouths_.edge)
      if (by_policy[edge.to] != 0) outlet_.push_back(edge.to);
    std::sort(outlet_.begin(), outlet_.end());
    outlet_.erase(std::unique(outlet_.begin(), outlet_.end()), outlet_.end());
  }

  void clear_tips() {
    const std::uint32_t first = num_vertices();
    const ClearedWingtips cleared =
        clear_wingtips(terrain(), rivers(), mouths_.edge, lake_numbers(num_vertices(), lakes_));
    round_heights(first);
    count("steiner_points", cleared.num_points);
    count("triangles_too_small", cleared.num_left);
    drop_cut_edges();
  }

  // Which triangles come and go. All their corners must be known completely: then they do not depend on the window.
  void compare() {
    const std::vector<Corners> before = sorted_triangles(window_.triangle),
                               after = sorted_triangles(terrain().triangle);
    std::set_difference(before.begin(), before.end(), after.begin(), after.end(), std::back_inserter(gone_));
    std::set_difference(after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(come_));
    for (const auto* list : {&gone_, &come_})
      for (const Corners& t : *list)
        for (const std::uint32_t v : t) need_vertex(v);
  }

  // New vertices are the points of a tile of their own, in (x, y) order.
  void list_vertices() {
    const std::uint32_t old = window_.num_vertices();
    std::vector<std::uint32_t> used;
    for (const auto* list : {&gone_, &come_})
      for (const Corners& t : *list) used.insert(used.end(), t.begin(), t.end());
    for (const auto* edges : {&match_.rivers, &mouths_.edge})
      for (const auto& [from, to] : *edges) used.insert(used.end(), {from, to});
    for (const Lake& lake : lakes_) used.insert(used.end(), lake.vertex.begin(), lake.vertex.end());
    for (const RiverMouth& mouth : mouths_.mouth) used.push_back(mouth.vertex);
    used.insert(used.end(), outlet_.begin(), outlet_.end());
    for (const auto& [a, b] : preserved_) used.insert(used.end(), {a, b});
    for (std::uint32_t v = old; v < num_vertices(); ++v) used.push_back(v);
    const auto key = [&](std::uint32_t v) {
      return std::tuple(v >= old, v < old ? window_.point[v] : 0, terrain().position[v]);
    };
    std::sort(used.begin(), used.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    used.erase(std::unique(used.begin(), used.end()), used.end());
    number_.assign(num_vertices(), std::numeric_limits<std::uint32_t>::max());
    for (const std::uint32_t v : used) {
      number_[v] = out_.num_vertices();
      out_.point.push_back(v < old ? window_.point[v] : PointId(context_.plan.num_tiles(), out_.num_new++).value);
      out_.position.push_back(terrain().position[v]);
      out_.height.push_back(static_cast<std::int32_t>(terrain().height[v]));
    }
  }

  // Any part would do: that of the tile in which the triangle's smallest old vertex lies has points in any case.
  [[nodiscard]] std::uint32_t tile_for(const Corners& t) const {
    std::uint32_t best = window_.num_vertices();
    for (const std::uint32_t v : t)
      if (v < best) best = v;
    if (best < window_.num_vertices()) return PointId(window_.point[best]).tile();
    const std::uint32_t tile = context_.plan.tile_of(match_.terrain.position[t[0]]);
    return context_.outline.count[tile] > 0 ? tile : window_.tile.front();
  }

  [[nodiscard]] Corners listed(const Corners& t) const {
    return canonical({number_[t[0]], number_[t[1]], number_[t[2]]});
  }

  void list_patch() {
    const auto is_gone = [&](const Corners& t) { return std::binary_search(gone_.begin(), gone_.end(), t); };
    for (std::uint32_t t = 0; t < window_.tile.size(); ++t) {
      const Corners v{window_.triangle[3 * t], window_.triangle[3 * t + 1], window_.triangle[3 * t + 2]};
      if (!is_gone(canonical(v))) continue;
      out_.gone.push_back({window_.tile[t], listed(v)});
      for (std::size_t i = 0; i < 3; ++i)
        if (window_.is_hull_edge[3 * t + i] != 0)
          out_.hull_gone.push_back({window_.tile[t], {number_[v[i]], number_[v[(i + 1) % 3]]}});
    }
    const LatticeTerrain& after = terrain();
    for (std::uint32_t h = 0; h < after.triangle.size(); h += 3) {
      const Corners v{after.triangle[h], after.triangle[h + 1], after.triangle[h + 2]};
      const Corners key = canonical(v);
      if (!std::binary_search(come_.begin(), come_.end(), key)) continue;
      const std::uint32_t tile = tile_for(key);
      out_.come.push_back({tile, listed(v)});
      for (std::uint32_t i = 0; i < 3; ++i)
        if (after.twin[h + i] == kNoHalfedge)
          out_.hull_come.push_back({tile, {number_[v[i]], number_[v[(i + 1) % 3]]}});
    }
    std::sort(out_.gone.begin(), out_.gone.end());
    std::sort(out_.come.begin(), out_.come.end());
    std::sort(out_.hull_gone.begin(), out_.hull_gone.end());
    std::sort(out_.hull_come.begin(), out_.hull_come.end());
  }

  void list_network() {
    for (const auto& [from, to] : rivers()) out_.river.push_back({number_[from], number_[to]});
    out_.line = match_.line;
    for (const auto& [from, to] : mouths_.edge) out_.chain.push_back({number_[from], number_[to]});
    for (Lake& lake : lakes_) {
      for (std::uint32_t& v : lake.vertex) v = number_[v];
      out_.lake.push_back(std::move(lake));
    }
    for (const RiverMouth& mouth : mouths_.mouth) {
      out_.mouth.push_back(number_[mouth.vertex]);
      out_.mouth_kind.push_back(static_cast<std::uint8_t>(mouth.kind));
      out_.mouth_length.push_back(mouth.length);
      out_.mouth_climb.push_back(mouth.climb);
    }
    for (const std::uint32_t v : outlet_) out_.outlet.push_back(number_[v]);
    for (const auto& [a, b] : preserved_) out_.preserved.push_back({number_[a], number_[b]});
    out_.counts = std::move(match_.counts);
    out_.is_turned = std::move(match_.is_turned);
    out_.drop = std::move(match_.drop);
    out_.disagrees = std::move(match_.disagrees);
    out_.cycle_begin.push_back(0);
    for (const auto& cycle : match_.cycles) {
      out_.cycle.insert(out_.cycle.end(), cycle.begin(), cycle.end());
      out_.cycle_begin.push_back(static_cast<std::uint32_t>(out_.cycle.size()));
    }
  }

  // Networks with a triangle's corner in common would be solved together anyway (see river_groups.h).
  template <class Join>
  void join_near(Join join) {
    std::vector<std::uint8_t> is_way(out_.num_vertices(), 0);
    for (const auto* edges : {&out_.river, &out_.chain})
      for (const auto& [from, to] : *edges) is_way[from] = is_way[to] = 1;
    for (const Lake& lake : out_.lake)
      for (const std::uint32_t v : lake.vertex) is_way[v] = 1;
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    const LatticeTerrain& after = terrain();
    std::vector<std::uint32_t> first(after.num_vertices(), kNone);  // a way vertex next to each vertex
    for (std::size_t t = 0; t < after.triangle.size(); t += 3)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t w = number_[after.triangle[t + i]];
        if (w == kNone || is_way[w] == 0) continue;
        for (std::size_t k = 0; k < 3; ++k) {
          std::uint32_t& other = first[after.triangle[t + k]];
          if (other == kNone)
            other = w;
          else
            join(other, w);
        }
      }
  }

  // What rivers, chains and lakes hold together, numbered by the smallest vertex.
  void find_groups() {
    std::vector<std::uint32_t> parent(out_.num_vertices());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto find = [&](std::uint32_t v) {
      while (parent[v] != v) v = parent[v] = parent[parent[v]];
      return v;
    };
    const auto join = [&](std::uint32_t a, std::uint32_t b) {
      a = find(a);
      b = find(b);
      const bool a_first = out_.position[a] < out_.position[b];
      parent[a_first ? b : a] = a_first ? a : b;  // the smallest vertex stays on top
    };
    for (const auto* edges : {&out_.river, &out_.chain})
      for (const auto& [from, to] : *edges) join(from, to);
    for (const Lake& lake : out_.lake)
      for (const std::uint32_t v : lake.vertex) join(lake.vertex[0], v);
    join_near(join);
    std::map<LatticePoint, std::uint32_t> group;
    const auto top = [&](std::uint32_t v) { return out_.position[find(v)]; };
    for (const auto& edge : out_.river) group.emplace(top(edge.from), 0);
    for (const auto& edge : out_.chain) group.emplace(top(edge.from), 0);
    for (const Lake& lake : out_.lake) group.emplace(top(lake.vertex[0]), 0);
    for (auto& [place, number] : group) {
      number = out_.num_groups();
      out_.group_tile.push_back(context_.plan.tile_of(place));
    }
    for (const auto& edge : out_.river) out_.river_group.push_back(group.at(top(edge.from)));
    for (const auto& edge : out_.chain) out_.chain_group.push_back(group.at(top(edge.from)));
    for (const Lake& lake : out_.lake) out_.lake_group.push_back(group.at(top(lake.vertex[0])));
  }

  const RunContext& context_;
  const RiverInput& input_;
  const RiverWindow& window_;
  const RiverLines& lines_;
  std::vector<std::uint32_t> incomplete_;
  MatchedLines match_;
  std::vector<std::array<double, 2>> plane_;
  std::vector<Lake> lakes_;
  OutletChains mouths_;
  std::vector<Edge> preserved_;
  std::vector<std::uint32_t> outlet_;  // besides those of the policy
  std::vector<Corners> gone_, come_;
  std::vector<std::uint32_t> number_;
  RiverNetwork out_;
};

}  // namespace

void match_rivers(const RunContext& context) {
  const RiverLines lines =
      lines_on_lattice(*context.river_input, context.plan.lattice, reach_of(context.outline.bounds()));
  std::vector<LatticeBox> bounds = bounds_of_laid(context);
  const WindowReader reader(context, bounds, nullptr);
  CellSet cells(context.outline);
  add_river_cells(context, lines, context.outline.bounds(), cells);
  for (std::int32_t rings = 1;; rings *= 2) {
    const RiverWindow window = reader.read(cells.grid(), cells.cells());
    WindowMatch match(context, window, lines);
    const std::vector<std::uint32_t> incomplete = match.run();
    if (incomplete.empty()) {
      store::Writer out(context.layout.unit(Phase::match, 0));
      out.set("recipe", context.recipe(Phase::match));
      write_network(out, match.take(std::move(bounds)));
      out.commit();
      return;
    }
    cells.grow(window.position, incomplete, rings);
  }
}

}  // namespace hydrotin
