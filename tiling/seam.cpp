#include <algorithm>
#include <map>
#include <unordered_map>

#include "hydrotin/polygon.h"
#include "phases.h"
#include "pieces.h"

namespace hydrotin {
namespace {

// A polygon put together from its pieces.
class SeamPolygon {
 public:
  void clear() {
    number_.clear();
    vertex_.clear();
    position_.clear();
    height_.clear();
    wants_.clear();
    delaunay_.clear();
    fixed_.clear();
    met_.clear();
    others_.clear();
    others_order_.clear();
  }

  void add(const Piece& piece) {
    std::vector<std::uint32_t> local;
    for (std::size_t i = 0; i < piece.vertex.size(); ++i) {
      const auto [found, fresh] =
          number_.try_emplace(piece.vertex[i].point.value, static_cast<std::uint32_t>(vertex_.size()));
      if (fresh) {
        vertex_.push_back(piece.vertex[i]);
        position_.push_back(piece.vertex[i].position);
        height_.push_back(piece.vertex[i].height);
        wants_.push_back(0);
      }
      wants_[found->second] |= piece.wants_lower[i];
      local.push_back(found->second);
    }
    for (const auto& t : piece.delaunay) delaunay_.push_back({local[t[0]], local[t[1]], local[t[2]]});
    fixed_.insert(fixed_.end(), piece.fixed.begin(), piece.fixed.end());
    for (std::size_t i = 0; i < piece.others.size(); ++i) {
      const auto& t = piece.others[i];
      met_.push_back({from_smallest({local[t[0]], local[t[1]], local[t[2]]}), piece.others_order[i]});
    }
  }

  [[nodiscard]] PolygonProblem problem() {
    std::sort(met_.begin(), met_.end());
    met_.erase(std::unique(met_.begin(), met_.end()), met_.end());
    for (const auto& [triangle, order] : met_) {
      others_.push_back(triangle);
      others_order_.push_back(order);
    }
    return {position_, height_, wants_, delaunay_, fixed_, others_, others_order_, num_components()};
  }

  [[nodiscard]] const std::vector<PieceVertex>& vertices() const { return vertex_; }

 private:
  static std::array<std::uint32_t, 3> from_smallest(std::array<std::uint32_t, 3> t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  }

  [[nodiscard]] std::uint32_t num_components() const {
    std::size_t open_sides = 0;
    for (const std::uint8_t mask : fixed_) open_sides += 3U - ((mask & 1U) + (mask >> 1 & 1U) + (mask >> 2 & 1U));
    return static_cast<std::uint32_t>(open_sides / 2 + 1 - fixed_.size());
  }

  std::unordered_map<std::uint64_t, std::uint32_t> number_;
  std::vector<PieceVertex> vertex_;
  std::vector<LatticePoint> position_;
  std::vector<std::int32_t> height_;
  std::vector<std::uint8_t> wants_, fixed_, others_order_;
  std::vector<std::pair<std::array<std::uint32_t, 3>, std::uint8_t>> met_;  // others, as the pieces list them
  std::vector<std::array<std::uint32_t, 3>> delaunay_, others_;
};

// Pieces of the tiles that this tile's polygons reach into.
class PieceSource {
 public:
  explicit PieceSource(const RunContext& context) : context_(context) {}

  [[nodiscard]] Piece read(std::uint32_t tile, std::uint32_t piece) {
    auto found = pieces_.find(tile);
    if (found == pieces_.end()) {
      const store::Reader in(context_.layout.unit(Phase::triangulate, tile));
      found = pieces_.emplace(tile, PieceReader(in)).first;
    }
    return found->second.piece(piece);
  }

 private:
  const RunContext& context_;
  std::map<std::uint32_t, PieceReader> pieces_;
};

class SeamOutput {
 public:
  void add(const SeamPolygon& polygon, const std::vector<std::array<std::uint32_t, 3>>& answer) {
    for (const auto& t : answer)
      for (const std::uint32_t v : t) {
        const PieceVertex& vertex = polygon.vertices()[v];
        const auto [found, fresh] = number_.try_emplace(vertex.point.value, static_cast<std::uint32_t>(point_.size()));
        if (fresh) {
          point_.push_back(vertex.point.value);
          xyz_.insert(xyz_.end(), {vertex.position.x, vertex.position.y, vertex.height});
        }
        triangle_.push_back(found->second);
      }
  }

  void add_hull(const Piece& piece) {
    for (const auto& edge : piece.hull) hull_edge_.insert(hull_edge_.end(), {edge[0].value, edge[1].value});
  }

  void write(store::Writer& out) const {
    out.append("triangle", triangle_, "numbers of points below, three per triangle");
    out.append("point", point_, "tile << 32 | index");
    out.append("point_xyz", xyz_);
    out.append("hull_edge", hull_edge_, "directed edges of the hull, as pairs of points");
  }

 private:
  std::unordered_map<std::uint64_t, std::uint32_t> number_;
  std::vector<std::uint64_t> point_, hull_edge_;
  std::vector<std::int32_t> xyz_;
  std::vector<std::uint32_t> triangle_;
};

}  // namespace

void solve_seams(const RunContext& context, std::uint32_t tile) {
  const store::Reader join(context.layout.unit(Phase::join, 0));
  const auto range = join.read_range<std::uint64_t>("polygon_begin", tile, 2);
  const auto begin = join.read_range<std::uint64_t>("member_begin", range[0], range[1] - range[0] + 1);
  const auto member_tile = join.read_range<std::uint32_t>("member_tile", begin.front(), begin.back() - begin.front());
  const auto member_piece = join.read_range<std::uint32_t>("member_piece", begin.front(), begin.back() - begin.front());

  PieceSource pieces(context);
  PolygonSolver solver({.objectives = {context.options.triangulation.objective}});
  SeamPolygon polygon;
  SeamOutput output;
  std::vector<std::array<std::uint32_t, 3>> answer;
  std::int64_t components = 0, max_components = 0, max_polygon = 0, fallbacks = 0, max_order = 0;
  for (std::size_t f = 0; f + 1 < begin.size(); ++f) {
    polygon.clear();
    for (std::uint64_t m = begin[f] - begin.front(); m < begin[f + 1] - begin.front(); ++m) {
      const Piece piece = pieces.read(member_tile[m], member_piece[m]);
      polygon.add(piece);
      output.add_hull(piece);
    }
    const PolygonProblem problem = polygon.problem();
    answer.clear();
    const PolygonResult result = solver.solve(problem, answer);
    output.add(polygon, answer);
    components += problem.components;
    max_components = std::max<std::int64_t>(max_components, problem.components);
    max_polygon = std::max<std::int64_t>(max_polygon, static_cast<std::int64_t>(problem.delaunay.size()));
    max_order = std::max<std::int64_t>(max_order, result.max_order);
    fallbacks += result.fell_back;
  }

  store::Writer out(context.layout.unit(Phase::seam, tile));
  out.set("recipe", context.recipe(Phase::seam));
  output.write(out);
  out.set("polygons", static_cast<std::int64_t>(begin.size() - 1));
  out.set("components", components);
  out.set("max_components", max_components);
  out.set("max_polygon", max_polygon);
  out.set("fallbacks", fallbacks);
  out.set("max_order", max_order);
  out.commit();
}

}  // namespace hydrotin
