#include "fill_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "hydrotin/error.h"
#include "hydrotin/finished_file.h"
#include "hydrotin/pit_layers.h"
#include "hydrotin/raster.h"
#include "hydrotin/rasterize.h"
#include "hydrotin/vector.h"

namespace hydrotin::app {
namespace {

constexpr std::int64_t kMostCells = (std::int64_t{1} << 31) - 1, kBlockRows = 256, kBandCells = std::int64_t{1} << 23;

void write_lifted(const RegionFeatures& f, const Lattice& lattice, GeoPackageWriter& out) {
  LiftedLayer layer(lattice, out);
  const std::span<const std::int32_t> xy = f.ring_xy;
  for (std::size_t i = 0; i < f.size(); ++i) {
    layer.begin({f.level[i], f.lowest[3 * i + 2], f.vertices[i], f.displacement[i], f.volume[i]});
    for (std::uint64_t r = f.region_ring_begin[i]; r < f.region_ring_begin[i + 1]; ++r)
      layer.add_ring(xy.subspan(2 * f.ring_begin[r], 2 * (f.ring_begin[r + 1] - f.ring_begin[r])));
    layer.end();
  }
}

void write_breaches(const BreachFeatures& f, const Lattice& lattice, ChangeMeasure measure, GeoPackageWriter& out) {
  BreachLayer layer(lattice, measure, out);
  const std::span<const std::int32_t> xyz = f.xyz;
  for (std::size_t i = 0; i < f.size(); ++i)
    layer.add({f.pit[3 * i + 2], f.depth[i], f.lowered[i], f.displacement[i], f.length[i], f.volume[i]},
              xyz.subspan(3 * f.begin[i], 3 * (f.begin[i + 1] - f.begin[i])));
}

}  // namespace

FillEdits find_fill_edits(const FillTerrain& terrain, const ChangeableTerrain& changeable, const Removal& removal) {
  const auto star = star_weights(terrain.position, terrain.triangle);
  const PitEdits edits = find_edits(changeable, removal.components, removal.height, star);
  return {region_features(changeable, terrain.triangle, edits), breach_features(changeable, edits, removal.height)};
}

void write_fill_layers(const std::string& path, const std::string& crs_wkt, const FillTerrain& terrain,
                       const ChosenPits& pits, const FillEdits& edits, ChangeMeasure measure) {
  GeoPackageWriter out(path, crs_wkt);
  write_pit_layer(terrain.lattice, pits.pit, pits.is_kept, out);
  write_lifted(edits.lifted, terrain.lattice, out);
  write_breaches(edits.breaches, terrain.lattice, measure, out);
  out.finish();
}

void write_pit_table(const std::string& path, const FillTerrain& terrain, const ChosenPits& pits) {
  FinishedFile file(path);
  {
    std::ofstream out(file.temporary(), std::ios::binary);
    out << pits_csv(terrain.lattice, pits.pit, pits.is_kept);
    out.close();
    if (!out) throw Error(ErrorKind::storage, path + ": cannot be written (is the disk full, the folder writable?)");
  }
  file.publish();
}

void write_change_raster(const std::string& path, const std::string& crs_wkt, const FillTerrain& terrain,
                         std::span<const std::int32_t> height, double cell, double max_edge) {
  std::vector<std::int32_t> change(height.size());
  for (std::size_t v = 0; v < height.size(); ++v) change[v] = height[v] - terrain.height[v];
  std::vector<std::uint32_t> triangle = terrain.triangle;
  keep_changed_triangles(change, triangle);
  Lattice lattice = terrain.lattice;  // differences have no offset
  lattice.base_z = 0;
  LatticeBox box;
  for (const std::uint32_t v : terrain.triangle) box.extend(terrain.position[v]);
  if (box.is_empty()) throw Error(ErrorKind::input, path + ": a TIN without triangles has no raster");
  const RasterFrame frame = frame_around(lattice, box, cell);
  const CellRange window = cells_in(frame, lattice, box);
  const std::int64_t columns = window.num_columns(), rows = window.num_rows();
  if (window.is_empty() || columns > kMostCells / rows)
    throw Error(ErrorKind::config,
                fmt::format("--cell: {} columns by {} rows are no raster (at least one cell, at most "
                            "2^31)",
                            columns, rows));
  const std::uint64_t limit = max_edge > 0 ? squared_edge_limit(max_edge, lattice) : kNoEdgeLimit;
  const auto fill = [&](std::uint32_t first_row, std::span<float> value) {
    CellRange band = window;
    band.row_begin += first_row;
    band.row_end = band.row_begin + static_cast<std::int64_t>(value.size()) / columns;
    rasterize(terrain.position, change, triangle, lattice, frame, band, limit, value);
  };
  const RasterGrid grid{frame.origin_x + static_cast<double>(window.column_begin) * frame.cell,
                        frame.origin_y - static_cast<double>(window.row_begin) * frame.cell,
                        frame.cell,
                        frame.cell,
                        static_cast<std::uint32_t>(columns),
                        static_cast<std::uint32_t>(rows)};
  const std::int64_t blocks = std::max<std::int64_t>(kBandCells / (columns * kBlockRows), 1);
  write_geotiff(path, grid, static_cast<std::uint32_t>(blocks * kBlockRows), fill, crs_wkt);
}

}  // namespace hydrotin::app
