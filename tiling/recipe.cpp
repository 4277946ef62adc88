#include "recipe.h"

#include <bit>
#include <cstdio>

namespace hydrotin {

RecipeHash& RecipeHash::add(const std::string& text) {
  const auto mix = [&](unsigned char byte) { state_ = (state_ ^ byte) * 0x100000001b3ULL; };
  for (const char c : text) mix(static_cast<unsigned char>(c));
  mix(0xff);  // keeps "ab","c" apart from "a","bc"
  return *this;
}

RecipeHash& RecipeHash::add(double value) {
  return add(static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(value)));
}

std::string RecipeHash::hex() const {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(state_));
  return text;
}

namespace {

void add_rivers(const RiverOptions& rivers, RecipeHash& hash) {
  const RiverConstraints& c = rivers.constraints;
  hash.add(std::int64_t{rivers.matching.insert})
      .add(static_cast<std::int64_t>(rivers.matching.direction))
      .add(std::int64_t{rivers.use_z})
      .add(rivers.name_field)
      .add(std::int64_t{c.flow})
      .add(std::int64_t{c.valley})
      .add(static_cast<std::int64_t>(c.decline_measure))
      .add(c.decline)
      .add(c.side_slope)
      .add(std::int64_t{c.limit_edge_slope})
      .add(c.edge_slope_change)
      .add(static_cast<std::int64_t>(c.directions.size()))
      .add(c.triangle_slope_change)
      .add(static_cast<std::int64_t>(c.contiguity))
      .add(std::int64_t{c.imaginary_points})
      .add(std::int64_t{c.river_only})
      .add(static_cast<std::int64_t>(rivers.method))
      .add(rivers.time_limit)
      .add(std::int64_t{rivers.preserve_drainage})
      .add(std::int64_t{rivers.preserve_curvature})
      .add(c.max_change);
}

}  // namespace

std::string recipe(const std::string& plan_recipe, const PipelineOptions& options, Phase phase) {
  constexpr std::int64_t kFormat = 11;
  RecipeHash hash;
  hash.add(kFormat).add(plan_recipe).add(std::string(name(phase)));
  if (phase >= Phase::thin && options.thin.vertical_error_m)
    hash.add(*options.thin.vertical_error_m)
        .add(options.thin.cell_m.value_or(-1))
        .add(std::int64_t{options.thin.prune})
        .add(std::int64_t{options.triangulation.removed_reference});
  if (phase >= Phase::triangulate)
    hash.add(std::int64_t{options.triangulation.order}).add(name(options.triangulation.objectives));
  if (phase >= Phase::triangulate) hash.add(options.triangulation.max_error_m.value_or(-1));
  const PolygonBudget& budget = options.triangulation.budget;
  if (phase >= Phase::triangulate)
    for (const std::uint32_t most : {budget.max_triangles, budget.max_ways, budget.max_program, budget.max_branches})
      hash.add(std::int64_t{most});
  const PitOptions& pits = options.pits;
  if (options.rivers.are_given() && phase >= Phase::lay) add_rivers(options.rivers, hash);
  if (phase >= (options.rivers.are_given() ? Phase::lay : Phase::nest))
    hash.add(static_cast<std::int64_t>(pits.outlets))
        .add(pits.outlet_layer)
        .add(std::int64_t{pits.voids_drain})
        .add(pits.voids_drain ? pits.void_edge_m : 0)
        .add(std::int64_t{pits.cheapest.has_value()});  // asks for prices
  if (phase >= Phase::choose) {
    hash.add(pits.keep.deeper_than_m.value_or(-1))
        .add(pits.keep.larger_than_m2.value_or(-1))
        .add(pits.keep.volume_above_m3.value_or(-1))
        .add(pits.keep.inside)
        .add(std::int64_t{pits.keep.all_conditions})
        .add(std::int64_t{pits.method == PitMethod::none})
        .add(static_cast<std::int64_t>(pits.cheapest.value_or(0)));
    for (const std::uint64_t id : pits.keep.ids) hash.add(static_cast<std::int64_t>(id));
  }
  if (phase >= Phase::pools)
    hash.add(static_cast<std::int64_t>(pits.method))
        .add(static_cast<std::int64_t>(pits.measure))
        .add(pits.max_breach_length_m.value_or(-1))
        .add(pits.max_breach_depth_m.value_or(-1))
        .add(static_cast<std::int64_t>(pits.largest_lake))
        .add(static_cast<std::int64_t>(pits.largest_group));
  if (phase >= Phase::finish) hash.add(std::int64_t{options.output.mesh_ply});
  if (phase >= Phase::raster)
    hash.add(std::int64_t{options.output.dem.enabled})
        .add(options.output.dem.cell_m)
        .add(options.output.dem.max_edge_m)
        .add(std::int64_t{options.output.dem.cog})
        .add(std::int64_t{options.output.dem.hillshade})
        .add(std::int64_t{options.output.dem.change});
  if (phase >= Phase::report && options.rivers.are_given())
    hash.add(static_cast<std::int64_t>(options.rivers.points_out));
  return hash.hex();
}

}  // namespace hydrotin
