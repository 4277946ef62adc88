#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "block_index.h"
#include "hydrotin/convex_hull.h"
#include "hydrotin/hilbert.h"
#include "hydrotin/lifting.h"
#include "phases.h"
#include "polygon_figures.h"
#include "store.h"
#include "thin_grid.h"
#include "thin_window.h"

namespace hydrotin {
namespace {

// A tile's points, those kept and those removed, each along the curve.
struct Shares {
  TilePoints kept, removed;
  std::int64_t seeds = 0, inserted = 0, pruned = 0, settled = 0;
};

void require_settled(const ThinWindow& around, const Thinning& thinning, const RunContext& context) {
  for (const std::uint32_t i : thinning.unsettled) {
    if (i >= around.num_own()) continue;
    const Lattice& l = context.plan.lattice;
    const LatticePoint p = around.position()[i];
    throw Error(ErrorKind::resource, "thin.vertical_error_m: around (" + std::to_string(l.x(p.x)) + ", " +
                                         std::to_string(l.y(p.y)) + ") points are beyond the limit after " +
                                         std::to_string(kSettlingRounds) + " rounds; lower thin.cell_m");
  }
}

Shares share_points(const ThinWindow& around, const Thinning& thinning) {
  Shares out;
  for (std::uint32_t i = 0; i < around.num_own(); ++i) {
    const PointFate fate = thinning.fate[i];
    TilePoints& to = is_kept(fate) ? out.kept : out.removed;
    to.position.push_back(around.position()[i]);
    to.height.push_back(around.height()[i]);
    out.seeds += fate == PointFate::seed;
    out.inserted += fate == PointFate::inserted;
    out.pruned += fate == PointFate::pruned;
    out.settled += fate == PointFate::settled;
  }
  return out;
}

// Reference points from files, with those removed if they are wanted too.
void write_reference(const RunContext& context, const store::Reader& arranged, const TilePoints& removed,
                     store::Writer& out) {
  if (!context.plan.has_reference()) return;
  TilePoints all = read_points(arranged, 0, arranged.size(std::string(kReference) + "x"), kReference);
  if (context.options.triangulation.removed_reference) {
    all.position.insert(all.position.end(), removed.position.begin(), removed.position.end());
    all.height.insert(all.height.end(), removed.height.begin(), removed.height.end());
    std::vector<std::tuple<std::uint64_t, std::int32_t, std::uint32_t>> order;
    for (std::uint32_t i = 0; i < all.height.size(); ++i)
      order.emplace_back(hilbert_key(all.position[i]), all.height[i], i);
    std::sort(order.begin(), order.end());
    TilePoints sorted;
    for (const auto& [key, z, i] : order) {
      sorted.position.push_back(all.position[i]);
      sorted.height.push_back(z);
    }
    all = std::move(sorted);
  }
  write_points(out, all.position, all.height, kReference);
}

// Points that another one at their place hides, farther above it than the limit: no surface passes both within it.
std::int64_t count_conflicts(const store::Reader& arranged, std::int64_t limit_millionths) {
  const auto rise = arranged.read<std::uint32_t>("duplicate_rise");
  return std::count_if(rise.begin(), rise.end(), [&](std::uint32_t dz) {
    return dz > limit_millionths / 1'000'000;  // whole units: exact
  });
}

std::int64_t limit_in_millionths(const RunContext& context) {
  const double limit = *context.options.thin.vertical_error_m;
  const double millionths = std::round(limit / context.plan.lattice.scale_z * 1e6);
  if (!(millionths < 2e15))
    throw Error(ErrorKind::config, "thin.vertical_error_m: " + std::to_string(limit) +
                                       " is more than the heights of the lattice span; give a smaller limit");
  return static_cast<std::int64_t>(millionths);
}

}  // namespace

ThinningOptions thinning_options(const RunContext& context) {
  const ThinOptions& thin = context.options.thin;
  const Lattice& l = context.plan.lattice;
  double side = thin.cell_m ? *thin.cell_m / context.plan.metres_per_unit / l.scale_xy : 0;
  if (!thin.cell_m) {
    constexpr double kSpacings = 8;
    side = kSpacings * std::sqrt(hull_area(context.survey) / static_cast<double>(context.survey.vertices));
  }
  if (!(side < 0x1p28))
    throw Error(ErrorKind::config, "thin.cell_m: the cells are too large for the lattice; give a smaller one");
  ThinningOptions out;
  out.limit_millionths = limit_in_millionths(context);
  out.set_grid(l, side);
  out.prune = thin.prune;
  return out;
}

std::optional<ErrorLimit> guaranteed_error(const RunContext& context) {
  // With other reference points, or a stricter limit, there may be polygons in which it cannot be kept.
  const auto limit = polygon_options(context).max_error;
  if (context.options.triangulation.removed_reference && !context.plan.has_reference() && limit &&
      limit->millionths >= limit_in_millionths(context))
    return limit;
  const Objectives& objectives = context.options.triangulation.objectives;
  const bool is_delaunay = context.options.triangulation.order == 0 || objectives == Objectives{Objective::delaunay};
  if (is_delaunay) return ErrorLimit{limit_in_millionths(context)};
  return std::nullopt;
}

double hull_area(const Outline& outline) {
  double twice = 0;
  const LatticePoint o = outline.hull.front().position;
  for (std::size_t i = 0; i < outline.hull.size(); ++i) {
    const LatticePoint a = outline.hull[i].position, b = outline.hull[(i + 1) % outline.hull.size()].position;
    const auto x = [&](LatticePoint p) { return static_cast<double>(p.x) - o.x; };
    const auto y = [&](LatticePoint p) { return static_cast<double>(p.y) - o.y; };
    twice += x(a) * y(b) - x(b) * y(a);
  }
  return twice / 2;
}

void thin_tile(const RunContext& context, std::uint32_t tile) {
  const ThinningOptions options = thinning_options(context);
  const store::Reader arranged(context.layout.unit(Phase::arrange, tile));
  ThinWindow around(context, tile, options);
  Shares shares;
  std::int64_t windows = 0;
  if (around.num_own() > 0) {
    Thinning thinning;
    do {
      ++windows;
      thinning = around.thin();
    } while (around.widen(thinning.doubtful));
    require_settled(around, thinning, context);
    shares = share_points(around, thinning);
  }
  store::Writer out(context.layout.unit(Phase::thin, tile));
  out.set("recipe", context.recipe(Phase::thin));
  out.set("points", arranged.integer("points"));
  const TilePoints& kept = shares.kept;
  write_points(out, kept.position, kept.height);
  out.append("hull", convex_hull(kept.position), "indices of the tile's convex hull");
  if (!kept.position.empty()) out.set("lowest", static_cast<std::int64_t>(lowest_vertex(kept.height, kept.position)));
  write_points(out, shares.removed.position, shares.removed.height, kRemoved);
  write_reference(context, arranged, shares.removed, out);
  out.set("removed", static_cast<std::int64_t>(shares.removed.height.size()));
  out.set("seeds", shares.seeds);
  out.set("inserted", shares.inserted);
  out.set("pruned", shares.pruned);
  out.set("settled", shares.settled);
  out.set("windows", windows);
  out.set("window_points", static_cast<std::int64_t>(around.position().size()));
  out.set("conflicts", count_conflicts(arranged, options.limit_millionths));
  out.commit();
}

}  // namespace hydrotin
