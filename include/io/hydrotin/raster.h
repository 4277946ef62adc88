#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

/// Rasters of heights: tiles, their mosaic, one Cloud Optimized GeoTIFF, and a hillshade.
///
/// All are north-up, of 32-bit floats, with nodata and CRS. Every file is written under a temporary name and renamed
/// when complete; the same values give the same bytes.
///
/// Threads  Functions for different files may run concurrently, except that `cache_bytes` sets GDAL's block cache of
///          the whole process while a function with this option runs.
/// Errors   Error(storage) for what we write, Error(input) for what we read.

namespace hydrotin {

/// Where the cells lie. Cell (row r, column c) covers x_min + [c, c + 1] * cell_x, y_max - [r, r + 1] * cell_y.
struct RasterGrid {
  double x_min = 0, y_max = 0;    ///< outer corner of the first cell, units of the CRS
  double cell_x = 1, cell_y = 1;  ///< > 0, units of the CRS
  std::uint32_t num_columns = 0, num_rows = 0;

  [[nodiscard]] std::size_t size() const { return std::size_t{num_columns} * num_rows; }
  [[nodiscard]] double center_x(std::uint32_t column) const { return x_min + (column + 0.5) * cell_x; }
  [[nodiscard]] double center_y(std::uint32_t row) const { return y_max - (row + 0.5) * cell_y; }
  friend bool operator==(const RasterGrid&, const RasterGrid&) = default;
};

/// One band in memory.
struct Raster {
  RasterGrid grid;
  std::vector<float> value;  ///< [rows x columns], row by row from the north
  bool has_nodata = false;
  float nodata = 0;
  std::string crs_wkt;  ///< empty = unknown

  [[nodiscard]] bool is_nodata(std::size_t cell) const {
    return value[cell] != value[cell] || (has_nodata && value[cell] == nodata);
  }
};

inline constexpr float kNodata = -9999.0F;  ///< in every raster this program writes

/// Writes one tile: GeoTIFF, tiled, DEFLATE with predictor 3.
///
/// @param value    [rows x columns], row by row from the north; `kNodata` where there is no height.
/// @param crs_wkt  empty = unknown.
/// Complexity: O(cells) time, GDAL's block cache of memory. Preconditions: at least one cell.
void write_geotiff(const std::filesystem::path& path, const RasterGrid& grid, std::span<const float> value,
                   const std::string& crs_wkt);

/// Writes the rows [first_row, first_row + values.size() / columns) of a raster; `values` come filled with `kNodata`.
using RowFiller = std::function<void(std::uint32_t first_row, std::span<float> values)>;

/// The same for a raster that need not fit in memory: `fill` is asked for bands of rows from the north.
///
/// @param rows_at_once  rows of a band, a multiple of 256; memory is two bands.
/// Properties           the file reads as one written in one piece.
void write_geotiff(const std::filesystem::path& path, const RasterGrid& grid, std::uint32_t rows_at_once,
                   const RowFiller& fill, const std::string& crs_wkt);

/// Reads one band of any raster GDAL knows.
/// Fails: Error(input) when it is unreadable, cut, has no north-up geotransform, or has more than `max_cells`.
[[nodiscard]] Raster read_raster(const std::filesystem::path& path, int band = 1,
                                 std::size_t max_cells = std::size_t{1} << 28);

/// Options of what goes through every cell of a data set.
struct MosaicOptions {
  std::int64_t cache_bytes = std::int64_t{256} << 20;  ///< GDAL's block cache
  int num_threads = 1;                                 ///< for compression; the bytes do not depend on it
};

/// Writes a VRT over tiles of one grid, with paths relative to it where they lie in or below its folder.
/// Fails: Error(input) when the tiles differ in cell size, CRS, or number of bands. Preconditions: at least one tile.
void write_virtual_mosaic(const std::filesystem::path& path, std::span<const std::filesystem::path> tiles);

/// Writes one Cloud Optimized GeoTIFF with overviews from tiles of one grid. Where tiles overlap the last one wins.
/// Complexity: O(cells) time; memory is the block cache whatever the size. Fails: as write_virtual_mosaic.
void write_cloud_optimized_geotiff(const std::filesystem::path& path, std::span<const std::filesystem::path> tiles,
                                   const MosaicOptions& options = {});

/// Writes a shaded relief (light from the north-west, 45 degrees) as PNG, transparent where the DEM has no height, with
/// world file (.wld) and .aux.xml so that a GIS opens it in place.
///
/// @param max_side  cells of the longer side at most; larger DEMs are averaged down, from overviews where there are
/// any.
void write_hillshade(const std::filesystem::path& path, const std::filesystem::path& dem, std::uint32_t max_side = 4096,
                     const MosaicOptions& options = {});

}  // namespace hydrotin
