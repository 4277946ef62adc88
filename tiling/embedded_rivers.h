#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "river_network_store.h"
#include "river_solution_store.h"

/// What the rivers have made of the terrain, for the phases after `unite`.
///
/// Memory  Grows with the rivers only. Errors  Error(storage) naming the file.

namespace hydrotin {

/// What the step against pits has to leave alone.
struct RiverBound {
  bool is_way = false;  ///< of a river, a chain or a lake: it may rise with the water only
  std::int32_t lower = std::numeric_limits<std::int32_t>::min();  ///< a valley needs it at least so high
};

/// All that later phases need.
struct EmbeddedRivers {
  std::unordered_map<std::uint64_t, RiverBound> bound;  ///< by point
  RiverNetwork network;
  std::vector<GroupSolution> solution;                                ///< without `near`
  std::vector<std::pair<std::uint64_t, std::int32_t>> moved;          ///< ascending by point, heights that differ
  std::vector<std::uint64_t> outlet;                                  ///< ascending, besides those of the policy
  std::vector<std::pair<std::uint64_t, std::uint64_t>> edge;          ///< river edges, ascending: from, to
  std::vector<std::pair<std::uint64_t, std::uint64_t>> contradicted;  ///< of them: no heights make them valid
};

[[nodiscard]] std::shared_ptr<const EmbeddedRivers> load_embedded_rivers(const RunContext& context);

}  // namespace hydrotin
