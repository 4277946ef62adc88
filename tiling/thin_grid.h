#pragma once

#include <optional>

#include "hydrotin/thinning.h"
#include "hydrotin/vertical_error.h"
#include "phases.h"

/// The limit and the grid of a run's thinning on its lattice.

namespace hydrotin {

/// Without thin.cell_m the cells are eight mean spacings wide: of all points over the area of their hull, which is the
/// same for every tiling. Precondition: the survey is loaded.
/// Fails: Error(config) if limit or cells are too large for the lattice.
[[nodiscard]] ThinningOptions thinning_options(const RunContext& context);

/// In squared lattice units.
[[nodiscard]] double hull_area(const Outline& outline);

/// What no point removed may exceed in the TIN before its heights are edited: the limit on reference points if they are
/// those and it is no stricter than that of thinning, which is kept by all Delaunay triangles; that of thinning for
/// Delaunay triangulations; else nothing.
[[nodiscard]] std::optional<ErrorLimit> guaranteed_error(const RunContext& context);

}  // namespace hydrotin
