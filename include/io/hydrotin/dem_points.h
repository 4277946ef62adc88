#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// Cells of a DEM as points: any raster that GDAL reads.
///
/// A cell with a height becomes a point at its centre. Centres and heights are whole numbers of one `quantum`, so that
/// a DEM lies on the lattice of the run like any cloud: coordinate = integer * quantum, nothing is shifted. Values and
/// centres that are multiples of the quantum come out exactly; others go to the nearest multiple, so that nothing moves
/// by more than half a quantum per axis. Height = value of the band * its scale + its offset, as GDAL defines them.
///
/// Cells left out: those that the band masks (nodata value, mask, alpha), values equal to `DemReading::nodata`, NaN and
/// infinities. Each is counted.
///
/// Properties
///   (1) Every cell of the rows read is a point or counted as left out, once, whatever the windows.
///   (2) Memory is bounded by a window of cells, not by the size of the raster.
/// Paths    What GDAL opens: GeoTIFF, COG, VRT, ASCII grids, /vsi... The raster must not be rotated; its rows may go up
///          or down.
/// Threads  One object by one thread; different objects concurrently.
/// Errors   Error(input): file, cause, remedy.

namespace hydrotin {

struct DemReading {
  int band = 1;
  std::optional<double> nodata{};  ///< value of the band that also means "no height"; none: what the file says
  double quantum = 0.001;          ///< unit of x, y and z, in the unit of the CRS; a decimal fraction
};

struct DemHeader {
  std::string driver;  ///< GDAL's short name, for instance GTiff
  std::string type;    ///< of the values, for instance Float32
  std::uint32_t num_columns = 0, num_rows = 0;
  int num_bands = 0;
  std::array<double, 2> center{0, 0};  ///< of the first cell
  std::array<double, 2> step{1, -1};   ///< from a column, and from a row, to the next; not 0
  std::optional<double> nodata;        ///< as the file says
  double scale = 1, offset = 0;        ///< of the band's values
  std::uint32_t block_columns = 0, block_rows = 0;
  std::string crs_wkt;             ///< empty = unknown
  std::vector<std::string> files;  ///< all that the raster is read from

  [[nodiscard]] std::uint64_t num_cells() const { return std::uint64_t{num_columns} * num_rows; }
  /// Smallest and largest centre of the cells of some rows: x, y, x, y.
  [[nodiscard]] std::array<double, 4> bounds(std::uint64_t first_row, std::uint64_t rows) const;
};

/// Some cells with heights.
struct DemBatch {
  std::vector<std::int64_t> x, y, z;  ///< [n] in quanta
  std::vector<std::uint64_t> cell;    ///< [n] row * columns + column

  [[nodiscard]] std::size_t size() const { return x.size(); }
};

/// Cells left out.
struct DemSkips {
  std::uint64_t nodata = 0;      ///< masked or nodata
  std::uint64_t not_finite = 0;  ///< NaN or infinite, and not masked
};

/// An open DEM, checked: located, not rotated, real numbers, as long as its header says where that is cheap to tell.
class DemFile {
 public:
  explicit DemFile(std::string path, DemReading reading = {});
  DemFile(DemFile&&) noexcept;
  DemFile& operator=(DemFile&&) noexcept;
  ~DemFile();

  [[nodiscard]] const std::string& path() const;
  [[nodiscard]] const DemHeader& header() const;

  /// The cells of the rows [first_row, first_row + rows), in windows of whole blocks.
  /// Complexity: O(cells). Fails: a block that cannot be read, a height beyond 2^52 quanta.
  [[nodiscard]] DemSkips read(std::uint64_t first_row, std::uint64_t rows,
                              const std::function<void(const DemBatch&)>& take);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether GDAL takes the file for a raster. Lists of points as text are none, though GDAL could read some as grids.
[[nodiscard]] bool is_raster(const std::string& path);

}  // namespace hydrotin
