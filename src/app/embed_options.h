#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hydrotin/river_embedding.h"

namespace CLI {
class App;
}

/// What `embed` may be told, as text and checked.
namespace hydrotin::app {

struct EmbedArguments {
  std::string tin, river_edges, rivers, lakes, out;
  std::string variant = "VFRS", decline = "10%", slope_limit = "50%", contiguous, method = "lp";
  std::string crs, rivers_crs;                      ///< of the TIN; of lines and lakes that name none
  std::string match = "snap";                       ///< or insert
  std::string direction = "auto", direction_field;  ///< digitised, reversed, auto, attribute
  std::vector<std::string> reversed_values{"-1", "reversed", "upstream", "against"};
  std::string river_name;                             ///< attribute that names rivers
  std::string outlets;                                ///< hull, lowest or a file; empty: chains for lines only
  std::string fill;                                   ///< lift, least-change; empty: not
  std::string lake_level;                             ///< attribute with the level of a lake
  std::string preserve_edges, preserve = "drainage";  ///< file of edges; drainage, curvature, both
  std::string triangle_slope_limit = "50%";
  std::string layers, profiles, points_out;
  int workers = 0;                        ///< threads; 0: all cores
  std::uint32_t triangle_directions = 0;  ///< limited in so many directions; 0: not
  double side_slope = 0, max_change = 0, quantum = 0, time_limit = 0;
  bool no_flow = false, no_valley = false, river_only = false, json = false, use_z = false;

  /// Mouths inside the terrain get outlet chains.
  [[nodiscard]] bool wants_chains() const { return !rivers.empty() || !outlets.empty() || !fill.empty(); }
};

void add_embed_options(CLI::App& command, EmbedArguments& arguments);

/// Fails: Error(config) naming the option.
[[nodiscard]] EmbeddingOptions embedding_options(const EmbedArguments& arguments);

}  // namespace hydrotin::app
