#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "fill_terrain.h"
#include "hydrotin/edit_features.h"
#include "hydrotin/pit_hierarchy.h"
#include "hydrotin/pit_removal.h"

namespace hydrotin::app {

/// The pits of a terrain and which of them stay.
struct ChosenPits {
  std::vector<PitBasin> pit;
  std::vector<std::uint8_t> is_kept;  ///< [p]
};

/// The edits as features of a map. Precondition: the terrain has a lattice.
struct FillEdits {
  RegionFeatures lifted;
  BreachFeatures breaches;
};
[[nodiscard]] FillEdits find_fill_edits(const FillTerrain& terrain, const ChangeableTerrain& changeable,
                                        const Removal& removal);

/// Layers pits, lifted and breaches. Fails: Error(storage).
void write_fill_layers(const std::string& path, const std::string& crs_wkt, const FillTerrain& terrain,
                       const ChosenPits& pits, const FillEdits& edits, ChangeMeasure measure);

/// The pits as CSV. Fails: Error(storage).
void write_pit_table(const std::string& path, const FillTerrain& terrain, const ChosenPits& pits);

/// New minus old heights in cells whose centres lie in triangles that moved; no value elsewhere.
/// @param cell, max_edge  in units of the mesh; max_edge 0: no limit.
/// Fails: Error(storage), Error(config) for more cells than a raster may have.
void write_change_raster(const std::string& path, const std::string& crs_wkt, const FillTerrain& terrain,
                         std::span<const std::int32_t> height, double cell, double max_edge);

}  // namespace hydrotin::app
