#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "fill_terrain.h"
#include "hydrotin/error.h"
#include "hydrotin/greedy_breach.h"
#include "hydrotin/lifting.h"
#include "hydrotin/mesh.h"
#include "hydrotin/pit_removal.h"
#include "hydrotin/pits.h"

namespace hydrotin::app {
namespace {

struct FillArguments {
  std::string tin, method = "least-change", measure = "total", outlets = "hull", out;
  std::vector<std::uint32_t> pits;
  bool json = false;
};

const std::vector<std::pair<std::string, RemovalMethod>> kMethods{{"lift", RemovalMethod::lift},
                                                                  {"breach", RemovalMethod::breach},
                                                                  {"greedy-breach", RemovalMethod::greedy_breach},
                                                                  {"least-change", RemovalMethod::least_change}};
const std::vector<std::pair<std::string, ChangeMeasure>> kMeasures{{"total", ChangeMeasure::total},
                                                                   {"max", ChangeMeasure::max},
                                                                   {"count", ChangeMeasure::count},
                                                                   {"volume", ChangeMeasure::volume}};

template <class Value>
Value named(const std::string& option, const std::string& text,
            const std::vector<std::pair<std::string, Value>>& known) {
  std::vector<std::string> names;
  for (const auto& [name, value] : known) {
    if (name == text) return value;
    names.push_back(name);
  }
  throw Error(ErrorKind::config,
              fmt::format("{}: '{}' is not possible (allowed: {})", option, text, fmt::join(names, ", ")));
}

struct FillResult {
  std::uint64_t minima_before = 0, minima_after = 0, moved = 0;
  double total = 0, most = 0, volume = 0, bound = 0;
};

/// Writes new heights into the mesh. Vertices that stay keep their bits; others take the value of a vertex at their new
/// level where there is one. Heights with more digits than the integers hold may leave a rise of a rounding error:
/// lifting by comparisons alone, which is all that the method `lift` does, removes it.
void set_heights(Mesh& mesh, const FillTerrain& terrain, const Removal& removal, RemovalMethod method,
                 const std::vector<std::uint8_t>& ends) {
  if (method != RemovalMethod::lift) {
    std::map<std::int32_t, double> value;
    for (std::size_t v = 0; v < mesh.vertex.size() && !terrain.is_exact; ++v) {
      const auto [at, is_new] = value.emplace(terrain.height[v], mesh.vertex[v][2]);
      if (!is_new) at->second = std::max(at->second, mesh.vertex[v][2]);
    }
    for (std::size_t v = 0; v < mesh.vertex.size(); ++v) {
      if (removal.height[v] == terrain.height[v]) continue;
      const auto at = value.find(removal.height[v]);
      mesh.vertex[v][2] = at != value.end() ? at->second : terrain.z(removal.height[v]);
    }
  }
  const RankedHeights ranked = rank_heights(mesh);
  const auto level = lift(terrain.graph, ranked.height, ends);
  for (std::size_t v = 0; v < mesh.vertex.size(); ++v)
    if (level[v] != ranked.height[v]) mesh.vertex[v][2] = ranked.level[static_cast<std::size_t>(level[v])];
}

FillResult compare(const Mesh& before, const Mesh& after, const FillTerrain& terrain, const Removal& removal,
                   ChangeMeasure measure) {
  FillResult result;
  for (std::size_t v = 0; v < before.vertex.size(); ++v) {
    const double moved = std::abs(after.vertex[v][2] - before.vertex[v][2]);
    result.moved += moved != 0;
    result.total += moved;
    result.most = std::max(result.most, moved);
    result.volume += moved * static_cast<double>(terrain.weight[v]) * terrain.area_unit / 3;
  }
  result.bound = static_cast<double>(removal.bound);
  if (measure != ChangeMeasure::count) result.bound /= static_cast<double>(terrain.denominator);
  if (measure == ChangeMeasure::volume) result.bound *= terrain.area_unit / 3;
  return result;
}

constexpr std::size_t kUnlimitedVertices = 200'000;  // up to here the search for each breach is run to its end

/// Small terrains are searched thoroughly.
bool is_small(std::uint64_t num_pits, std::uint64_t num_vertices) {
  return (num_pits + 1) * (num_pits + 1) <= kGreedyBreachLimit / std::max<std::uint64_t>(num_vertices, 1);
}

void talk(const FillTerrain& terrain, const Removal& removal, RemovalMethod method) {
  if (terrain.is_rounded && method != RemovalMethod::lift)
    fmt::print(stderr, "note: costs were weighed with heights rounded to multiples of {}\n", terrain.quantum());
  const bool lowers_only = method == RemovalMethod::breach || method == RemovalMethod::greedy_breach;
  if (lowers_only && removal.num_unbreached > 0)
    fmt::print(stderr, "note: {} of {} pits lie below all outlets that they can reach and were lifted\n",
               removal.num_unbreached, removal.num_pits);
  if (removal.num_unguaranteed > 0)
    fmt::print(stderr,
               "note: {} groups of pits are too large for Algorithm 6.1 and were breached one pit after the other\n",
               removal.num_unguaranteed);
}

void print_json(const FillArguments& arguments, const Mesh& mesh, const FillResult& result, const Removal& removal) {
  nlohmann::ordered_json heights = nlohmann::ordered_json::array();
  for (const auto& vertex : mesh.vertex) heights.push_back(vertex[2]);
  const nlohmann::ordered_json json = {{"vertices", mesh.vertex.size()},
                                       {"minima_before", result.minima_before},
                                       {"minima_after", result.minima_after},
                                       {"vertices_moved", result.moved},
                                       {"total_displacement", result.total},
                                       {"max_displacement", result.most},
                                       {"volume_change", result.volume},
                                       {"method", arguments.method},
                                       {"measure", arguments.measure},
                                       {"optimal", removal.is_optimal},
                                       {"bound", result.bound},
                                       {"lifted_for_want_of_a_breach", removal.num_unbreached},
                                       {"heights", heights}};
  fmt::print("{}\n", json.dump());
}

void print_table(const FillArguments& arguments, const Mesh& mesh, const FillResult& result, const Removal& removal) {
  fmt::print("vertices            {}\nminima before       {}\nminima after        {}\nvertices moved      {}\n",
             mesh.vertex.size(), result.minima_before, result.minima_after, result.moved);
  fmt::print("total displacement  {}\nmax displacement    {}\nvolume of change    {}\n", result.total, result.most,
             result.volume);
  fmt::print("{:<20}{}\n", "best " + arguments.measure,
             removal.is_optimal ? "this one is proven to be it" : fmt::format("not below {}", result.bound));
}

int fill(const FillArguments& arguments) {
  RemovalOptions options;
  options.method = named("--method", arguments.method, kMethods);
  options.measure = named("--measure", arguments.measure, kMeasures);
  options.with_bound = true;
  Mesh mesh = read_mesh(arguments.tin);
  const FillTerrain terrain = make_fill_terrain(arguments.tin, mesh);
  const auto is_outlet = find_outlets(arguments.tin, arguments.outlets, terrain);
  const auto ends = keep_other_pits(arguments.pits, terrain, is_outlet);
  options.thorough = is_small(count_pits(terrain.graph, terrain.height, ends), terrain.height.size());
  if (options.thorough) options.max_rounds = 6;
  if (terrain.height.size() > kUnlimitedVertices) options.limits.max_visits = kScalableVisits;
  ChangeableTerrain changeable{&terrain.graph, terrain.height, terrain.position, ends, {}, {}, {}};
  if (options.measure == ChangeMeasure::volume) changeable.weight = terrain.weight;
  const Removal removal = remove_pits(changeable, options);
  const Mesh original = mesh;
  set_heights(mesh, terrain, removal, options.method, ends);
  FillResult result = compare(original, mesh, terrain, removal, options.measure);
  result.minima_before = count_pits(terrain.graph, rank_heights(original).height, is_outlet);
  result.minima_after = count_pits(terrain.graph, rank_heights(mesh).height, is_outlet);
  if (!arguments.out.empty()) write_ply(arguments.out, mesh.vertex, mesh.triangle, mesh.crs_wkt);
  talk(terrain, removal, options.method);
  if (arguments.json)
    print_json(arguments, mesh, result, removal);
  else
    print_table(arguments, mesh, result, removal);
  return 0;
}

}  // namespace

void add_fill_command(CLI::App& program, Action& action) {
  auto arguments = std::make_shared<FillArguments>();
  CLI::App* command = program.add_subcommand("fill", "remove the pits of one TIN in memory");
  command->add_option("tin", arguments->tin, "PLY or OBJ")->required()->type_name("TIN");
  command
      ->add_option("--method", arguments->method,
                   "lift: raise only; breach, greedy-breach (Algorithm 6.1): lower only; least-change: both")
      ->capture_default_str();
  command
      ->add_option("--measure", arguments->measure,
                   "what is to be small: total or max displacement, count of vertices moved, or volume")
      ->capture_default_str();
  command
      ->add_option(
          "--outlets", arguments->outlets,
          "hull: water may leave at the rim; lowest: at the lowest vertex only; a CSV file: at the vertices in it "
          "(a header line, then one or two indices a line)")
      ->capture_default_str();
  command->add_option("--pits", arguments->pits, "remove only the pits of these vertices")
      ->delimiter(',')
      ->type_name("V,V,...");
  command->add_option("--out", arguments->out, "write the new TIN")->type_name("TIN.ply");
  command->add_flag("--json", arguments->json, "print JSON");
  command->callback([arguments, &action] { action = [arguments] { return fill(*arguments); }; });
}

}  // namespace hydrotin::app
