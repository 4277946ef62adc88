#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "commands.h"
#include "order_tables.h"
#include "small_points.h"

namespace hydrotin::app {
namespace {

using Json = nlohmann::ordered_json;

struct OrdersArguments {
  std::string points;
  int order = 2;
  bool json = false;
};

void print_json(const OrdersArguments& arguments, const SmallPoints& points, const OrderTables& tables) {
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
}

int list_orders(const OrdersArguments& arguments) {
  require_order(arguments.order);
  const SmallPoints points = load_and_note(arguments.points);
  const OrderTables tables = order_tables(points, arguments.order);
  if (arguments.json) {
    print_json(arguments, points, tables);
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

void add_orders_command(CLI::App& program, Action& action) {
  auto arguments = std::make_shared<OrdersArguments>();
  CLI::App* command =
      program.add_subcommand("orders", "useful and fixed edges, order-k triangles and polygons of a small point set");
  command->add_option("points", arguments->points, "CSV with header x,y,z, LAS, LAZ, or a raster of heights")
      ->required()
      ->type_name("POINTS");
  command->add_option("--order", arguments->order, "0 to 20")->capture_default_str()->type_name("K");
  command->add_flag("--json", arguments->json, "print JSON");
  command->callback([arguments, &action] { action = [arguments] { return list_orders(*arguments); }; });
}

}  // namespace hydrotin::app
