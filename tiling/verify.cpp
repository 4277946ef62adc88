#include "phases.h"
#include "removed_errors.h"
#include "thin_grid.h"

namespace hydrotin {

void verify_tile(const RunContext& context, std::uint32_t tile) {
  const auto open = [&](std::uint32_t t) { return store::Reader(context.layout.unit(Phase::finish, t)); };
  const RemovedFigures figures = measure_removed(tile, open, context.parts(), guaranteed_error(context));
  store::Writer out(context.layout.unit(Phase::verify, tile));
  out.set("recipe", context.recipe(Phase::verify));
  write_removed_figures(out, figures);
  out.commit();
}

}  // namespace hydrotin
