#include <algorithm>
#include <map>
#include <vector>

#include "point_set_polygons.h"

namespace hydrotin {

void repair_minima(const PointSetGround& ground, PointSetPolygons& polygons) {
  std::map<std::uint32_t, std::vector<VertexId>> offers;  // by polygon
  for (const VertexId v : polygons.unserved()) {
    const std::uint32_t own = ground.subdivision.polygon[ground.assignment.where[v.value].value];
    for (std::uint32_t i = ground.links.begin[v.value]; i < ground.links.begin[v.value + 1]; ++i) {
      const HalfedgeId spoke = ground.links.spoke[i];
      if (spoke.is_none()) continue;
      const std::uint32_t f = ground.subdivision.polygon[triangle_of(spoke).value];
      if (f == own) continue;
      auto& list = offers[f];
      if (list.empty() || list.back() != v) list.push_back(v);
    }
  }
  for (auto& [f, vertices] : offers) {
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    polygons.adopt(f, vertices);
  }
}

}  // namespace hydrotin
