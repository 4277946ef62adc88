#include "hydrotin/raster.h"

#include <gdal_utils.h>
#include <ogr_srs_api.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <memory>

#include "gdal_calls.h"
#include "hydrotin/finished_file.h"

namespace hydrotin {
namespace {

/// Sets GDAL's block cache while alive.
class CacheLimit {
 public:
  explicit CacheLimit(std::int64_t bytes) : before_(GDALGetCacheMax64()) { GDALSetCacheMax64(bytes); }
  ~CacheLimit() { GDALSetCacheMax64(before_); }
  CacheLimit(const CacheLimit&) = delete;
  CacheLimit& operator=(const CacheLimit&) = delete;

 private:
  std::int64_t before_;
};

GDALDriverH driver(const char* name) {
  gdal::register_drivers();
  const GDALDriverH result = GDALGetDriverByName(name);
  if (result == nullptr)
    throw Error(ErrorKind::storage,
                std::string("this build of GDAL has no driver ") + name + " (install one that has)");
  return result;
}

std::vector<std::string> names_of(std::span<const std::filesystem::path> tiles) {
  std::vector<std::string> names;
  names.reserve(tiles.size());
  for (const auto& tile : tiles) names.push_back(tile.string());
  return names;
}

/// Builds the mosaic under `destination`; an empty one stays in memory.
gdal::Dataset build_mosaic(const std::filesystem::path& blame, const std::string& destination,
                           std::span<const std::filesystem::path> tiles) {
  assert(!tiles.empty());
  gdal::register_drivers();
  const gdal::MessageTrap trap;
  gdal::StringList names(names_of(tiles));
  gdal::StringList arguments{"-strict", "-r", "nearest"};
  const std::unique_ptr<GDALBuildVRTOptions, decltype(&GDALBuildVRTOptionsFree)> options(
      GDALBuildVRTOptionsNew(arguments.get(), nullptr), GDALBuildVRTOptionsFree);
  int usage_error = FALSE;
  gdal::Dataset mosaic(GDALBuildVRT(destination.c_str(), static_cast<int>(tiles.size()), nullptr, names.get(),
                                    options.get(), &usage_error));
  if (!mosaic || trap.has_failure())
    trap.fail(ErrorKind::input, blame, "its " + std::to_string(tiles.size()) + " tiles do not form one raster");
  return mosaic;
}

/// Checks that every cell boundary of every tile lies on the mosaic's grid; GDAL would resample silently.
void require_common_grid(const std::filesystem::path& blame, std::span<const std::filesystem::path> tiles) {
  RasterGrid first;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const auto dataset = gdal::open(tiles[i], GDAL_OF_RASTER);
    double transform[6];
    const bool located = GDALGetGeoTransform(dataset.get(), transform) == CE_None;
    if (i == 0) first = {transform[0], transform[3], transform[1], -transform[5], 0, 0};
    const double columns = (transform[0] - first.x_min) / first.cell_x;
    const double rows = (first.y_max - transform[3]) / first.cell_y;
    const bool aligned = std::abs(columns - std::round(columns)) < 1e-6 && std::abs(rows - std::round(rows)) < 1e-6;
    if (!located || transform[1] != first.cell_x || -transform[5] != first.cell_y || !aligned)
      throw Error(ErrorKind::input, blame.string() + ": " + tiles[i].string() + " is not on the grid of " +
                                        tiles[0].string() + " (all tiles need one cell size and origin)");
  }
}

gdal::Dataset shrink(const std::filesystem::path& dem, GDALDatasetH source, std::uint32_t max_side) {
  const double columns = GDALGetRasterXSize(source), rows = GDALGetRasterYSize(source);
  const double factor = std::min(1.0, max_side / std::max(columns, rows));
  const gdal::MessageTrap trap;
  gdal::StringList arguments{"-of",
                             "MEM",
                             "-r",
                             "average",
                             "-outsize",
                             std::to_string(std::max(1L, std::lround(columns * factor))),
                             std::to_string(std::max(1L, std::lround(rows * factor)))};
  const std::unique_ptr<GDALTranslateOptions, decltype(&GDALTranslateOptionsFree)> options(
      GDALTranslateOptionsNew(arguments.get(), nullptr), GDALTranslateOptionsFree);
  int usage_error = FALSE;
  gdal::Dataset small(GDALTranslate("", source, options.get(), &usage_error));
  if (!small) trap.fail(ErrorKind::input, dem, "cannot be resampled");
  return small;
}

gdal::Dataset shade(const std::filesystem::path& dem, GDALDatasetH heights) {
  const gdal::MessageTrap trap;
  gdal::StringList arguments{"-of", "MEM", "-compute_edges", "-az", "315", "-alt", "45"};
  const OGRSpatialReferenceH reference = GDALGetSpatialRef(heights);
  if (reference != nullptr && OSRIsGeographic(reference) != 0) {
    arguments.add("-s");
    arguments.add("111120");  // metres in a degree
  }
  const std::unique_ptr<GDALDEMProcessingOptions, decltype(&GDALDEMProcessingOptionsFree)> options(
      GDALDEMProcessingOptionsNew(arguments.get(), nullptr), GDALDEMProcessingOptionsFree);
  int usage_error = FALSE;
  gdal::Dataset shaded(GDALDEMProcessing("", heights, "hillshade", nullptr, options.get(), &usage_error));
  if (!shaded) trap.fail(ErrorKind::input, dem, "cannot be shaded");
  return shaded;
}

}  // namespace

void write_geotiff(const std::filesystem::path& path, const RasterGrid& grid, std::uint32_t rows_at_once,
                   const RowFiller& fill, const std::string& crs_wkt) {
  assert(grid.size() > 0 && rows_at_once > 0 && (rows_at_once % 256 == 0 || rows_at_once >= grid.num_rows));
  FinishedFile file(path);
  const gdal::MessageTrap trap;
  gdal::StringList options{"TILED=YES", "BLOCKXSIZE=256", "BLOCKYSIZE=256",  "COMPRESS=DEFLATE",
                           "ZLEVEL=1",  "PREDICTOR=3",    "BIGTIFF=IF_SAFER"};
  const int columns = static_cast<int>(grid.num_columns);
  gdal::Dataset dataset(GDALCreate(driver("GTiff"), file.temporary().c_str(), columns, static_cast<int>(grid.num_rows),
                                   1, GDT_Float32, options.get()));
  if (!dataset) trap.fail(ErrorKind::storage, path, "cannot be created");
  double transform[6] = {grid.x_min, grid.cell_x, 0, grid.y_max, 0, -grid.cell_y};
  const GDALRasterBandH band = GDALGetRasterBand(dataset.get(), 1);
  bool written = GDALSetGeoTransform(dataset.get(), transform) == CE_None &&
                 (crs_wkt.empty() || GDALSetProjection(dataset.get(), crs_wkt.c_str()) == CE_None) &&
                 GDALSetRasterNoDataValue(band, kNodata) == CE_None;
  std::vector<float> value;
  for (std::uint32_t first = 0; written && first < grid.num_rows;) {
    const std::uint32_t rows = std::min(rows_at_once, grid.num_rows - first);
    value.assign(std::size_t{rows} * grid.num_columns, kNodata);
    fill(first, value);
    // Flushed, so that GDAL's cache holds no more than this band; its blocks are complete.
    written = GDALRasterIO(band, GF_Write, 0, static_cast<int>(first), columns, static_cast<int>(rows), value.data(),
                           columns, static_cast<int>(rows), GDT_Float32, 0, 0) == CE_None &&
              GDALFlushRasterCache(band) == CE_None;
    first += rows;
  }
  if (!written) trap.fail(ErrorKind::storage, path, "cannot be written", "check the disk's free space");
  gdal::close_written(std::move(dataset), trap, path);
  file.publish();
}

void write_geotiff(const std::filesystem::path& path, const RasterGrid& grid, std::span<const float> value,
                   const std::string& crs_wkt) {
  assert(value.size() == grid.size());
  const RowFiller copy = [&](std::uint32_t first_row, std::span<float> rows) {
    const auto part = value.subspan(std::size_t{first_row} * grid.num_columns, rows.size());
    std::copy(part.begin(), part.end(), rows.begin());
  };
  write_geotiff(path, grid, 256, copy, crs_wkt);
}

Raster read_raster(const std::filesystem::path& path, int band_number, std::size_t max_cells) {
  const auto dataset = gdal::open(path, GDAL_OF_RASTER);
  const gdal::MessageTrap trap;
  Raster raster;
  RasterGrid& grid = raster.grid;
  grid.num_columns = static_cast<std::uint32_t>(GDALGetRasterXSize(dataset.get()));
  grid.num_rows = static_cast<std::uint32_t>(GDALGetRasterYSize(dataset.get()));
  if (band_number < 1 || band_number > GDALGetRasterCount(dataset.get()))
    trap.fail(ErrorKind::input, path, "has no band " + std::to_string(band_number));
  double transform[6];
  if (GDALGetGeoTransform(dataset.get(), transform) != CE_None || transform[2] != 0 || transform[4] != 0 ||
      !(transform[1] > 0) || !(transform[5] < 0))
    trap.fail(ErrorKind::input, path, "is not a north-up raster", "warp it with gdalwarp first");
  if (grid.size() > max_cells)
    trap.fail(ErrorKind::input, path,
              "has " + std::to_string(grid.size()) + " cells, more than the " + std::to_string(max_cells) +
                  " that are read at once");
  grid.x_min = transform[0];
  grid.cell_x = transform[1];
  grid.y_max = transform[3];
  grid.cell_y = -transform[5];
  const GDALRasterBandH band = GDALGetRasterBand(dataset.get(), band_number);
  int has_nodata = FALSE;
  raster.nodata = static_cast<float>(GDALGetRasterNoDataValue(band, &has_nodata));
  raster.has_nodata = has_nodata != FALSE;
  raster.crs_wkt = GDALGetProjectionRef(dataset.get());
  raster.value.resize(grid.size());
  if (GDALRasterIO(band, GF_Read, 0, 0, static_cast<int>(grid.num_columns), static_cast<int>(grid.num_rows),
                   raster.value.data(), static_cast<int>(grid.num_columns), static_cast<int>(grid.num_rows),
                   GDT_Float32, 0, 0) != CE_None)
    trap.fail(ErrorKind::input, path, "cannot be read to its end");
  return raster;
}

void write_virtual_mosaic(const std::filesystem::path& path, std::span<const std::filesystem::path> tiles) {
  require_common_grid(path, tiles);
  FinishedFile file(path);
  auto mosaic = build_mosaic(path, file.temporary().string(), tiles);
  const gdal::MessageTrap trap;
  gdal::close_written(std::move(mosaic), trap, path);
  file.publish();
}

void write_cloud_optimized_geotiff(const std::filesystem::path& path, std::span<const std::filesystem::path> tiles,
                                   const MosaicOptions& options) {
  const CacheLimit limit(options.cache_bytes);
  require_common_grid(path, tiles);
  FinishedFile file(path);
  const auto mosaic = build_mosaic(path, "", tiles);
  const gdal::MessageTrap trap;
  gdal::StringList creation{"COMPRESS=DEFLATE",
                            "PREDICTOR=FLOATING_POINT",
                            "BLOCKSIZE=512",
                            "LEVEL=1",
                            "OVERVIEWS=IGNORE_EXISTING",
                            "OVERVIEW_RESAMPLING=AVERAGE",
                            "BIGTIFF=IF_SAFER",
                            "NUM_THREADS=" + std::to_string(std::max(1, options.num_threads))};
  gdal::Dataset result(
      GDALCreateCopy(driver("COG"), file.temporary().c_str(), mosaic.get(), FALSE, creation.get(), nullptr, nullptr));
  if (!result) trap.fail(ErrorKind::storage, path, "cannot be written", "check the disk's free space");
  gdal::close_written(std::move(result), trap, path);
  file.publish();
}

void write_hillshade(const std::filesystem::path& path, const std::filesystem::path& dem, std::uint32_t max_side,
                     const MosaicOptions& options) {
  assert(max_side > 0);
  const CacheLimit limit(options.cache_bytes);
  const auto source = gdal::open(dem, GDAL_OF_RASTER);
  const auto small = shrink(dem, source.get(), max_side);
  const auto shaded = shade(dem, small.get());

  FinishedFile file(path);
  const auto sidecar = [](std::filesystem::path image, bool world) {
    if (world) return image.replace_extension(".wld");
    return image += ".aux.xml";
  };
  for (const bool world : {true, false}) std::remove(sidecar(file.temporary(), world).c_str());
  {
    const gdal::MessageTrap trap;
    gdal::StringList creation{"WORLDFILE=YES", "ZLEVEL=4"};
    gdal::Dataset image(
        GDALCreateCopy(driver("PNG"), file.temporary().c_str(), shaded.get(), FALSE, creation.get(), nullptr, nullptr));
    if (!image) trap.fail(ErrorKind::storage, path, "cannot be written", "check the disk's free space");
    gdal::close_written(std::move(image), trap, path);
  }
  // The image comes last: when it is there, what places it is there too.
  for (const bool world : {true, false})
    if (std::filesystem::exists(sidecar(file.temporary(), world)))
      publish_file(sidecar(file.temporary(), world), sidecar(path, world));
  file.publish();
}

}  // namespace hydrotin
