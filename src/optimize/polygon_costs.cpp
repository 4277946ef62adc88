#include "polygon_costs.h"

namespace hydrotin {

void mark_served(const PolygonGraph& graph, const std::vector<std::uint32_t>& triangles,
                 std::vector<std::uint8_t>& served) {
  served.assign(graph.problem().position.size(), 0);
  for (const std::uint32_t number : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t e = graph.side(number, i);
      if (graph.edge(PolygonGraph::twin(e)).is_boundary) continue;
      served[graph.edge(e).goes_down ? graph.edge(e).origin : graph.edge(e).target] = 1;
    }
}

SlotValues value_of(const PolygonGraph& graph, const PolygonCosts& costs, const std::vector<std::uint32_t>& triangles) {
  SlotValues value{};
  for (const std::uint32_t t : triangles)
    for (int slot = 0; slot < costs.num_slots; ++slot) value[static_cast<std::size_t>(slot)] += costs.of(t, slot);
  if (costs.minima_slot >= 0) {
    std::vector<std::uint8_t> served;
    mark_served(graph, triangles, served);
    Wide& gain = value[static_cast<std::size_t>(costs.minima_slot)];
    for (std::size_t v = 0; v < served.size(); ++v)
      if (served[v]) gain -= PolygonCosts::kGain[graph.problem().wants_lower[v]];
  }
  return value;
}

}  // namespace hydrotin
