#pragma once

#include <optional>
#include <string>

/// Names of rasters that are no plain paths: GDAL's subdatasets, as NETCDF:dem.nc:height, HDF5:"dem.h5"://height,
/// GPKG:terrain.gpkg:dem or GTIFF_DIR:2:dem.tif.
///
/// Threads  Pure; the driver is found by reading the first bytes of a file.

namespace hydrotin {

struct SubdatasetName {
  std::string before, file, after;  ///< the name is these three in a row; `before` ends with ':' or a quote

  [[nodiscard]] std::string with(const std::string& other_file) const { return before + other_file + after; }
};

/// Nothing for a plain path: a subdataset begins with the name of a format in capitals, digits or '_', and a colon.
[[nodiscard]] std::optional<SubdatasetName> parse_subdataset(const std::string& name);

/// Whether GDAL reads the raster through the HDF5 library, or might (a VRT names any others), which calls from several
/// threads at a time can break.
[[nodiscard]] bool reads_through_hdf5(const std::string& path);

}  // namespace hydrotin
