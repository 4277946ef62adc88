#include "part.h"
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
  out.commit();
}

}  // namespace hydrotin
