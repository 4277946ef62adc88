#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "certify.h"
#include "hydrotin/measure.h"
#include "hydrotin/polygon_batch.h"
#include "phases.h"
#include "pieces.h"
#include "polygon_figures.h"
#include "tile_executor.h"
#include "tile_reference.h"

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
  TilePolygons(const CertifiedTile& tile, std::span<const std::int32_t> height, const Objectives& objectives,
               const TileReference* reference, const Executor& executor)
      : tile_(tile),
        tri_(tile.triangulation.view()),
        crossings_(find_crossings(tri_, tile.edges, executor)),
        subdivision_(subdivide(tri_, joined_inside(), executor)),
        triangles_(order_k_triangles(tri_, tile.edges, executor)) {
    find_borders();
    distribute();
    const bool by_minima = counts_minima(objectives);
    if (by_minima) assignment_ = assign_minima(tri_, tile.links, tile.edges, crossings_, height, executor);
    choose(height, objectives, reference != nullptr, executor);
    source_ = std::make_unique<PolygonSource>(PolygonSource{tri_, height, crossings_, subdivision_, triangles_,
                                                            candidates_, by_minima ? &assignment_ : nullptr,
                                                            reference ? &reference->location : nullptr});
  }

  [[nodiscard]] const PolygonSource& source() const { return *source_; }
  [[nodiscard]] const Subdivision& subdivision() const { return subdivision_; }
  [[nodiscard]] const Crossings& crossings() const { return crossings_; }
  [[nodiscard]] const MinimaAssignment& assignment() const { return assignment_; }
  [[nodiscard]] bool is_owned(std::uint32_t f) const {
    return tile_.owned[subdivision_.triangles_of(f).front().value] != 0;
  }
  [[nodiscard]] bool crosses_border(std::uint32_t f) const { return border_[f] != 0; }
  // Whether all triangles of the polygon are owned.
  [[nodiscard]] bool is_complete(std::uint32_t f) const { return is_owned(f) && !crosses_border(f); }
  // Whether there is more than one way to triangulate the polygon.
  [[nodiscard]] bool has_choice(std::uint32_t f) const { return candidates_.begin[f] < candidates_.begin[f + 1]; }
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

  void choose(std::span<const std::int32_t> height, const Objectives& objectives, bool has_reference,
              const Executor& executor) {
    if (has_reference) {  // errors are measured everywhere, and may exceed the limit in single triangles
      to_solve_.assign(subdivision_.size(), 1);
      return;
    }
    if (objectives.size() == 1) {
      to_solve_ = polygons_to_solve(tri_, tile_.links, height, crossings_, subdivision_, objectives.front(),
                                    counts_minima(objectives) ? &assignment_ : nullptr, executor);
      return;
    }
    // Delaunay triangles that serve all vertices may not be best for the objectives after the first.
    to_solve_.resize(subdivision_.size());
    for (std::uint32_t f = 0; f < subdivision_.size(); ++f) to_solve_[f] = subdivision_.triangles_of(f).size() > 1;
  }

  void find_borders() {
    border_.resize(subdivision_.size());
    for (HalfedgeId h{0}; h.value < crossings_.crossed.size(); ++h.value)
      if (is_border(h)) border_[subdivision_.polygon[triangle_of(h).value]] = 1;
  }

  // An order-k triangle belongs to the polygon that its edges enter. Pieces of one polygon may each be entered by
  // another edge, and every tile lists it where an edge enters an owned triangle: so some tile does.
  void distribute() {
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
        const std::uint32_t e = find_edge(tri_, tile_.edges, v[i], v[(i + 1) % 3]);
        if (e == UsefulEdges::kNone) continue;
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

// The answers of the complete polygons that were solved, ascending.
struct Answers {
  std::vector<std::uint32_t> polygon;
  std::vector<std::uint64_t> begin{0};  // first triangle of each
  std::vector<std::array<VertexId, 3>> triangle;
  ResultTable result;
  std::vector<VertexId> unserved;  // vertices that their polygon left without a lower neighbour
  std::vector<VertexId> servable;  // with an admissible edge down inside a polygon, under a limit on errors

  void append(const Answers& other) {
    polygon.insert(polygon.end(), other.polygon.begin(), other.polygon.end());
    const std::uint64_t base = begin.back();
    for (std::size_t i = 1; i < other.begin.size(); ++i) begin.push_back(base + other.begin[i]);
    triangle.insert(triangle.end(), other.triangle.begin(), other.triangle.end());
    result.append(other.result);
    unserved.insert(unserved.end(), other.unserved.begin(), other.unserved.end());
    servable.insert(servable.end(), other.servable.begin(), other.servable.end());
  }
};

// The polygons of a range that are to be solved as a whole.
Answers solve_range(const TilePolygons& polygons, std::uint32_t begin, std::uint32_t end, PolygonExtractor& extractor,
                    PolygonSolver& solver) {
  Answers out;
  std::vector<std::array<std::uint32_t, 3>> answer;
  for (std::uint32_t f = begin; f < end; ++f) {
    if (!polygons.is_complete(f) || !polygons.is_to_solve(f)) continue;
    answer.clear();
    const PolygonResult result = solver.solve(extractor.extract(f), answer);
    const auto vertex = extractor.vertices();
    for (const auto& t : answer) out.triangle.push_back({vertex[t[0]], vertex[t[1]], vertex[t[2]]});
    for (const std::uint32_t v : solver.unserved()) out.unserved.push_back(vertex[v]);
    for (const std::uint32_t v : solver.servable()) out.servable.push_back(vertex[v]);
    out.polygon.push_back(f);
    out.begin.push_back(out.triangle.size());
    out.result.add(result);
  }
  return out;
}

// All of them: ranges small enough that large polygons do not keep one worker busy alone.
Answers solve_complete(const TilePolygons& polygons, const PolygonOptions& options, const Executor& executor) {
  constexpr std::uint32_t kPolygonRange = 512;
  struct Tools {
    PolygonExtractor extractor;
    PolygonSolver solver;
  };
  Pool<Tools> pool([&] {
    return std::make_unique<Tools>(Tools{PolygonExtractor(polygons.source()), PolygonSolver(options)});
  });
  const std::uint32_t size = polygons.subdivision().size();
  std::vector<Answers> parts((size + kPolygonRange - 1) / kPolygonRange);
  for_ranges(executor, size, kPolygonRange, [&](std::uint32_t begin, std::uint32_t end) {
    const auto tools = pool.lend();
    parts[begin / kPolygonRange] = solve_range(polygons, begin, end, tools->extractor, tools->solver);
  });
  Answers out;
  for (Answers& part : parts) out.append(std::exchange(part, {}));
  return out;
}

// Complete polygons that may be offered a vertex which another polygon leaves without a lower neighbour: one that this
// tile does not know as a whole, or one of its own that did. They are decided after the seams.
std::vector<std::uint8_t> contested_polygons(const TilePolygons& polygons, const VertexLinks& links,
                                             const std::vector<VertexId>& unserved) {
  const Subdivision& subdivision = polygons.subdivision();
  const auto& where = polygons.assignment().where;
  std::vector<std::uint8_t> contested(subdivision.size()), left(where.size());
  for (const VertexId v : unserved) left[v.value] = 1;
  for (std::uint32_t v = 0; v < where.size(); ++v) {
    if (where[v].is_none()) continue;
    const std::uint32_t own = subdivision.polygon[where[v].value];
    if (!left[v] && polygons.is_complete(own)) continue;
    for (std::uint32_t i = links.begin[v]; i < links.begin[v + 1]; ++i) {
      if (links.spoke[i].is_none()) continue;
      const std::uint32_t f = subdivision.polygon[triangle_of(links.spoke[i]).value];
      if (f != own && polygons.is_complete(f) && polygons.has_choice(f)) contested[f] = 1;
    }
  }
  return contested;
}

// Writes what is decided, cuts out what crosses the border or is contested.
class TileOutput {
 public:
  TileOutput(const Neighborhood& around, const CertifiedTile& tile, const TilePolygons& polygons,
             PolygonOptions options)
      : around_(around),
        tri_(tile.triangulation.view()),
        tile_(tile),
        polygons_(polygons),
        options_(std::move(options)),
        foreign_number_(around.position().size() - around.num_own(), kUnused) {}

  void solve(const Executor& executor) {
    const Subdivision& subdivision = polygons_.subdivision();
    PolygonExtractor extractor(polygons_.source());
    const Answers answers = solve_complete(polygons_, options_, executor);
    for (const VertexId v : answers.unserved) unserved_.push_back(around_.point()[v.value].value);
    list_servable(answers.servable);
    const auto contested = contested_polygons(polygons_, tile_.links, answers.unserved);
    piece_of_.assign(subdivision.size(), kUnused);
    std::size_t solved = 0;
    for (std::uint32_t f = 0; f < subdivision.size(); ++f) {
      const bool is_solved = solved < answers.polygon.size() && answers.polygon[solved] == f;
      const std::size_t number = solved;
      solved += is_solved;
      if (!polygons_.is_owned(f)) continue;
      if (polygons_.crosses_border(f) || contested[f]) {
        const PolygonProblem& problem = extractor.extract(f);
        piece_of_[f] = pieces_.add(piece(problem, extractor.vertices()));
        continue;
      }
      figures_.add(static_cast<std::uint32_t>(subdivision.triangles_of(f).size()), subdivision.components[f]);
      if (is_solved)
        keep(answers, number);
      else
        keep_delaunay(f);
    }
    list_edges();
    count_edges();
  }

  void write(store::Writer& out) const {
    out.append("triangle", triangle_, "below n: own point; else n + foreign number; three per triangle");
    out.append("foreign_point", foreign_point_, "tile << 32 | index");
    out.append("foreign_xyz", foreign_xyz_);
    out.append("hull_edge", hull_edge_, "directed edges of the hull at these triangles, as pairs of points");
    out.append("unserved", unserved_, "points that their polygon left without a lower neighbour");
    out.append("servable", servable_, "points of other tiles with an admissible edge down, under a limit on errors");
    out.append("doubtful", doubtful_, "own points that need another tile's polygons to have one");
    pieces_.write(out);
    write_figures(out, figures_);
    out.set("useful_edges", useful_edges_);
    out.set("fixed_edges", fixed_edges_);
    out.set("minima_bound", minima_bound());
    out.set("rounds", std::int64_t{tile_.rounds});
    out.set("fetched", static_cast<std::int64_t>(around_.num_fetched()));
    out.set("loaded", static_cast<std::int64_t>(around_.position().size()));
  }

 private:
  static constexpr std::uint32_t kUnused = static_cast<std::uint32_t>(-1);

  void list_servable(const std::vector<VertexId>& vertices) {
    if (!options_.max_error || polygons_.assignment().fate.empty()) return;
    std::vector<std::uint8_t> servable(tri_.num_vertices());
    for (const VertexId v : vertices) servable[v.value] = 1;
    for (std::uint32_t v = 0; v < servable.size(); ++v) {
      const bool is_own = v < around_.num_own();
      if (!is_own && servable[v]) servable_.push_back(around_.point()[v].value);
      if (is_own && !servable[v] && polygons_.assignment().fate[v] == MinimumFate::assigned)
        doubtful_.push_back(around_.point()[v].value);
    }
  }

  void keep(const Answers& answers, std::size_t number) {
    for (std::uint64_t t = answers.begin[number]; t < answers.begin[number + 1]; ++t)
      for (const VertexId v : answers.triangle[t]) triangle_.push_back(reference(v));
    figures_.add(answers.result[number]);
  }

  // Of a polygon whose Delaunay triangles are the best answer.
  void keep_delaunay(std::uint32_t f) {
    const Objective first = options_.objectives.front();
    const bool by_shape = kind_of(first) == ObjectiveKind::bottleneck && first != Objective::min_max_order;
    PolygonResult result;
    if (by_shape) result.bound = -std::numeric_limits<double>::infinity();
    for (const TriangleId t : polygons_.subdivision().triangles_of(f)) {
      const HalfedgeId h = first_halfedge(t);
      const std::array corner{tri_.origin[h], tri_.target(h), tri_.apex(h)};
      for (const VertexId v : corner) triangle_.push_back(reference(v));
      if (by_shape)
        result.bound = std::max(result.bound, triangle_score(first, tri_.position[corner[0]], tri_.position[corner[1]],
                                                             tri_.position[corner[2]]));
    }
    figures_.add(result);
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
    out.reference.assign(problem.reference.begin(), problem.reference.end());
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

  // Each edge counts for the tile that owns its smaller end in (x, y).
  void count_edges() {
    for (VertexId v{0}; tri_.num_triangles() > 0 && v.value < around_.num_own(); ++v.value)
      for (std::uint32_t i = tile_.links.begin[v.value]; i < tile_.links.begin[v.value + 1]; ++i) {
        if (!(tri_.position[v] < tri_.position[tile_.links.neighbor[i]])) continue;
        const HalfedgeId spoke = tile_.links.spoke[i];
        ++useful_edges_;
        fixed_edges_ += spoke.is_none() || !polygons_.crossings().crossed[spoke.value];
      }
    if (tri_.num_triangles() > 0) useful_edges_ += tile_.edges.begin[around_.num_own()];
  }

  // Own vertices that no order-k triangulation can save.
  [[nodiscard]] std::int64_t minima_bound() const {
    const auto& fate = polygons_.assignment().fate;
    if (fate.empty() || tri_.num_triangles() == 0) return 0;
    return std::count(fate.begin(), fate.begin() + around_.num_own(), MinimumFate::always);
  }

  const Neighborhood& around_;
  TriangulationView tri_;
  const CertifiedTile& tile_;
  const TilePolygons& polygons_;
  PolygonOptions options_;
  std::vector<std::uint32_t> foreign_number_, triangle_, piece_of_;
  std::vector<std::uint64_t> foreign_point_, hull_edge_, unserved_, servable_, doubtful_;
  std::vector<std::int32_t> foreign_xyz_;
  PieceWriter pieces_;
  PolygonFigures figures_;
  std::int64_t useful_edges_ = 0, fixed_edges_ = 0;
};

}  // namespace

void triangulate_tile(const RunContext& context, std::uint32_t tile) {
  const int k = context.options.triangulation.order;
  Neighborhood around(context, tile, initial_halo(context.outline, tile, k));
  const Executor executor = tile_executor();
  const CertifiedTile certified = certify(around, k, executor);
  const PolygonOptions solving = polygon_options(context);
  TileReference reference;
  const bool has_reference = context.has_reference();
  if (has_reference)
    reference = read_tile_reference(context, tile, certified, around.height(),
                                    solving.max_error ? &*solving.max_error : nullptr);
  const TilePolygons polygons(certified, around.height(), solving.objectives, has_reference ? &reference : nullptr,
                              executor);
  TileOutput output(around, certified, polygons, solving);
  output.solve(executor);
  store::Writer out(context.layout.unit(Phase::triangulate, tile));
  out.set("recipe", context.recipe(Phase::triangulate));
  output.write(out);
  write_reference_figures(out, reference);
  out.commit();
}

}  // namespace hydrotin
