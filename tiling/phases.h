#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "block_index.h"
#include "breach_index.h"
#include "hydrotin/options.h"
#include "hydrotin/pipeline.h"
#include "ingest_index.h"
#include "layout.h"
#include "outline.h"
#include "part_bounds.h"
#include "pit_places.h"
#include "plan.h"
#include "recipe.h"

/// The phases: each function makes the output of one work unit from the outputs named in DESIGN's table, and nothing
/// else.
///
/// Threads  Units of one phase may run concurrently, in this process or elsewhere; a unit that runs twice at the same
///          time writes equal bytes.
/// Errors   Error; the unit's output is then absent.

namespace hydrotin {

struct RiverInput;
struct EmbeddedRivers;
/// Of all that matters in the files, for recipes.
[[nodiscard]] std::string hash_of(const RiverInput& input);

/// What every unit knows.
struct RunContext {
  PipelineOptions options;
  Layout layout;
  Plan plan;
  Outline outline{};  ///< from phase `outline` on
  Outline survey{};   ///< of all points, from phase `thin` on if points are thinned
  std::shared_ptr<IngestIndex> ingest_index = std::make_shared<IngestIndex>();  ///< filled by the first tile arranged
  std::shared_ptr<BreachIndex> breach_index = std::make_shared<BreachIndex>();  ///< by the first tile of `members`
  std::shared_ptr<PartBounds> part_bounds = std::make_shared<PartBounds>();     ///< from phase `drain` on

  /// The tiles by the boxes of their triangles.
  [[nodiscard]] const BoxTree& parts() const { return part_bounds->tree(layout, plan.num_tiles()); }

  [[nodiscard]] bool thins() const { return options.thin.vertical_error_m.has_value(); }
  /// The file that holds a tile's vertices: what `arrange` made, or what `thin` left of it.
  [[nodiscard]] std::string points_unit(std::uint64_t tile) const {
    return layout.unit(thins() ? Phase::thin : Phase::arrange, tile);
  }
  [[nodiscard]] bool has_reference() const {
    return plan.has_reference() || (thins() && options.triangulation.removed_reference);
  }
  /// What the names of the arrays of reference points begin with there.
  [[nodiscard]] const char* reference_prefix() const { return plan.has_reference() ? kReference : kRemoved; }

  std::shared_ptr<const PitPlaces> places = std::make_shared<PitPlaces>();  ///< layers of the pit options

  [[nodiscard]] bool has_rivers() const { return options.rivers.are_given(); }
  std::shared_ptr<const RiverInput> river_input{};  ///< the files of rivers and lakes; null without rivers
  std::shared_ptr<const EmbeddedRivers> rivers{};   ///< what they made of the terrain: from phase `unite` on

  [[nodiscard]] std::string recipe(Phase phase) const {
    // Outlets count where rivers end, too.
    const bool with_places = phase >= (has_rivers() ? Phase::lay : Phase::nest);
    const bool with_rivers = has_rivers() && phase >= Phase::lay;
    return hydrotin::recipe(
        plan.recipe + (with_places ? places->hash : "") + (with_rivers ? hash_of(*river_input) : ""), options, phase);
  }
};

void ingest_file(const RunContext& context, std::uint32_t file);
void arrange_tile(const RunContext& context, std::uint32_t tile);
void survey_points(const RunContext& context);
void thin_tile(const RunContext& context, std::uint32_t tile);
void make_outline(const RunContext& context);
void triangulate_tile(const RunContext& context, std::uint32_t tile);
void join_pieces(const RunContext& context);
void solve_seams(const RunContext& context, std::uint32_t tile);
void mend_minima(const RunContext& context);
void lay_tile(const RunContext& context, std::uint32_t tile);
void match_rivers(const RunContext& context);
void embed_groups(const RunContext& context, std::uint32_t tile);
void unite_groups(const RunContext& context);
void nest_pools(const RunContext& context, std::uint32_t tile);
void rank_pools_of_all(const RunContext& context);
void weigh_pools_of(const RunContext& context, std::uint32_t tile);
void choose_pits(const RunContext& context);
void reduce_tile(const RunContext& context, std::uint32_t tile);
void drain_tiles(const RunContext& context);
void pool_tile(const RunContext& context, std::uint32_t tile);
void join_lakes(const RunContext& context);
void breach_lakes(const RunContext& context, std::uint32_t tile);
void find_members(const RunContext& context, std::uint32_t tile);
void join_groups(const RunContext& context);
void settle_groups(const RunContext& context, std::uint32_t tile);
void finish_tile(const RunContext& context, std::uint32_t tile);
void verify_tile(const RunContext& context, std::uint32_t tile);
/// Whether there are rasters of the change.
[[nodiscard]] bool wants_change_raster(const PipelineOptions& options);
void rasterize_tile(const RunContext& context, std::uint32_t tile);
void write_report(const RunContext& context);

}  // namespace hydrotin
