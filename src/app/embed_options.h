#pragma once

#include <string>

#include "hydrotin/river_embedding.h"

namespace CLI {
class App;
}

/// What `embed` may be told, as text and checked.
namespace hydrotin::app {

struct EmbedArguments {
  std::string tin, river_edges, rivers, lakes, out;
  std::string variant = "VFRS", decline = "10%", slope_limit = "50%", contiguous, method = "lp";
  double side_slope = 0, max_change = 0, quantum = 0, time_limit = 0;
  bool no_flow = false, no_valley = false, river_only = false, json = false;
};

void add_embed_options(CLI::App& command, EmbedArguments& arguments);

/// Fails: Error(config) naming the option.
[[nodiscard]] EmbeddingOptions embedding_options(const EmbedArguments& arguments);

}  // namespace hydrotin::app
