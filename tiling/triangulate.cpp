#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "certify.h"
#include "hydrotin/polygon_batch.h"
#include "phases.h"
#include "pieces.h"

namespace hydrotin {
namespace {

// Some mean spacings wide: what the certificate usually asks for at this order.
double initial_halo(const Outline& outline, std::uint32_t tile, int k) {
  const LatticeBox& box = outline.box[tile];
  if (box.is_empty()) return 0;
  const double area =
      (static_cast<double>(box.max.x) - box.min.x + 1) * (static_cast<double>(box.max.y) - box.min.y + 1);
  const double spacing = std::sqrt(area / static_cast<double>(outline.count[tile]));
  return std::ceil(spacing * (4 + 1.5 * k));
}

// The tile's polygons, with everything that solving them needs.
class TilePolygons {
 public:
  TilePolygons(const CertifiedTile& tile, std::span<const std::int32_t> height, int k, Objective objective)
      : tile_(tile),
        tri_(tile.triangulation.view()),
        crossings_(find_crossings(tri_, tile.edges)),
        subdivision_(subdivide(tri_, joined_inside())),
        triangles_(order_k_triangles(tri_, tile.links, tile.edges, k)) {
    find_borders();
    distribute();
    if (objective == Objective::local_minima)
      assignment_ = assign_minima(tri_, tile.links, tile.edges, crossings_, height);
    to_solve_ = polygons_to_solve(tri_, tile.links, height, crossings_, subdivision_, objective,
                                  objective == Objective::local_minima ? &assignment_ : nullptr);
    source_ =
        std::make_unique<PolygonSource>(PolygonSource{tri_, height, crossings_, subdivision_, triangles_, candidates_,
                                                      objective == Objective::local_minima ? &assignment_ : nullptr});
  }

  [[nodiscard]] const PolygonSource& source() const { return *source_; }
  [[nodiscard]] const Subdivision& subdivision() const { return subdivision_; }
  [[nodiscard]] const Crossings& crossings() const { return crossings_; }
  [[nodiscard]] const MinimaAssignment& assignment() const { return assignment_; }
  [[nodiscard]] bool is_owned(std::uint32_t f) const {
    return tile_.owned[subdivision_.triangles_of(f).front().value] != 0;
  }
  [[nodiscard]] bool crosses_border(std::uint32_t f) const { return border_[f] != 0; }
  // Whether more than the Delaunay triangles of an owned polygon have to be looked at.
  [[nodiscard]] bool is_to_solve(std::uint32_t f) const { return to_solve_[f] != 0; }
  [[nodiscard]] bool is_border(HalfedgeId h) const {
    return crossings_.crossed[h.value] && tile_.owned[triangle_of(h).value] &&
           !tile_.owned[triangle_of(tri_.twin[h]).value];
  }

 private:
  // Half-edges across which two owned triangles belong to one polygon.
  [[nodiscard]] std::vector<std::uint8_t> joined_inside() const {
    std::vector<std::uint8_t> joined = crossings_.crossed;
    for (HalfedgeId h{0}; h.value < joined.size(); ++h.value)
      if (joined[h.value])
        joined[h.value] = tile_.owned[triangle_of(h).value] && tile_.owned[triangle_of(tri_.twin[h]).value];
    return joined;
  }

  void find_borders() {
    border_.resize(subdivision_.size());
    for (HalfedgeId h{0}; h.value < crossings_.crossed.size(); ++h.value)
      if (is_border(h)) border_[subdivision_.polygon[triangle_of(h).value]] = 1;
  }

  // An order-k triangle belongs to the polygon that its edges enter. Pieces of one polygon may each be entered by
  // another edge, and every tile lists it where an edge enters an owned triangle: so some tile does.
  void distribute() {
    const UsefulEdgeIndex index(tri_, tile_.links, tile_.edges);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;  // polygon, triangle
    for (std::uint32_t c = 0; c < triangles_.size(); ++c) {
      const std::uint32_t met = subdivision_.polygon[triangle_of(triangles_.entry[c]).value];
      if (tile_.owned[triangle_of(triangles_.entry[c]).value] && !border_[met]) {
        entries.emplace_back(met, c);
        continue;
      }
      const auto& v = triangles_.vertices[c];
      const std::size_t first = entries.size();
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t e = index.find(v[i], v[(i + 1) % 3]);
        if (e == UsefulEdgeIndex::kNone) continue;
        const TriangleId entered = triangle_of(tile_.edges.entry[e]);
        if (!tile_.owned[entered.value]) continue;
        const std::pair entry{subdivision_.polygon[entered.value], c};
        if (std::find(entries.begin() + static_cast<std::ptrdiff_t>(first), entries.end(), entry) == entries.end())
          entries.push_back(entry);
      }
    }
    candidates_.begin.assign(subdivision_.size() + 1, 0);
    for (const auto& [f, c] : entries) ++candidates_.begin[f + 1];
    for (std::size_t f = 1; f < candidates_.begin.size(); ++f) candidates_.begin[f] += candidates_.begin[f - 1];
    candidates_.candidate.resize(entries.size());
    std::vector<std::uint32_t> at(candidates_.begin.begin(), candidates_.begin.end() - 1);
    for (const auto& [f, c] : entries) candidates_.candidate[at[f]++] = c;
  }

  const CertifiedTile& tile_;
  TriangulationView tri_;
  Crossings crossings_;
  Subdivision subdivision_;
  OrderKTriangles triangles_;
  std::vector<std::uint8_t> border_, to_solve_;
  PolygonCandidates candidates_;
  MinimaAssignment assignment_;
  std::unique_ptr<PolygonSource> source_;
};

struct Figures {
  std::int64_t polygons = 0, components = 0, max_components = 0, max_polygon = 0, fallbacks = 0, max_order = 0;
};

// Solves what lies inside, cuts out what crosses the border.
class TileOutput {
 public:
  TileOutput(const Neighborhood& around, const CertifiedTile& tile, const TilePolygons& polygons, Objective objective)
      : around_(around),
        tri_(tile.triangulation.view()),
        tile_(tile),
        polygons_(polygons),
        objective_(objective),
        foreign_number_(around.position().size() - around.num_own(), kUnused) {}

  void solve() {
    PolygonExtractor extractor(polygons_.source());
    PolygonSolver solver({.objectives = {objective_}});
    piece_of_.assign(polygons_.subdivision().size(), kUnused);
    for (std::uint32_t f = 0; f < polygons_.subdivision().size(); ++f) {
      if (!polygons_.is_owned(f)) continue;
      if (polygons_.crosses_border(f)) {
        const PolygonProblem& problem = extractor.extract(f);
        piece_of_[f] = pieces_.add(piece(problem, extractor.vertices()));
        continue;
      }
      if (polygons_.is_to_solve(f))
        solve(f, extractor, solver);
      else
        keep_delaunay(f);
      const Subdivision& subdivision = polygons_.subdivision();
      ++figures_.polygons;
      figures_.components += subdivision.components[f];
      figures_.max_components = std::max<std::int64_t>(figures_.max_components, subdivision.components[f]);
      figures_.max_polygon =
          std::max<std::int64_t>(figures_.max_polygon, static_cast<std::int64_t>(subdivision.triangles_of(f).size()));
    }
    list_edges();
  }

  void write(store::Writer& out) const {
    out.append("triangle", triangle_, "below n: own point; else n + foreign number; three per triangle");
    out.append("foreign_point", foreign_point_, "tile << 32 | index");
    out.append("foreign_xyz", foreign_xyz_);
    out.append("hull_edge", hull_edge_, "directed edges of the hull at these triangles, as pairs of points");
    pieces_.write(out);
    out.set("polygons", figures_.polygons);
    out.set("components", figures_.components);
    out.set("max_components", figures_.max_components);
    out.set("max_polygon", figures_.max_polygon);
    out.set("fallbacks", figures_.fallbacks);
    out.set("max_order", figures_.max_order);
    out.set("minima_bound", minima_bound());
    out.set("rounds", std::int64_t{tile_.rounds});
    out.set("fetched", static_cast<std::int64_t>(around_.num_fetched()));
    out.set("loaded", static_cast<std::int64_t>(around_.position().size()));
  }

 private:
  static constexpr std::uint32_t kUnused = static_cast<std::uint32_t>(-1);

  void solve(std::uint32_t f, PolygonExtractor& extractor, PolygonSolver& solver) {
    answer_.clear();
    const PolygonResult result = solver.solve(extractor.extract(f), answer_);
    for (const auto& t : answer_)
      for (const std::uint32_t v : t) triangle_.push_back(reference(extractor.vertices()[v]));
    figures_.max_order = std::max<std::int64_t>(figures_.max_order, result.max_order);
    figures_.fallbacks += result.fell_back;
  }

  void keep_delaunay(std::uint32_t f) {
    for (const TriangleId t : polygons_.subdivision().triangles_of(f)) {
      const HalfedgeId h = first_halfedge(t);
      for (const VertexId v : {tri_.origin[h], tri_.target(h), tri_.apex(h)}) triangle_.push_back(reference(v));
    }
  }

  std::uint32_t reference(VertexId v) {
    if (v.value < around_.num_own()) return v.value;
    std::uint32_t& number = foreign_number_[v.value - around_.num_own()];
    if (number == kUnused) {
      number = static_cast<std::uint32_t>(foreign_point_.size());
      foreign_point_.push_back(around_.point()[v.value].value);
      const LatticePoint p = around_.position()[v.value];
      foreign_xyz_.insert(foreign_xyz_.end(), {p.x, p.y, around_.height()[v.value]});
    }
    return around_.num_own() + number;
  }

  [[nodiscard]] Piece piece(const PolygonProblem& problem, std::span<const VertexId> vertices) const {
    Piece out;
    for (const VertexId v : vertices)
      out.vertex.push_back({around_.point()[v.value], around_.position()[v.value], around_.height()[v.value]});
    out.wants_lower.assign(problem.wants_lower.begin(), problem.wants_lower.end());
    out.delaunay.assign(problem.delaunay.begin(), problem.delaunay.end());
    out.fixed.assign(problem.fixed.begin(), problem.fixed.end());
    out.others.assign(problem.others.begin(), problem.others.end());
    out.others_order.assign(problem.others_order.begin(), problem.others_order.end());
    return out;
  }

  void list_edges() {
    for (HalfedgeId h{0}; h.value < tri_.origin.size(); ++h.value) {
      if (!tile_.owned[triangle_of(h).value]) continue;
      const PointId a = around_.point()[tri_.origin[h].value], b = around_.point()[tri_.target(h).value];
      const std::uint32_t piece = piece_of_[polygons_.subdivision().polygon[triangle_of(h).value]];
      if (tri_.twin[h].is_none()) {
        if (piece == kUnused)
          hull_edge_.insert(hull_edge_.end(), {a.value, b.value});
        else
          pieces_.add_hull(a, b, piece);
      } else if (polygons_.is_border(h)) {
        pieces_.add_border(a, b, piece);
      }
    }
  }

  // Own vertices that no order-k triangulation can save.
  [[nodiscard]] std::int64_t minima_bound() const {
    const auto& fate = polygons_.assignment().fate;
    if (fate.empty()) return 0;
    return std::count(fate.begin(), fate.begin() + around_.num_own(), MinimumFate::always);
  }

  const Neighborhood& around_;
  TriangulationView tri_;
  const CertifiedTile& tile_;
  const TilePolygons& polygons_;
  Objective objective_;
  std::vector<std::uint32_t> foreign_number_, triangle_, piece_of_;
  std::vector<std::uint64_t> foreign_point_, hull_edge_;
  std::vector<std::int32_t> foreign_xyz_;
  std::vector<std::array<std::uint32_t, 3>> answer_;
  PieceWriter pieces_;
  Figures figures_;
};

}  // namespace

void triangulate_tile(const RunContext& context, std::uint32_t tile) {
  const int k = context.options.triangulation.order;
  const Objective objective = context.options.triangulation.objective;
  Neighborhood around(context, tile, initial_halo(context.outline, tile, k));
  const CertifiedTile certified = certify(around, k);
  const TilePolygons polygons(certified, around.height(), k, objective);
  TileOutput output(around, certified, polygons, objective);
  output.solve();
  store::Writer out(context.layout.unit(Phase::triangulate, tile));
  out.set("recipe", context.recipe(Phase::triangulate));
  output.write(out);
  out.commit();
}

}  // namespace hydrotin
