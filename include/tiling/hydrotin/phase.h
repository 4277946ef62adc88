#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

/// The phases of a run in their order; each is a pure function over numbered work units.

namespace hydrotin {

enum class Phase : std::uint8_t {
  plan,         ///< 1 unit: check the inputs, cut the tiles
  ingest,       ///< a unit per input file: decode, filter, bucket by tile
  arrange,      ///< a unit per tile: merge, remove duplicates, sort along the curve
  survey,       ///< 1 unit if points are thinned, else none: boxes, counts and convex hull of all points
  thin,         ///< a unit per tile if points are thinned, else none: which points the TIN needs
  outline,      ///< 1 unit: boxes, counts and convex hull of all vertices
  triangulate,  ///< a unit per tile
  join,         ///< 1 unit: which border pieces form one polygon, and who solves it
  seam,         ///< a unit per tile: the polygons that cross tiles
  mend,         ///< 1 unit: polygons that save local minima which others left
  lay,          ///< a unit per tile if there are rivers, else none: its triangles, so that few of them can be read
  match,        ///< 1 unit if there are rivers, else none: lines become edges, mouths get their way out
  embed,        ///< a unit per tile if there are rivers, else none: heights for the networks it owns
  unite,        ///< 1 unit if there are rivers, else none: networks that touch each other, solved as one
  nest,         ///< a unit per tile: its pits, decided or reduced to a tree of pools
  rank,         ///< 1 unit: which pit overflows where into which other
  weigh,        ///< a unit per tile: what its shares of pools across tiles hold
  choose,       ///< 1 unit: the pit hierarchy, and which pits to keep
  spill,        ///< a unit per tile: its merge tree reduced to its rim
  drain,        ///< 1 unit: spill level of every rim vertex
  pools,        ///< a unit per tile: levels, lakes, and the breaches of those inside
  lakes,        ///< 1 unit: which lakes are one across tiles, and who breaches them
  breach,       ///< a unit per tile: breaches of lakes that cross tiles or look beyond one
  members,      ///< a unit per tile: the vertices that may move; groups of them inside the tile are solved
  groups,       ///< 1 unit: which groups are one across tiles, and who solves them
  settle,       ///< a unit per tile: groups that cross tiles
  finish,       ///< a unit per tile: final heights, mesh
  verify,       ///< a unit per tile if points are thinned, else none: errors of the points removed
  raster,       ///< a unit per tile: DEM
  report        ///< 1 unit: COG, hillshade, layers, figures
};

inline constexpr std::array<std::string_view, 30> kPhaseNames = {
    "plan",  "ingest", "arrange", "survey",  "thin",   "outline", "triangulate", "join",   "seam",   "mend",
    "lay",   "match",  "embed",   "unite",   "nest",   "rank",    "weigh",       "choose", "spill",  "drain",
    "pools", "lakes",  "breach",  "members", "groups", "settle",  "finish",      "verify", "raster", "report"};
inline constexpr std::size_t kNumPhases = kPhaseNames.size();

[[nodiscard]] constexpr std::string_view name(Phase phase) {
  return kPhaseNames[static_cast<std::size_t>(phase)];
}

[[nodiscard]] constexpr std::optional<Phase> phase_named(std::string_view text) {
  for (std::size_t i = 0; i < kNumPhases; ++i)
    if (kPhaseNames[i] == text) return static_cast<Phase>(i);
  return std::nullopt;
}

}  // namespace hydrotin
