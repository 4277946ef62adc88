#include "embedded_rivers.h"

#include <algorithm>

#include "store_arrays.h"

namespace hydrotin {

using store::contradicts;

std::shared_ptr<const EmbeddedRivers> load_embedded_rivers(const RunContext& context) {
  auto out = std::make_shared<EmbeddedRivers>();
  out->network = read_network(context);
  const store::Reader in(context.layout.unit(Phase::unite, 0));
  out->solution = read_solutions(in);
  const RiverNetwork& n = out->network;
  std::vector<std::uint8_t> is_solved(n.river.size(), 0);
  for (const GroupSolution& s : out->solution)
    for (const EmbeddedEdge& e : s.edge) {
      if (e.edge >= is_solved.size() || is_solved[e.edge] != 0) contradicts(in.path());
      is_solved[e.edge] = 1;
    }
  if (std::find(is_solved.begin(), is_solved.end(), 0) != is_solved.end()) contradicts(in.path());
  for (const GroupSolution& s : out->solution) {
    for (const MovedVertex& v : s.moved) out->moved.emplace_back(v.point, v.after);
    for (const auto& [point, height] : s.floor) out->bound[point].lower = height;
    for (const BrokenPlace& place : s.broken) {
      if (place.is_strict_part) continue;
      if (place.kind == RowKind::flow) out->contradicted.emplace_back(place.point[0], place.point[1]);
      if (place.kind == RowKind::valley) out->contradicted.emplace_back(place.point[1], place.point[2]);
    }
  }
  std::sort(out->moved.begin(), out->moved.end());
  std::sort(out->contradicted.begin(), out->contradicted.end());
  out->contradicted.erase(std::unique(out->contradicted.begin(), out->contradicted.end()), out->contradicted.end());
  for (const auto* edges : {&n.river, &n.chain})
    for (const auto& [from, to] : *edges)
      for (const std::uint32_t v : {from, to}) out->bound[n.point[v]].is_way = true;
  for (const Lake& lake : n.lake)
    for (const std::uint32_t v : lake.vertex) out->bound[n.point[v]].is_way = true;
  for (const std::uint32_t v : n.outlet) out->outlet.push_back(n.point[v]);
  std::sort(out->outlet.begin(), out->outlet.end());
  for (const auto& [from, to] : n.river) out->edge.emplace_back(n.point[from], n.point[to]);
  std::sort(out->edge.begin(), out->edge.end());
  const auto twice = [](const auto& a, const auto& b) { return a.first == b.first; };
  if (std::adjacent_find(out->moved.begin(), out->moved.end(), twice) != out->moved.end()) contradicts(in.path());
  return out;
}

}  // namespace hydrotin
