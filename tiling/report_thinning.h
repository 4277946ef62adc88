#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "phases.h"
#include "removed_errors.h"

/// What the report says of thinning.

namespace hydrotin {

/// Added up over all tiles; the same for every tiling.
struct ThinningFigures {
  std::int64_t removed = 0, kept = 0, seeds = 0, inserted = 0, pruned = 0, settled = 0, conflicts = 0;
  double cell = 0;                  ///< in the unit of the CRS
  std::optional<double> guarantee;  ///< no point removed is farther from the TIN before edits of heights
  RemovedFigures errors;
};

/// Nothing where points are not thinned. Fails: Error(storage).
[[nodiscard]] std::optional<ThinningFigures> read_thinning(const RunContext& context);

[[nodiscard]] nlohmann::json to_json(const RunContext& context, const ThinningFigures& figures);
void write_text(const RunContext& context, const ThinningFigures& figures, std::ostream& out);
[[nodiscard]] std::vector<std::string> problems_of(const ThinningFigures& figures);

/// Attributes of the index by which `check` verifies the guarantee.
void write_to_index(const RunContext& context, const ThinningFigures& figures, store::Writer& index);

}  // namespace hydrotin
