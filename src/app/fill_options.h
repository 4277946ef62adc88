#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hydrotin/options.h"

namespace CLI {
class App;
}

namespace hydrotin::app {

/// The command line of `fill`, as written.
struct FillArguments {
  std::string tin, method = "least-change", measure = "total", outlets = "hull", out, crs;
  std::string search = "auto", max_breach_length, max_breach_depth, void_edge, cheapest;
  std::string layers, table, change_raster;
  std::vector<std::string> keep;
  std::vector<std::uint32_t> pits;
  double cell = 1, max_edge = 100;
  bool voids_drain = false, json = false;

  /// Whether any result is asked for that takes the hierarchy of pits.
  [[nodiscard]] bool wants_pits() const { return !layers.empty() || !table.empty(); }
};

void add_fill_options(CLI::App& command, FillArguments& arguments);

/// The arguments as the options of a run: names, meanings and messages are those of the section `pits` of configs.
/// `outlets` is left at its default: see `find_outlets`.
/// Fails: Error(config).
[[nodiscard]] PitOptions pit_options(const FillArguments& arguments);

}  // namespace hydrotin::app
