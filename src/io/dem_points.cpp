#include "hydrotin/dem_points.h"

#include <cpl_string.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "gdal_calls.h"

namespace hydrotin {
namespace {

constexpr std::uint64_t kWindowCells = std::uint64_t{1} << 20;
constexpr std::uint64_t kMaxBlockBytes = std::uint64_t{1} << 30;
constexpr double kMaxQuanta = 4503599627370496.0;  // 2^52: whole numbers of quanta are exact in double

// GDAL keeps blocks of a raster that is read once; a share of the machine's memory by default.
void bound_block_cache() {
  constexpr GIntBig kCacheBytes = GIntBig{64} << 20;
  static std::once_flag once;
  std::call_once(once, [] {
    if (GDALGetCacheMax64() > kCacheBytes) GDALSetCacheMax64(kCacheBytes);
  });
}

[[noreturn]] void refuse(const std::string& path, const std::string& text) {
  throw Error(ErrorKind::input, path + ": " + text);
}

}  // namespace

std::array<double, 4> DemHeader::bounds(std::uint64_t first_row, std::uint64_t rows) const {
  const double x0 = center[0], x1 = center[0] + step[0] * (num_columns - 1.0);
  const double y0 = center[1] + step[1] * static_cast<double>(first_row);
  const double y1 = center[1] + step[1] * static_cast<double>(first_row + std::max<std::uint64_t>(rows, 1) - 1);
  return {std::min(x0, x1), std::min(y0, y1), std::max(x0, x1), std::max(y0, y1)};
}

struct DemFile::Impl {
  std::string path;
  DemReading reading;
  DemHeader header;
  gdal::Dataset dataset;
  GDALRasterBandH band = nullptr;
  bool is_masked = false, is_single = false;
  std::vector<std::uint8_t> mask;
  std::vector<double> value;
  std::vector<std::int64_t> column_x;  // [columns] in quanta
  DemBatch batch;

  Impl(std::string file, DemReading how) : path(std::move(file)), reading(how) {
    bound_block_cache();
    dataset = gdal::open(path, GDAL_OF_RASTER);
    find_band();
    locate();
    describe();
    require_end();
    for (std::uint32_t c = 0; c < header.num_columns; ++c)
      column_x.push_back(quanta(header.center[0] + header.step[0] * c, "x"));
  }

  void find_band() {
    header.num_columns = static_cast<std::uint32_t>(GDALGetRasterXSize(dataset.get()));
    header.num_rows = static_cast<std::uint32_t>(GDALGetRasterYSize(dataset.get()));
    header.num_bands = GDALGetRasterCount(dataset.get());
    if (header.num_bands == 0) refuse(path, "it has no band of cells; name one of its subdatasets or another file");
    if (reading.band < 1 || reading.band > header.num_bands)
      refuse(path, "it has no band " + std::to_string(reading.band) + "; its bands are 1 to " +
                       std::to_string(header.num_bands));
    band = GDALGetRasterBand(dataset.get(), reading.band);
    const GDALDataType type = GDALGetRasterDataType(band);
    header.type = GDALGetDataTypeName(type);
    is_single = type == GDT_Float32;
    if (GDALDataTypeIsComplex(type) != 0) refuse(path, "its values are complex numbers, no heights");
    int width = 0, height = 0;
    GDALGetBlockSize(band, &width, &height);
    header.block_columns = static_cast<std::uint32_t>(width);
    header.block_rows = static_cast<std::uint32_t>(height);
    if (std::uint64_t{header.block_columns} * header.block_rows * 8 > kMaxBlockBytes)
      refuse(path, "its blocks of " + std::to_string(width) + " x " + std::to_string(height) +
                       " cells are too large to be read in parts; rewrite it, for instance with gdal_translate -co "
                       "TILED=YES");
  }

  void locate() {
    double t[6];
    if (GDALGetGeoTransform(dataset.get(), t) != CE_None)
      refuse(path, "it does not say where it lies (no geotransform); georeference it, for instance with gdal_edit.py");
    if (t[2] != 0 || t[4] != 0)
      refuse(path, "it is rotated, so its cells are no rows and columns of x and y; warp it with gdalwarp first");
    if (!(std::fabs(t[1]) > 0) || !(std::fabs(t[5]) > 0) || !std::isfinite(t[0] + t[1] + t[3] + t[5]))
      refuse(path, "its cells have no size; repair its geotransform");
    header.step = {t[1], t[5]};
    header.center = {t[0] + t[1] / 2, t[3] + t[5] / 2};
    if (std::min(std::fabs(t[1]), std::fabs(t[5])) < 2 * reading.quantum)
      refuse(path, "its cells of " + std::to_string(std::fabs(t[1])) + " x " + std::to_string(std::fabs(t[5])) +
                       " are not wider than twice the quantum " + std::to_string(reading.quantum) +
                       ", so that centres would fall together; give a smaller quantum");
    const auto box = header.bounds(0, header.num_rows);
    for (const double v : box) (void)quanta(v, "x or y");
  }

  void describe() {
    header.driver = GDALGetDriverShortName(GDALGetDatasetDriver(dataset.get()));
    int is_given = FALSE;
    const double nodata = GDALGetRasterNoDataValue(band, &is_given);
    if (is_given != FALSE) header.nodata = nodata;
    header.scale = GDALGetRasterScale(band, &is_given);
    if (is_given == FALSE) header.scale = 1;
    header.offset = GDALGetRasterOffset(band, &is_given);
    if (is_given == FALSE) header.offset = 0;
    is_masked = (GDALGetMaskFlags(band) & GMF_ALL_VALID) == 0;
    header.crs_wkt = GDALGetProjectionRef(dataset.get());
    char** files = GDALGetFileList(dataset.get());
    for (char** f = files; f != nullptr && *f != nullptr; ++f) header.files.emplace_back(*f);
    CSLDestroy(files);
  }

  // The last block of a GeoTIFF is found without reading the others: a file that was cut is noticed before the work.
  void require_end() {
    if (header.driver != "GTiff") return;
    const gdal::MessageTrap trap;
    double last = 0;
    if (GDALRasterIO(band, GF_Read, static_cast<int>(header.num_columns) - 1, static_cast<int>(header.num_rows) - 1, 1,
                     1, &last, 1, 1, GDT_Float64, 0, 0) != CE_None)
      trap.fail(ErrorKind::input, path, "its last block cannot be read, the file may be cut", "fetch it again");
  }

  [[nodiscard]] std::int64_t quanta(double v, const char* what) const {
    const double n = v / reading.quantum;
    if (!(std::fabs(n) < kMaxQuanta))
      refuse(path, std::string(what) + " = " + std::to_string(v) + " is too large for the quantum " +
                       std::to_string(reading.quantum) + "; if it means that there is no height, set input.dem_nodata");
    return std::llround(n);
  }

  // Nodata values are written as decimals: those of single floats are the nearest of these.
  [[nodiscard]] bool is_nodata(double raw) const {
    return reading.nodata && (raw == *reading.nodata || (is_single && raw == static_cast<float>(*reading.nodata)));
  }

  void read_window(std::uint64_t column, std::uint64_t row, std::uint64_t columns, std::uint64_t rows) {
    const auto as_int = [](std::uint64_t n) { return static_cast<int>(n); };
    const std::size_t cells = columns * rows;
    value.resize(cells);
    const gdal::MessageTrap trap;
    const auto read_band = [&](GDALRasterBandH from, void* to, GDALDataType type) {
      if (GDALRasterIO(from, GF_Read, as_int(column), as_int(row), as_int(columns), as_int(rows), to, as_int(columns),
                       as_int(rows), type, 0, 0) != CE_None ||
          trap.has_failure())
        trap.fail(ErrorKind::input, path, "its rows from " + std::to_string(row) + " on cannot be read",
                  "the file may be cut: fetch it again");
    };
    read_band(band, value.data(), GDT_Float64);
    if (!is_masked) return;
    mask.resize(cells);
    read_band(GDALGetMaskBand(band), mask.data(), GDT_Byte);
  }

  void convert_window(std::uint64_t column, std::uint64_t row, std::uint64_t columns, std::uint64_t rows,
                      DemSkips& skips) {
    batch = {};
    std::size_t i = 0;
    for (std::uint64_t r = row; r < row + rows; ++r) {
      const std::int64_t y = quanta(header.center[1] + header.step[1] * static_cast<double>(r), "y");
      for (std::uint64_t c = column; c < column + columns; ++c, ++i) {
        const double raw = value[i];
        if ((is_masked && mask[i] == 0) || is_nodata(raw)) {
          ++skips.nodata;
          continue;
        }
        const double z = raw * header.scale + header.offset;
        if (!std::isfinite(z)) {
          ++skips.not_finite;
          continue;
        }
        batch.x.push_back(column_x[c]);
        batch.y.push_back(y);
        batch.z.push_back(quanta(z, "a height"));
        batch.cell.push_back(r * header.num_columns + c);
      }
    }
  }
};

DemFile::DemFile(std::string path, DemReading reading)
    : impl_(std::make_unique<Impl>(std::move(path), std::move(reading))) {}
DemFile::DemFile(DemFile&&) noexcept = default;
DemFile& DemFile::operator=(DemFile&&) noexcept = default;
DemFile::~DemFile() = default;

const std::string& DemFile::path() const {
  return impl_->path;
}
const DemHeader& DemFile::header() const {
  return impl_->header;
}

DemSkips DemFile::read(std::uint64_t first_row, std::uint64_t rows, const std::function<void(const DemBatch&)>& take) {
  const DemHeader& h = impl_->header;
  const std::uint64_t end = std::min<std::uint64_t>(first_row + rows, h.num_rows);
  const std::uint64_t high = std::max(1U, h.block_rows), wide = std::max(1U, h.block_columns);
  // Several blocks high where blocks are strips of rows, one block high and some wide where they are tiles.
  const std::uint64_t columns =
      std::min<std::uint64_t>(h.num_columns, std::max<std::uint64_t>(1, kWindowCells / (high * wide)) * wide);
  const std::uint64_t blocks = std::max<std::uint64_t>(1, kWindowCells / (columns * high));
  DemSkips skips;
  for (std::uint64_t row = first_row; row < end;) {
    const std::uint64_t next = std::min(end, (row / high + blocks) * high);
    for (std::uint64_t column = 0; column < h.num_columns; column += columns) {
      const std::uint64_t width = std::min<std::uint64_t>(columns, h.num_columns - column);
      impl_->read_window(column, row, width, next - row);
      impl_->convert_window(column, row, width, next - row, skips);
      if (impl_->batch.size() > 0) take(impl_->batch);
    }
    row = next;
  }
  return skips;
}

bool is_raster(const std::string& path) {
  gdal::register_drivers();
  const gdal::MessageTrap trap;
  const GDALDriverH driver = GDALIdentifyDriverEx(path.c_str(), GDAL_OF_RASTER, nullptr, nullptr);
  return driver != nullptr && std::string(GDALGetDriverShortName(driver)) != "XYZ";
}

}  // namespace hydrotin
