#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "embedded_rivers.h"
#include "hydrotin/vector.h"
#include "phases.h"

/// What the report says of rivers, and their layers.

namespace hydrotin {

struct RiverFigures {
  using Edges = std::vector<std::pair<std::uint64_t, std::uint64_t>>;
  Edges invalid, no_valley;                            ///< river edges in the final heights, ascending
  std::unordered_map<std::uint64_t, double> steepest;  ///< way down in the final heights, of river vertices by point
  std::uint64_t slopes_beyond_limit = 0;               ///< edges that pit removal changed beyond the limit
  std::uint64_t edges = 0, chain_edges = 0, lakes = 0, groups = 0, solved_together = 0;
  std::unordered_map<std::uint64_t, std::int32_t> height;  ///< final, of river vertices by point; lattice
  std::uint64_t raised = 0;                                ///< river vertices that the step against pits moved
  std::uint64_t unexpected = 0;                            ///< invalid ones that no contradiction explains
  std::uint64_t moved = 0, rows = 0, columns = 0, broken = 0, clamped = 0;
  double total = 0, largest = 0, bound = 0;  ///< change of heights, in their unit
  bool optimal = true;
  RiverNames names;
  std::vector<RiverRow> row;         ///< [rivers] states after: in the end; vertices moved, and how far: by the rivers
  std::vector<std::uint32_t> order;  ///< rivers, longest first
};

/// Precondition: the context has rivers.
[[nodiscard]] RiverFigures collect_river_figures(const RunContext& context);

/// Heights of listed vertices: as the rivers left them; and in the end, where that is known (rivers), else the same.
[[nodiscard]] std::int32_t embedded_height(const EmbeddedRivers& rivers, std::uint32_t v);
[[nodiscard]] std::int32_t final_height(const EmbeddedRivers& rivers, const RiverFigures& figures, std::uint32_t v);

/// [tiles] Vertices on rims without a lower neighbour in any part, by the tile that owns them, before the rivers.
[[nodiscard]] std::vector<std::uint64_t> laid_rim_minima(const RunContext& context);

/// terrain/rivers.h5: what files of tiles do not tell.
void write_river_store(const RunContext& context);
void write_to_index(const RunContext& context, const RiverFigures& figures, store::Writer& out);

[[nodiscard]] std::string rivers_json(const RunContext& context, const RiverFigures& figures);
void write_text(const RunContext& context, const RiverFigures& figures, std::ostream& out);

/// Longitudinal profiles of the longest rivers, in a folder that holds no others afterwards. Returns their paths.
std::vector<std::string> write_river_profiles(const RunContext& context, const RiverFigures& figures);

/// The file of river vertices, if one is asked for.
void write_river_points(const RunContext& context, const RiverFigures& figures);

/// The layers of river_layers.h: all of them.
void write_river_layers(const RunContext& context, const RiverFigures& figures, GeoPackageWriter& out);

}  // namespace hydrotin
