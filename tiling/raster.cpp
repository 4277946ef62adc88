#include "hydrotin/raster.h"

#include <algorithm>
#include <limits>

#include "block_index.h"
#include "hydrotin/edit_features.h"
#include "hydrotin/raster_frame.h"
#include "hydrotin/rasterize.h"
#include "leftovers.h"
#include "phases.h"
#include "terrain_file.h"

namespace hydrotin {
namespace {

LatticeBox intersection(const LatticeBox& a, const LatticeBox& b) {
  return {{std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y)},
          {std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y)}};
}

// Centres of a tile's cells may lie up to one lattice unit beyond its box.
LatticeBox with_far_sides(LatticeBox box) {
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  if (box.max.x < kMost) ++box.max.x;
  if (box.max.y < kMost) ++box.max.y;
  return box;
}

// A raster is made in bands of rows of about so many cells: a tile may be mostly void and wider than memory.
constexpr std::int64_t kBlockRows = 256, kBandCells = std::int64_t{1} << 23, kMostCells = (std::int64_t{1} << 31) - 1;

// All lattice points between which the centres of a band's rows lie.
LatticeBox around_rows(const RasterFrame& frame, const Lattice& lattice, const CellRange& band) {
  constexpr std::int64_t kLeast = std::numeric_limits<std::int32_t>::min(),
                         kMost = std::numeric_limits<std::int32_t>::max();
  const auto lattice_row = [&](std::int64_t row) { return center_y(frame, lattice, row) >> kSubLatticeBits; };
  const auto low = std::clamp(lattice_row(band.row_end - 1), kLeast, kMost);
  const auto high = std::clamp(lattice_row(band.row_begin) + 1, kLeast, kMost);
  return {{static_cast<std::int32_t>(kLeast), static_cast<std::int32_t>(low)},
          {static_cast<std::int32_t>(kMost), static_cast<std::int32_t>(high)}};
}

struct RasterCount {
  std::int64_t cells = 0, with_height = 0;
};

// The triangles that rivers and pit removal moved, at the heights of the change: 0 where the lattice says 0.
void keep_changed(TrianglePatch& patch) {
  for (std::size_t v = 0; v < patch.height.size(); ++v) patch.height[v] -= patch.measured[v];
  keep_changed_triangles(patch.height, patch.triangle);
}

enum class RasterKind : std::uint8_t { heights, change };

// The window of a tile in the raster of the whole.
struct TileWindow {
  LatticeBox box;
  RasterFrame frame;
  CellRange cells;
};

TileWindow window_of(const RunContext& context, std::uint32_t tile) {
  const LatticeBox bounds = context.outline.bounds();
  const double cell = context.options.output.dem.cell_m / context.plan.metres_per_unit;
  TileWindow out{intersection(context.plan.core[tile], bounds), frame_around(context.plan.lattice, bounds, cell), {}};
  out.cells = cells_in(out.frame, context.plan.lattice, out.box);
  return out;
}

void require_memory(const RunContext& context, std::uint32_t tile, const CellRange& cells) {
  const std::int64_t columns = cells.num_columns(), rows = cells.num_rows();
  if (columns > kMostCells / rows ||
      static_cast<std::uint64_t>(columns) * kBlockRows * sizeof(float) > context.options.run.memory_bytes)
    throw Error(ErrorKind::resource, context.layout.dem_tile(tile) + ": tile " + std::to_string(tile) + " has " +
                                         std::to_string(columns) + " x " + std::to_string(rows) +
                                         " DEM cells, more than 2^31, or than 256 rows of them in memory; raise "
                                         "output.dem.cell_m or lower tiles.target_points");
}

RasterCount write_raster(const RunContext& context, std::uint32_t tile, RasterKind kind, const std::string& path) {
  const DemOptions& dem = context.options.output.dem;
  Lattice lattice = context.plan.lattice;
  const auto [box, frame, window] = window_of(context, tile);
  if (window.is_empty()) {
    remove_leftover(path);
    return {};
  }
  require_memory(context, tile, window);
  if (kind == RasterKind::change) {  // differences have no offset
    lattice.base_z = 0;
    lattice.offset_z = 0;
  }
  const std::int64_t columns = window.num_columns(), rows = window.num_rows();
  const std::uint64_t limit =
      dem.max_edge_m > 0 ? squared_edge_limit(dem.max_edge_m / context.plan.metres_per_unit, lattice) : kNoEdgeLimit;
  const BoxTree& parts = context.parts();
  std::uint64_t with_height = 0;
  const auto fill = [&](std::uint32_t first_row, std::span<float> value) {
    CellRange band = window;
    band.row_begin += first_row;
    band.row_end = band.row_begin + static_cast<std::int64_t>(value.size()) / columns;
    const LatticeBox reach = intersection(with_far_sides(box), around_rows(frame, lattice, band));
    const auto meets_reach = [&](const LatticeBox& part) { return part.intersects(reach); };
    parts.for_each(meets_reach, [&](std::uint32_t t) {
      TrianglePatch patch =
          read_patch(store::Reader(context.layout.unit(Phase::finish, t)), reach, kind == RasterKind::change);
      if (kind == RasterKind::change) keep_changed(patch);
      with_height += rasterize(patch.position, patch.height, patch.triangle, lattice, frame, band, limit, value);
      return true;
    });
  };
  const RasterGrid grid{frame.origin_x + static_cast<double>(window.column_begin) * frame.cell,
                        frame.origin_y - static_cast<double>(window.row_begin) * frame.cell,
                        frame.cell,
                        frame.cell,
                        static_cast<std::uint32_t>(columns),
                        static_cast<std::uint32_t>(rows)};
  const std::int64_t blocks = std::max<std::int64_t>(kBandCells / (columns * kBlockRows), 1);
  write_geotiff(path, grid, static_cast<std::uint32_t>(blocks * kBlockRows), fill, context.plan.crs_wkt);
  return {columns * rows, static_cast<std::int64_t>(with_height)};
}

}  // namespace

bool wants_change_raster(const PipelineOptions& options) {
  return options.output.dem.enabled && options.output.dem.change &&
         (options.pits.method != PitMethod::none || options.rivers.are_given());
}

void rasterize_tile(const RunContext& context, std::uint32_t tile) {
  RasterCount dem, change;
  if (context.options.output.dem.enabled)
    dem = write_raster(context, tile, RasterKind::heights, context.layout.dem_tile(tile));
  if (wants_change_raster(context.options))
    change = write_raster(context, tile, RasterKind::change, context.layout.change_tile(tile));
  store::Writer marker(context.layout.unit(Phase::raster, tile));
  marker.set("recipe", context.recipe(Phase::raster));
  marker.set("cells", dem.cells);
  marker.set("cells_with_height", dem.with_height);
  marker.set("cells_changed", change.with_height);
  marker.commit();
}

}  // namespace hydrotin
