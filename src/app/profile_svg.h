#pragma once

#include <string>
#include <vector>

#include "embed_layers.h"

namespace hydrotin::app {

/// Longitudinal profiles of rivers, before and after: DIR/NN-name.svg for each of the longest ones, heights over the
/// way from the source of the main stem to its mouth. The folder is made if need be. Returns the paths.
/// Fails: Error(storage).
std::vector<std::string> write_profiles(const std::string& folder, const EmbedInput& input,
                                        const std::vector<double>& after, const NamedRivers& rivers,
                                        std::size_t most = 40);

}  // namespace hydrotin::app
