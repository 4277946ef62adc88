#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "edge_list.h"
#include "hydrotin/error.h"
#include "hydrotin/hull_heuristic.h"
#include "hydrotin/mesh.h"
#include "hydrotin/point_set.h"
#include "hydrotin/simple_polygon.h"
#include "objective_names.h"
#include "order_tables.h"
#include "small_points.h"
#include "small_thinning.h"

namespace hydrotin::app {
namespace {

using Json = nlohmann::ordered_json;

struct TriangulateArguments {
  std::string points, objective = "local-minima", method = "optimal", reference, edges, out;
  std::optional<double> max_error, thin, thin_cell;
  int order = 2;
  std::uint32_t boundary = 0;
  PolygonBudget budget;
  bool polygon = false, json = false;
};

[[noreturn]] void refuse(const std::string& text) {
  throw Error(ErrorKind::config, text);
}

ErrorLimit error_limit(double metres, const Lattice& lattice) {
  const double millionths = std::round(metres / lattice.scale_z * 1e6);
  if (!(metres >= 0) || millionths >= 2e15)
    refuse(fmt::format("--max-error: {} is not possible (allowed: from 0 to 2^31 units of height)", metres));
  return {static_cast<std::int64_t>(millionths)};
}

PolygonOptions polygon_options(const TriangulateArguments& arguments, const Lattice& lattice) {
  PolygonOptions options;
  options.objectives = objectives_or_complain("--objective", arguments.objective);
  if (arguments.max_error) options.max_error = error_limit(*arguments.max_error, lattice);
  options.z_per_xy = lattice.scale_z / lattice.scale_xy;
  options.budget = arguments.budget;
  if (arguments.method == "ties") options.method = ComponentMethod::ties;
  if (arguments.method == "lp") options.method = ComponentMethod::linear_program;
  if (arguments.method == "flip") options.method = ComponentMethod::flips;
  return options;
}

void check_arguments(const TriangulateArguments& a) {
  if (!a.polygon) require_order(a.order);
  if (a.order < 0) refuse(fmt::format("--order: {} is not possible (allowed: 0 and more)", a.order));
  const Objectives objectives = objectives_or_complain("--objective", a.objective);
  const bool needs = std::any_of(objectives.begin(), objectives.end(), needs_reference);
  if (a.thin && a.polygon) refuse("--thin: the points of a polygon are all needed (leave out --polygon)");
  if (a.thin_cell && !a.thin) refuse("--thin-cell: nothing is thinned (add --thin)");
  if ((needs || a.max_error) && a.reference.empty() && !a.thin)
    refuse("--reference: vertical errors are measured against reference points (give a file of points)");
  if (!a.polygon && !a.edges.empty()) refuse("--edges: edges inside belong to a polygon (add --polygon)");
  if (!a.polygon && a.boundary > 0) refuse("--boundary: only a polygon has a boundary (add --polygon)");
  if (a.method == "hull" && (a.polygon || objectives != Objectives{Objective::local_minima} || a.max_error || a.thin))
    refuse("--method: the hull heuristic reduces local minima of point sets only (--objective local-minima)");
}

/// The polygon by input rows: its rows are its order, so nothing may be dropped.
struct RowPoints {
  std::vector<LatticePoint> position;
  std::vector<std::int32_t> height;
};

RowPoints by_row(const std::string& path, const SmallPoints& points) {
  if (!points.duplicates.empty())
    throw Error(ErrorKind::input,
                fmt::format("{}: rows {} and {} are at one place (the points of a polygon must differ)", path,
                            points.duplicates.front().second, points.duplicates.front().first));
  RowPoints out{std::vector<LatticePoint>(points.position.size()), std::vector<std::int32_t>(points.position.size())};
  for (std::size_t v = 0; v < points.position.size(); ++v) {
    out.position[points.row[v]] = points.position[v];
    out.height[points.row[v]] = points.height[v];
  }
  return out;
}

/// A result by input rows.
PointSetTriangulation solve_polygon(const TriangulateArguments& a, const SmallPoints& points,
                                    const PointSetOptions& options) {
  const RowPoints rows = by_row(a.points, points);
  const auto n = static_cast<std::uint32_t>(rows.position.size());
  if (a.boundary > n) refuse(fmt::format("--boundary: {} is not possible ({} has {} points)", a.boundary, a.points, n));
  std::vector<std::array<std::uint32_t, 2>> edges;
  if (!a.edges.empty()) edges = read_edges(a.edges, n);
  try {
    SimplePolygonTriangulation result =
        triangulate_polygon({rows.position, rows.height, a.boundary == 0 ? n : a.boundary, edges}, options,
                            {points.reference_position, points.reference_height});
    if (!result.found)
      throw Error(ErrorKind::input,
                  fmt::format("the polygon has no triangulation of order {}; the smallest order that has one is {} "
                              "(--order {})",
                              a.order, result.smallest_order, result.smallest_order));
    return std::move(result.best);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    throw Error(ErrorKind::input, a.points + ": " + error.what());
  }
}

PointSetTriangulation solve_point_set(const TriangulateArguments& a, const SmallPoints& points,
                                      const PointSetOptions& options) {
  PointSetTriangulation result = a.method == "hull" ? hull_heuristic(points.position, points.height, options.order)
                                                    : triangulate(points.position, points.height, options,
                                                                  {points.reference_position, points.reference_height});
  if (result.triangles.empty())
    throw Error(ErrorKind::input,
                fmt::format("{}: its {} distinct points lie on one line or are fewer than three: there is no triangle",
                            a.points, points.position.size()));
  for (auto& triangle : result.triangles)
    for (auto& v : triangle) v = points.row[v];
  return result;
}

/// Vertices in the order of the input's rows: without duplicates vertex i is row i.
void write_tin(const std::string& path, const SmallPoints& points, const PointSetTriangulation& result) {
  std::vector<std::uint32_t> order(points.row.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return points.row[a] < points.row[b]; });
  std::vector<MeshVertex> vertices;
  std::vector<std::uint32_t> rank(points.num_rows);
  for (const std::uint32_t v : order) {
    rank[points.row[v]] = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back({points.lattice.x(points.position[v].x), points.lattice.y(points.position[v].y),
                        points.lattice.z(points.height[v])});
  }
  std::vector<MeshTriangle> triangles;
  for (const auto& [a, b, c] : result.triangles) triangles.push_back({rank[a], rank[b], rank[c]});
  write_ply(path, vertices, triangles, points.crs_wkt);
}

std::uint32_t minima_of(const SmallPoints& points, const PointSetTriangulation& result) {
  std::vector<std::uint32_t> vertex(points.num_rows);
  for (std::uint32_t v = 0; v < points.row.size(); ++v) vertex[points.row[v]] = v;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const auto& [a, b, c] : result.triangles) triangles.push_back({vertex[a], vertex[b], vertex[c]});
  return count_minima(points.position, points.height, triangles);
}

Json to_json(const TriangulateArguments& a, const SmallPoints& points, const PointSetTriangulation& result,
             const Objectives& objectives, const std::optional<SmallThinning>& thinning) {
  std::vector<std::array<std::uint32_t, 3>> triangles = result.triangles;
  for (auto& triangle : triangles) std::sort(triangle.begin(), triangle.end());
  std::sort(triangles.begin(), triangles.end());
  const double unit = unit_of(objectives.front(), points.lattice), polygons = std::max(1U, result.polygons);
  Json values = Json::array();
  for (std::size_t i = 0; i < objectives.size(); ++i)
    values.push_back(unit_of(objectives[i], points.lattice) * result.values[i]);
  Json json = {{"points", points.num_rows},
               {"order", a.order},
               {"objective", name(objectives)},
               {"value", unit * result.value()},
               {"optimal", result.optimal},
               {"bound", unit * result.bound},
               {"triangles", triangles},
               {"max_triangle_order", result.max_order},
               {"polygons",
                {{"count", result.polygons},
                 {"mean_size", static_cast<double>(triangles.size()) / polygons},
                 {"max_size", result.max_polygon},
                 {"mean_components", result.components / polygons},
                 {"max_components", result.max_components}}},
               {"local_minima", minima_of(points, result)},
               {"method", a.method},
               {"values", values},
               {"fallbacks", result.fallbacks}};
  if (thinning)
    json["thinning"] = {{"limit", thinning->limit},
                        {"cell", thinning->cell},
                        {"kept", thinning->kept},
                        {"removed", thinning->removed},
                        {"kept_percent", 100 * static_cast<double>(thinning->kept) /
                                             static_cast<double>(thinning->kept + thinning->removed)},
                        {"pruned", thinning->pruned},
                        {"settled", thinning->settled},
                        {"delaunay_max_error", thinning->max_error},
                        {"delaunay_rms_error", thinning->rms_error},
                        {"max_error", points.lattice.scale_z * result.error.largest}};
  if (a.reference.empty() && !thinning) return json;
  json["reference"] = {
      {"points", points.reference_position.size()},  {"outside", result.reference_outside},
      {"at_vertices", result.reference_at_vertices}, {"max_error", points.lattice.scale_z * result.error.largest},
      {"limit_missed", result.limit_missed},         {"vertices_beyond_limit", result.vertices_beyond_limit}};
  return json;
}

void print_table(const Json& json) {
  const auto row = [](const std::string& key, const Json& value) {
    fmt::print("{:<28}{}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
  };
  for (const auto& [key, value] : json.items()) {
    if (key == "triangles") {
      row("triangles", value.size());
    } else if (value.is_object()) {
      for (const auto& [inner, figure] : value.items()) row(key + " " + inner, figure);
    } else {
      row(key, value);
    }
  }
}

int triangulate_points(const TriangulateArguments& a) {
  check_arguments(a);
  SmallPoints points = load_and_note(a.points, a.reference);
  std::optional<SmallThinning> thinning;
  if (a.thin) thinning = thin_small_points(points, *a.thin, a.thin_cell);
  PointSetOptions options{.order = a.order, .polygon = polygon_options(a, points.lattice)};
  // What was removed stays within the limit in the best triangulation too, unless other points are to be looked at.
  if (a.thin && !a.max_error && a.reference.empty()) options.polygon.max_error = error_limit(*a.thin, points.lattice);
  const PointSetTriangulation result =
      a.polygon ? solve_polygon(a, points, options) : solve_point_set(a, points, options);
  if (result.limit_missed + result.vertices_beyond_limit > 0)
    fmt::print(stderr, "{}: the limit on errors cannot be kept in {} polygons and at {} vertices\n", a.points,
               result.limit_missed, result.vertices_beyond_limit);
  if (!a.out.empty()) write_tin(a.out, points, result);
  const Json json = to_json(a, points, result, options.polygon.objectives, thinning);
  if (a.json)
    fmt::print("{}\n", json.dump());
  else
    print_table(json);
  return 0;
}

}  // namespace

void add_triangulate_command(CLI::App& program, Action& action) {
  auto a = std::make_shared<TriangulateArguments>();
  CLI::App* command = program.add_subcommand(
      "triangulate", "the best order-k triangulation of a small point set or polygon, in memory");
  command->add_option("points", a->points, "CSV with header x,y,z, LAS, LAZ, or a raster of heights")
      ->required()
      ->type_name("POINTS");
  command->add_option("--order", a->order, "0 to 20; of a polygon any")->capture_default_str()->type_name("K");
  command->add_option("--objective", a->objective, "one, or several by priority with commas: " + all_objective_names())
      ->capture_default_str()
      ->type_name("NAME[,NAME...]");
  command->add_flag("--polygon", a->polygon, "the points are the vertices of a simple polygon, in order");
  command->add_option("--boundary", a->boundary, "only the first N points are; the others lie inside")->type_name("N");
  command->add_option("--edges", a->edges, "edges inside the polygon that must be there: CSV, two rows a line")
      ->type_name("EDGES");
  command->add_option("--reference", a->reference, "points against which vertical errors are measured")
      ->type_name("POINTS");
  command->add_option("--max-error", a->max_error, "limit on vertical errors")->type_name("M");
  command
      ->add_option("--thin", a->thin,
                   "keep only the points that the TIN needs to pass all others within this height, which become "
                   "reference points")
      ->type_name("M");
  command->add_option("--thin-cell", a->thin_cell, "side of the grid's cells (eight mean spacings)")->type_name("M");
  command
      ->add_option("--method", a->method,
                   "optimal; its parts ties and lp for components; the heuristics flip and hull of de Kok et al.")
      ->capture_default_str()
      ->check(CLI::IsMember({"optimal", "ties", "lp", "flip", "hull"}));
  command->add_option("--max-polygon", a->budget.max_triangles, "triangles of a polygon that is searched")
      ->capture_default_str();
  command->add_option("--max-ways", a->budget.max_ways, "ways to tie one component before the linear program")
      ->capture_default_str();
  command->add_option("--max-columns", a->budget.max_program, "triangles in a linear program")->capture_default_str();
  command->add_option("--max-branches", a->budget.max_branches, "linear programs for one polygon")
      ->capture_default_str();
  command->add_option("--out", a->out, "write the TIN")->type_name("TIN.ply");
  command->add_flag("--json", a->json, "print JSON");
  command->callback([a, &action] { action = [a] { return triangulate_points(*a); }; });
}

}  // namespace hydrotin::app
