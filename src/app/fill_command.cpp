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
#include "fill_options.h"
#include "fill_outputs.h"
#include "fill_terrain.h"
#include "hydrotin/crs.h"
#include "hydrotin/greedy_breach.h"
#include "hydrotin/lifting.h"
#include "hydrotin/mesh.h"
#include "hydrotin/pit_removal.h"
#include "hydrotin/pit_units.h"
#include "hydrotin/pits.h"
#include "hydrotin/place_layer.h"

namespace hydrotin::app {
namespace {

struct FillResult {
  std::uint64_t minima_before = 0, minima_after = 0, moved = 0, regions = 0, breaches = 0;
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
  nlohmann::ordered_json json = {{"vertices", mesh.vertex.size()},
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
  if (!arguments.layers.empty()) {
    json["lifted_regions"] = result.regions;
    json["breaches"] = result.breaches;
  }
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

/// The CRS of the TIN, and how long its unit is.
Crs crs_of(const FillArguments& arguments, const Mesh& mesh) {
  return arguments.crs.empty() ? crs_from_wkt(mesh.crs_wkt, arguments.tin) : parse_crs(arguments.crs, "--crs");
}

/// Which pits stay by --keep or --cheapest, or because --pits names others; and all of them if results list pits.
ChosenPits choose_pits(const FillArguments& arguments, const PitOptions& pits, const FillTerrain& terrain,
                       const Crs& crs, const std::vector<std::uint8_t>& is_outlet) {
  ChosenPits chosen;
  const bool chooses = pits.keep.any() || pits.cheapest;
  if (!chooses && !arguments.wants_pits()) return chosen;
  require_lattice(arguments.tin, terrain, chooses ? "a choice of pits" : "a list of pits");
  chosen.pit = pit_hierarchy(terrain.graph, terrain.triangle, terrain.height, terrain.position, is_outlet);
  if (pits.cheapest) {
    chosen.is_kept = keep_all_but_cheapest(chosen.pit, *pits.cheapest);
    return chosen;
  }
  std::vector<std::uint8_t> is_inside, is_listed;
  if (!pits.keep.ids.empty()) is_listed = listed_pits(pits.keep.ids, chosen.pit.size(), "--keep ids");
  if (!pits.keep.inside.empty()) {
    const PlaceLayer places(pits.keep.inside, terrain.lattice, crs.wkt, true);
    for (const PitBasin& pit : chosen.pit) is_inside.push_back(places.covers(pit.pit.representative));
  }
  chosen.is_kept =
      pits_to_keep(chosen.pit, keep_conditions(pits.keep, terrain.lattice, crs.metres_per_unit, is_inside, is_listed));
  return chosen;
}

/// Outlets, and the plateaus of all pits that stay.
std::vector<std::uint8_t> ends_of(const FillArguments& arguments, const FillTerrain& terrain,
                                  const std::vector<std::uint8_t>& is_outlet, ChosenPits& chosen) {
  if (arguments.pits.empty())
    return chosen.pit.empty()
               ? is_outlet
               : outlets_and_kept_pits(terrain.graph, terrain.height, is_outlet, chosen.pit, chosen.is_kept);
  auto ends = keep_other_pits(arguments.pits, terrain, is_outlet);
  for (std::size_t i = 0; i < chosen.pit.size(); ++i) chosen.is_kept[i] = ends[chosen.pit[i].pit.vertex];
  return ends;
}

/// Searches as far as the terrain is small; as far as `run` does if that is asked for.
RemovalOptions search_options(const FillArguments& arguments, const PitOptions& pits, const FillTerrain& terrain,
                              const Crs& crs, const std::vector<std::uint8_t>& ends) {
  RemovalOptions options = removal_options(pits, terrain.lattice, crs.metres_per_unit);
  options.with_bound = true;
  if (pits.max_breach_length_m) require_lattice(arguments.tin, terrain, "--max-breach-length");
  if (arguments.search == "scalable") return options;
  options.thorough =
      !pits.max_breach_length_m && is_small(count_pits(terrain.graph, terrain.height, ends), terrain.height.size());
  if (options.thorough) options.max_rounds = 6;
  return options;
}

void write_results(const FillArguments& arguments, const Mesh& mesh, const FillTerrain& terrain, const Crs& crs,
                   const ChosenPits& chosen, const ChangeableTerrain& changeable, const Removal& removal,
                   ChangeMeasure measure, FillResult& result) {
  if (!arguments.layers.empty()) {
    const FillEdits edits = find_fill_edits(terrain, changeable, removal);
    result.regions = edits.lifted.size();
    result.breaches = edits.breaches.size();
    write_fill_layers(arguments.layers, crs.wkt, terrain, chosen, edits, measure);
  }
  if (!arguments.table.empty()) write_pit_table(arguments.table, terrain, chosen);
  if (!arguments.change_raster.empty())
    write_change_raster(arguments.change_raster, crs.wkt, terrain, removal.height, arguments.cell / crs.metres_per_unit,
                        arguments.max_edge / crs.metres_per_unit);
  if (!arguments.out.empty()) write_ply(arguments.out, mesh.vertex, mesh.triangle, crs.wkt);
}

int fill(const FillArguments& arguments) {
  const PitOptions pits = pit_options(arguments);
  Mesh mesh = read_mesh(arguments.tin);
  const Crs crs = crs_of(arguments, mesh);
  const FillTerrain terrain = make_fill_terrain(arguments.tin, mesh);
  if (!arguments.layers.empty()) require_lattice(arguments.tin, terrain, "--layers");
  if (!arguments.change_raster.empty()) require_lattice(arguments.tin, terrain, "--change-raster");
  OutletChoice outlets{arguments.outlets, crs.wkt, {}};
  if (pits.voids_drain) outlets.void_edge = pits.void_edge_m / crs.metres_per_unit;
  const auto is_outlet = find_outlets(arguments.tin, outlets, terrain);
  ChosenPits chosen = choose_pits(arguments, pits, terrain, crs, is_outlet);
  const auto ends = ends_of(arguments, terrain, is_outlet, chosen);
  const RemovalOptions options = search_options(arguments, pits, terrain, crs, ends);
  ChangeableTerrain changeable{&terrain.graph, terrain.height, terrain.position, ends, {}, {}, {}};
  if (options.measure == ChangeMeasure::volume) changeable.weight = terrain.weight;
  const HeightBounds bounds = depth_bounds(terrain.height, options.limits.max_depth);
  changeable.lower = bounds.lower;
  changeable.upper = bounds.upper;
  const Removal removal = arguments.search == "scalable" ? remove_pits(changeable, options)
                                                         : remove_pits_by_best_search(changeable, options);
  const Mesh original = mesh;
  set_heights(mesh, terrain, removal, options.method, ends);
  FillResult result = compare(original, mesh, terrain, removal, options.measure);
  result.minima_before = count_pits(terrain.graph, rank_heights(original).height, is_outlet);
  result.minima_after = count_pits(terrain.graph, rank_heights(mesh).height, is_outlet);
  write_results(arguments, mesh, terrain, crs, chosen, changeable, removal, options.measure, result);
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
  add_fill_options(*command, *arguments);
  command->callback([arguments, &action] { action = [arguments] { return fill(*arguments); }; });
}

}  // namespace hydrotin::app
