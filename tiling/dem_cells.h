#pragma once

#include "phases.h"
#include "store.h"

/// Cells of rasters that have no height, as `ingest` counted them.

namespace hydrotin {

struct SkippedCells {
  std::uint64_t nodata = 0, not_finite = 0;
};

[[nodiscard]] inline SkippedCells skipped_cells(const RunContext& context) {
  SkippedCells out;
  for (std::uint32_t f = 0; f < context.plan.files.size(); ++f) {
    if (!context.plan.files[f].is_dem) continue;
    const store::Reader in(context.layout.unit(Phase::ingest, f));
    out.nodata += static_cast<std::uint64_t>(in.integer("cells_nodata"));
    out.not_finite += static_cast<std::uint64_t>(in.integer("cells_not_finite"));
  }
  return out;
}

}  // namespace hydrotin
