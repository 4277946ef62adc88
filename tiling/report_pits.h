#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "edits_file.h"
#include "hydrotin/vector.h"
#include "hydrotin/wide.h"
#include "kept_pits.h"
#include "phases.h"

/// What the report says of pits, and the layers of their edits.

namespace hydrotin {

struct PitFigures {
  std::uint64_t before = 0, kept = 0, left = 0;
  ChangeFigures change;
  std::int64_t unbreached = 0, unfinished = 0, largest_group = 0, regions = 0, breaches = 0, undrawn = 0;
  std::int64_t cut = 0;      ///< groups that were cut
  std::int64_t deepest = 0;  ///< largest difference between level and height
  std::int64_t dearest = 0;  ///< cost of the dearest breach by itself
  Wide bound = 0;            ///< sum over all lakes, in shares (lake_bound.h)
};

[[nodiscard]] PitFigures collect_pit_figures(const RunContext& context);

/// Cost in the chosen measure, a proven bound on the cost of any way of the same method, and whether it is met.
struct PitVerdict {
  double cost = 0, bound = 0;
  bool optimal = false;
};
[[nodiscard]] PitVerdict judge_pits(const RunContext& context, const PitFigures& figures);

[[nodiscard]] std::string pits_json(const RunContext& context, const PitFigures& figures);
/// Labels and values for the text.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> pit_rows(const RunContext& context,
                                                                        const PitFigures& figures);

/// Layers `lifted` (polygons) and `breaches` (lines), features ascending by (x, y). Nothing for pits.method: none.
void write_edit_layers(const RunContext& context, GeoPackageWriter& out);

}  // namespace hydrotin
