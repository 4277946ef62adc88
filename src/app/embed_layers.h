#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "embed_input.h"
#include "hydrotin/river_embedding.h"
#include "hydrotin/river_profiles.h"

namespace hydrotin::app {

/// River edges as rivers: by the name of their line, or their network where there is none.
struct NamedRivers {
  std::vector<std::uint32_t> river;  ///< [R]
  std::vector<std::string> name;     ///< [rivers] longest first
  std::vector<RiverRow> row;         ///< [rivers]
};

[[nodiscard]] NamedRivers name_rivers(const EmbedInput& input, const std::vector<double>& after, double tolerance);

/// Layers: river_edges, moved_vertices, binding_limits, largest_changes, contradictions; with outlet chains mouths and
/// outlet_chains; with lines lines and lines_that_rise.
/// Fails: Error(storage).
void write_layers(const std::string& path, const EmbedInput& input, const EmbeddingOptions& options,
                  const Embedding& embedding, const std::vector<double>& after, const NamedRivers& rivers,
                  double tolerance);

/// River vertices as points: LAS if the name ends so, else GeoPackage. Fails: Error(storage).
void write_river_points(const std::string& path, const EmbedInput& input, const std::vector<double>& after);

}  // namespace hydrotin::app
