#include "part.h"
#include "part_value.h"
#include "phases.h"
#include "river_window.h"
#include "terrain_file.h"

namespace hydrotin {

void lay_tile(const RunContext& context, std::uint32_t tile) {
  const Part part = load_part(context, tile);
  std::vector<std::int32_t> xyz;
  xyz.reserve(3 * std::size_t{part.num_vertices()});
  for (std::uint32_t v = 0; v < part.num_vertices(); ++v)
    xyz.insert(xyz.end(), {part.position[v].x, part.position[v].y, part.height[v]});
  std::vector<LatticeBox> box((part.num_triangles() + kRunTriangles - 1) / kRunTriangles);
  for (std::size_t i = 0; i < part.triangle.size(); ++i)
    box[i / (std::size_t{3} * kRunTriangles)].extend(part.position[part.triangle[i]]);
  std::vector<std::uint32_t> hull;
  for (const DirectedEdge& e : part.hull_edge) hull.insert(hull.end(), {e.origin, e.target});
  store::Writer out(context.layout.unit(Phase::lay, tile));
  out.set("recipe", context.recipe(Phase::lay));
  out.append("point", part.point, "tile << 32 | index");
  out.append("xyz", xyz, "lattice; z as measured");
  out.append("outlet", outlet_flags(context, part), "1: water may leave, as far as this part knows");
  out.append("triangle", part.triangle, "vertices, counter-clockwise");
  out.append("triangle_box", flatten(box), "boxes of runs of 1024 triangles");
  out.append("hull_edge", hull, "vertices: origins and targets of edges on the convex hull");
  out.append("bounds", flatten(std::vector<LatticeBox>{part.bounds()}), "of all triangles");
  // Figures of the triangulation itself, before rivers change it.
  const std::vector<std::uint8_t> has_lower = has_lower_neighbor(part);
  std::int64_t inner_minima = 0;
  std::vector<std::uint64_t> foreign_minima, rim;
  std::vector<std::uint8_t> rim_has_lower;
  for (std::uint32_t v = 0; v < part.num_vertices(); ++v) {
    if (part.is_rim[v] || has_lower[v]) continue;
    ++inner_minima;
    if (v >= part.num_own) foreign_minima.push_back(part.point[v]);
  }
  for (const std::uint32_t v : part.rim()) {
    rim.push_back(part.point[v]);
    rim_has_lower.push_back(has_lower[v]);
  }
  out.set("inner_minima", inner_minima);
  out.append("foreign_minima", foreign_minima, "inner minima that are points of other tiles");
  out.append("rim", rim, "vertices that other parts have too, ascending");
  out.append("rim_has_lower", rim_has_lower, "1: a neighbour in this part is lower by (z, x, y)");
  write_values(out, values_of(part, context.options.triangulation.objectives));
  out.commit();
}

}  // namespace hydrotin
