#include "declines.h"

#include <algorithm>
#include <cmath>

namespace hydrotin {

Declines find_declines(const RiverTerrain& terrain, std::span<const RiverEdge> rivers,
                       const RiverConstraints& constraints) {
  Declines out;
  out.drop.assign(rivers.size(), 0.0);
  if (constraints.decline_measure == DeclineMeasure::none) return out;
  RiverNetworks networks;
  const bool is_fraction = constraints.decline_measure == DeclineMeasure::fraction;
  if (is_fraction) {
    networks = connect_networks(terrain, rivers);
    for (std::uint32_t i = 0; i < networks.num_networks; ++i)
      if (!(networks.drop[i] > 0)) out.clamped.push_back(i);
  }
  for (std::size_t e = 0; e < rivers.size(); ++e) {
    const auto &from = terrain.position[rivers[e].from], &to = terrain.position[rivers[e].to];
    const double slope = is_fraction ? constraints.decline * std::max(0.0, networks.average_slope(networks.network[e]))
                                     : constraints.decline;
    out.drop[e] = slope * std::hypot(to[0] - from[0], to[1] - from[1]);
  }
  return out;
}

}  // namespace hydrotin
