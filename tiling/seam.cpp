#include <unordered_map>

#include "hydrotin/polygon.h"
#include "phases.h"
#include "polygon_figures.h"
#include "seam_polygon.h"

namespace hydrotin {
namespace {

class SeamOutput {
 public:
  void add(const SeamPolygon& polygon, const PolygonProblem& problem, const PolygonSolver& solver,
           const PolygonResult& result, const std::vector<std::array<std::uint32_t, 3>>& answer) {
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
    triangle_begin_.push_back(triangle_.size() / 3);
    for (const auto& edge : polygon.hull()) hull_edge_.insert(hull_edge_.end(), {edge[0].value, edge[1].value});
    for (const std::uint32_t v : solver.unserved()) unserved_.push_back(polygon.vertices()[v].point.value);
    for (const std::uint32_t v : solver.servable()) servable_.push_back(polygon.vertices()[v].point.value);
    figures_.add(static_cast<std::uint32_t>(problem.delaunay.size()), problem.components);
    results_.add(result);
  }

  void write(store::Writer& out) const {
    out.append("triangle", triangle_, "numbers of points below, three per triangle");
    out.append("triangle_begin", triangle_begin_, "first triangle of each polygon");
    out.append("point", point_, "tile << 32 | index");
    out.append("point_xyz", xyz_);
    out.append("hull_edge", hull_edge_, "directed edges of the hull, as pairs of points");
    out.append("unserved", unserved_, "points that their polygon left without a lower neighbour");
    out.append("servable", servable_, "points with an admissible edge down inside a polygon, under a limit on errors");
    write_figures(out, figures_);
    results_.write(out);
  }

 private:
  std::unordered_map<std::uint64_t, std::uint32_t> number_;
  std::vector<std::uint64_t> point_, hull_edge_, triangle_begin_{0}, unserved_, servable_;
  std::vector<std::int32_t> xyz_;
  std::vector<std::uint32_t> triangle_;
  PolygonFigures figures_;  // form only: answers may change
  ResultTable results_;
};

}  // namespace

void solve_seams(const RunContext& context, std::uint32_t tile) {
  SeamList seams(context, tile);
  PolygonSolver solver(polygon_options(context));
  SeamPolygon polygon;
  SeamOutput output;
  std::vector<std::array<std::uint32_t, 3>> answer;
  for (std::uint32_t f = 0; f < seams.size(); ++f) {
    seams.read(f, polygon);
    const PolygonProblem problem = polygon.problem();
    answer.clear();
    const PolygonResult result = solver.solve(problem, answer);
    output.add(polygon, problem, solver, result, answer);
  }
  store::Writer out(context.layout.unit(Phase::seam, tile));
  out.set("recipe", context.recipe(Phase::seam));
  output.write(out);
  out.commit();
}

}  // namespace hydrotin
