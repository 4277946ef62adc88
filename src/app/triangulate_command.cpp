#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "commands.h"
#include "hydrotin/error.h"
#include "hydrotin/mesh.h"
#include "hydrotin/point_set.h"
#include "order_tables.h"
#include "small_points.h"

namespace hydrotin::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaxCommandOrder = 6;

Objective objective_or_complain(const std::string& text) {
  if (const auto objective = objective_named(text)) return *objective;
  throw Error(ErrorKind::config,
              fmt::format("--objective: '{}' is not possible (allowed: {})", text, fmt::join(kObjectiveNames, ", ")));
}

void require_order(int order) {
  if (order < 0 || order > kMaxCommandOrder)
    throw Error(ErrorKind::config,
                fmt::format("--order: {} is not possible (allowed: 0 to {})", order, kMaxCommandOrder));
}

SmallPoints load(const std::string& path) {
  SmallPoints points = load_small_points(path);
  for (const auto& note : points.notes) fmt::print(stderr, "{}: {}\n", path, note);
  if (!points.duplicates.empty())
    fmt::print(stderr, "{}: {} points lie where a lower or earlier one lies, and are dropped\n", path,
               points.duplicates.size());
  return points;
}

/// The largest order among the triangles, all of which are order-k triangles with useful edges.
std::uint32_t max_order(const OrderTables& tables, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::uint32_t most = 0;
  for (const auto& triangle : triangles) {
    const auto found = std::lower_bound(tables.triangles.begin(), tables.triangles.end(), std::pair(triangle, 0U));
    if (found == tables.triangles.end() || found->first != triangle)
      throw std::logic_error("a triangle that is none of order k");
    most = std::max(most, found->second);
  }
  return most;
}

/// Vertices in the order of the input's rows: without duplicates vertex i is row i.
void write_tin(const std::string& path, const SmallPoints& points, const PointSetTriangulation& result) {
  std::vector<std::uint32_t> by_row(points.row.size()), rank(points.row.size());
  std::iota(by_row.begin(), by_row.end(), 0U);
  std::sort(by_row.begin(), by_row.end(),
            [&](std::uint32_t a, std::uint32_t b) { return points.row[a] < points.row[b]; });
  std::vector<MeshVertex> vertices;
  vertices.reserve(by_row.size());
  for (const std::uint32_t v : by_row) {
    rank[v] = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back({points.lattice.x(points.position[v].x), points.lattice.y(points.position[v].y),
                        points.lattice.z(points.height[v])});
  }
  std::vector<MeshTriangle> triangles;
  triangles.reserve(result.triangles.size());
  for (const auto& [a, b, c] : result.triangles) triangles.push_back({rank[a], rank[b], rank[c]});
  write_ply(path, vertices, triangles, points.crs_wkt);
}

struct TriangulateArguments {
  std::string points, objective = "local-minima", out;
  int order = 2;
  bool json = false;
};

int triangulate_points(const TriangulateArguments& arguments) {
  const Objective objective = objective_or_complain(arguments.objective);
  require_order(arguments.order);
  const SmallPoints points = load(arguments.points);
  const PointSetTriangulation result = triangulate(points.position, points.height, arguments.order, objective);
  if (result.triangles.empty())
    throw Error(ErrorKind::input,
                fmt::format("{}: its {} distinct points lie on one line or are fewer than three: there is no triangle",
                            arguments.points, points.position.size()));
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const auto& triangle : result.triangles) {
    triangles.push_back({points.row[triangle[0]], points.row[triangle[1]], points.row[triangle[2]]});
    std::sort(triangles.back().begin(), triangles.back().end());
  }
  std::sort(triangles.begin(), triangles.end());
  const std::uint32_t most = max_order(order_tables(points, arguments.order), triangles);
  const std::uint32_t minima = count_minima(points.position, points.height, result.triangles);
  const double unit = objective == Objective::min_weight ? points.lattice.scale_xy : 1;
  const double polygons = std::max(1U, result.polygons);
  const Json polygon_figures = {{"count", result.polygons},
                                {"mean_size", static_cast<double>(triangles.size()) / polygons},
                                {"max_size", result.max_polygon},
                                {"mean_components", result.components / polygons},
                                {"max_components", result.max_components}};
  if (!arguments.out.empty()) write_tin(arguments.out, points, result);
  if (arguments.json) {
    const Json json = {{"points", points.num_rows},        {"order", arguments.order},
                       {"objective", arguments.objective}, {"value", unit * result.value()},
                       {"optimal", result.optimal},        {"bound", unit * result.bound},
                       {"triangles", triangles},           {"max_triangle_order", most},
                       {"polygons", polygon_figures},      {"local_minima", minima}};
    fmt::print("{}\n", json.dump());
    return 0;
  }
  fmt::print("points              {}\nduplicates          {}\ntriangles           {}\norder               {}\n",
             points.num_rows, points.duplicates.size(), triangles.size(), arguments.order);
  fmt::print("objective           {}\nvalue               {}\nbound               {}\noptimal             {}\n",
             arguments.objective, unit * result.value(), unit * result.bound, result.optimal);
  fmt::print("max triangle order  {}\nlocal minima        {}\n", most, minima);
  for (const auto& [key, value] : polygon_figures.items()) fmt::print("polygons {:<15}  {}\n", key, value.dump());
  return 0;
}

struct OrdersArguments {
  std::string points;
  int order = 2;
  bool json = false;
};

int list_orders(const OrdersArguments& arguments) {
  require_order(arguments.order);
  const SmallPoints points = load(arguments.points);
  const OrderTables tables = order_tables(points, arguments.order);
  if (arguments.json) {
    Json triangles = Json::array(), polygons = Json::array(), duplicates = Json::array();
    for (const auto& [rows, order] : tables.triangles) triangles.push_back({rows[0], rows[1], rows[2], order});
    for (const auto& [size, components] : tables.polygons)
      polygons.push_back({{"size", size}, {"components", components}});
    for (const auto& [dropped, kept] : points.duplicates) duplicates.push_back({dropped, kept});
    const Json json = {
        {"points", points.num_rows},     {"order", arguments.order},       {"delaunay_triangles", tables.delaunay},
        {"useful_edges", tables.useful}, {"order_k_triangles", triangles}, {"fixed_edges", tables.fixed},
        {"polygons", polygons},          {"duplicates", duplicates}};
    fmt::print("{}\n", json.dump());
    return 0;
  }
  fmt::print("points              {}\nduplicates          {}\norder               {}\n", points.num_rows,
             points.duplicates.size(), arguments.order);
  fmt::print("delaunay triangles  {}\nuseful edges        {}\norder-k triangles   {}\n", tables.delaunay.size(),
             tables.useful.size(), tables.triangles.size());
  fmt::print("fixed edges         {}\npolygons            {}\n", tables.fixed.size(), tables.polygons.size());
  return 0;
}

}  // namespace

void add_triangulate_command(CLI::App& program, Action& action) {
  auto arguments = std::make_shared<TriangulateArguments>();
  CLI::App* command =
      program.add_subcommand("triangulate", "the best order-k triangulation of a small point set, in memory");
  command->add_option("points", arguments->points, "CSV with header x,y,z, or LAS or LAZ")
      ->required()
      ->type_name("POINTS");
  command->add_option("--order", arguments->order, "0 to 6")->capture_default_str()->type_name("K");
  command->add_option("--objective", arguments->objective, "delaunay, min-weight or local-minima")
      ->capture_default_str();
  command->add_option("--out", arguments->out, "write the TIN")->type_name("TIN.ply");
  command->add_flag("--json", arguments->json, "print JSON");
  command->callback([arguments, &action] { action = [arguments] { return triangulate_points(*arguments); }; });

  auto orders = std::make_shared<OrdersArguments>();
  CLI::App* listing =
      program.add_subcommand("orders", "useful and fixed edges, order-k triangles and polygons of a small point set");
  listing->add_option("points", orders->points, "CSV with header x,y,z, or LAS or LAZ")
      ->required()
      ->type_name("POINTS");
  listing->add_option("--order", orders->order, "0 to 6")->capture_default_str()->type_name("K");
  listing->add_flag("--json", orders->json, "print JSON");
  listing->callback([orders, &action] { action = [orders] { return list_orders(*orders); }; });
}

}  // namespace hydrotin::app
