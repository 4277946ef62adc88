#include "report_thinning.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "thin_grid.h"

namespace hydrotin {
namespace {

double rms(const TriangleError& errors, std::uint64_t points) {
  return points == 0 ? 0 : std::sqrt(errors.squared.value() / static_cast<double>(points));
}

}  // namespace

std::optional<ThinningFigures> read_thinning(const RunContext& context) {
  if (!context.thins()) return std::nullopt;
  ThinningFigures out;
  for (std::uint32_t t = 0; t < context.plan.num_tiles(); ++t) {
    const store::Reader in(context.layout.unit(Phase::thin, t));
    out.removed += in.integer("removed");
    out.seeds += in.integer("seeds");
    out.inserted += in.integer("inserted");
    out.pruned += in.integer("pruned");
    out.conflicts += in.integer("conflicts");
    out.settled += in.integer("settled");
    out.errors.add(read_removed_figures(store::Reader(context.layout.unit(Phase::verify, t))));
  }
  out.kept = static_cast<std::int64_t>(context.outline.vertices);
  const Lattice& l = context.plan.lattice;
  out.cell = thinning_options(context).cell * l.scale_xy;
  if (const auto limit = guaranteed_error(context))
    out.guarantee = static_cast<double>(limit->millionths) * 1e-6 * l.scale_z;
  return out;
}

nlohmann::json to_json(const RunContext& context, const ThinningFigures& f) {
  const double unit = context.plan.lattice.scale_z;
  const auto all = static_cast<double>(std::max<std::int64_t>(f.kept + f.removed, 1));
  const std::uint64_t points = f.errors.points;
  nlohmann::json out = {
      {"vertical_error_m", *context.options.thin.vertical_error_m},
      {"cell", f.cell},
      {"kept", f.kept},
      {"removed", f.removed},
      {"kept_percent", 100 * static_cast<double>(f.kept) / all},
      {"seeds", f.seeds},
      {"inserted", f.inserted},
      {"pruned", f.pruned},
      {"settled", f.settled},
      {"places_with_two_heights", f.conflicts},
      {"guaranteed_m", nullptr},
      {"max_error_m", f.errors.measured.largest * unit},
      {"rms_error_m", rms(f.errors.measured, points) * unit},
      {"beyond_guarantee", f.errors.beyond},
      {"not_in_one_triangle", f.errors.not_once},
      {"after_edits_of_heights",
       {{"max_error_m", f.errors.final.largest * unit}, {"rms_error_m", rms(f.errors.final, points) * unit}}}};
  if (f.guarantee) out["guaranteed_m"] = *f.guarantee;
  return out;
}

void write_text(const RunContext& context, const ThinningFigures& f, std::ostream& out) {
  const double unit = context.plan.lattice.scale_z;
  const auto row = [&](const std::string& label, const auto& value) {
    out << label << std::string(label.size() < 28 ? 28 - label.size() : 1, ' ') << value << '\n';
  };
  const auto metres = [](double v) {
    char text[40];
    std::snprintf(text, sizeof text, "%.6g m", v);
    return std::string(text);
  };
  const auto all = static_cast<double>(std::max<std::int64_t>(f.kept + f.removed, 1));
  char share[40];
  std::snprintf(share, sizeof share, " (%.2f %%)", 100 * static_cast<double>(f.kept) / all);
  out << "\nThinning\n";
  row("  points kept", std::to_string(f.kept) + share);
  row("  points removed", f.removed);
  row("  side of a cell", metres(f.cell));
  row("  seeds", f.seeds);
  row("  inserted", f.inserted);
  row("  where blocks meet", f.settled);
  row("  pruned", f.pruned);
  row("  places with two heights", f.conflicts);
  row("  limit", metres(*context.options.thin.vertical_error_m));
  row("  guaranteed in the TIN", f.guarantee ? metres(*f.guarantee) : "nothing: see triangulation.reference");
  row("  largest error", metres(f.errors.measured.largest * unit));
  row("  root mean square error", metres(rms(f.errors.measured, f.errors.points) * unit));
  row("  points beyond", f.errors.beyond);
  row("  largest after height edits", metres(f.errors.final.largest * unit));
  row("  rms after height edits", metres(rms(f.errors.final, f.errors.points) * unit));
}

std::vector<std::string> problems_of(const ThinningFigures& f) {
  std::vector<std::string> out;
  if (f.errors.beyond > 0)
    out.push_back(std::to_string(f.errors.beyond) + " points removed are farther from the TIN than guaranteed");
  if (f.errors.not_once > 0)
    out.push_back(std::to_string(f.errors.not_once) + " points removed do not lie in exactly one triangle");
  if (f.errors.points != static_cast<std::uint64_t>(f.removed))
    out.push_back(std::to_string(f.removed) + " points were removed but " + std::to_string(f.errors.points) +
                  " are stored");
  return out;
}

void write_to_index(const RunContext& context, const ThinningFigures& f, store::Writer& index) {
  index.set("removed", f.removed);
  index.set("removed_max_error", f.errors.measured.largest);
  const auto limit = guaranteed_error(context);
  index.set("removed_limit_millionths", limit ? limit->millionths : std::int64_t{-1});
}

}  // namespace hydrotin
