#include <algorithm>

#include "hydrotin/lifting.h"
#include "kept_pits.h"
#include "part.h"
#include "part_value.h"
#include "phases.h"
#include "reduced_store.h"

namespace hydrotin {
void reduce_tile(const RunContext& context, std::uint32_t tile) {
  const Part part = load_part(context, tile);
  std::vector<std::uint8_t> is_outlet = outlet_flags(context, part);
  const std::vector<std::uint8_t> is_kept = kept_flags(context, tile, part);
  for (std::uint32_t v = 0; v < is_outlet.size(); ++v) is_outlet[v] |= is_kept[v];
  const std::vector<std::uint8_t> has_lower = has_lower_neighbor(part);
  std::int64_t inner_minima = 0;
  std::vector<std::uint64_t> foreign_minima;
  for (std::uint32_t v = 0; v < part.num_vertices(); ++v) {
    if (part.is_rim[v] || has_lower[v]) continue;
    ++inner_minima;
    if (v >= part.num_own) foreign_minima.push_back(part.point[v]);
  }
  std::vector<std::uint8_t> rim_has_lower, rim_outlet;
  std::vector<std::int32_t> rim_height;
  for (const std::uint32_t v : part.rim()) {
    rim_has_lower.push_back(has_lower[v]);
    rim_height.push_back(part.height[v]);
    rim_outlet.push_back(is_outlet[v] != 0);
  }

  store::Writer out(context.layout.unit(Phase::spill, tile));
  out.set("recipe", context.recipe(Phase::spill));
  Catchments catchments;
  write_tree(out, reduce_to_rim(part.graph, part.height, part.point, part.is_rim, is_outlet, &catchments));
  write_catchments(out, catchments, part.height);
  out.append("rim_height", rim_height, "z lattice, as measured");
  out.append("rim_has_lower", rim_has_lower, "1: a neighbour in this part is lower by (z, x, y)");
  out.append("rim_outlet", rim_outlet, "1: an outlet, as far as this part knows");
  std::int64_t lowest_outlet = kNoLevel;
  for (std::uint32_t v = 0; v < part.num_vertices(); ++v)
    if (is_outlet[v]) lowest_outlet = std::min<std::int64_t>(lowest_outlet, part.height[v]);
  out.set("lowest_outlet", lowest_outlet);
  write_plateaus(out, "",
                 summarize_plateaus(part.graph, part.height, part.position, is_outlet, part.point, part.is_rim));
  out.append("bounds", flatten(std::vector{part.bounds()}), "box of the triangles; min above max if there is none");
  out.set("inner_minima", inner_minima);
  out.append("foreign_minima", foreign_minima, "those of them that are points of other tiles");
  write_values(out, values_of(part, context.options.triangulation.objectives));
  out.set("vertices", static_cast<std::int64_t>(part.num_vertices()));
  out.set("triangles", static_cast<std::int64_t>(part.num_triangles()));
  out.commit();
}

}  // namespace hydrotin
