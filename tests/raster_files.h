#pragma once

#include <cpl_string.h>
#include <gdal.h>
#include <gtest/gtest.h>
#include <ogr_srs_api.h>

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

/// Rasters on disk for tests, written by GDAL itself.

namespace hydrotin::testing {

struct TestRaster {
  int columns = 1, rows = 1, bands = 1;
  std::array<double, 6> transform{500000, 1, 0, 4000000, 0, -1};
  bool is_located = true;
  std::string crs = "EPSG:32633";
  GDALDataType type = GDT_Float32;
  std::optional<double> nodata, scale, offset;
  std::vector<std::string> creation;
  std::vector<double> value;  ///< [bands x rows x columns]; empty: nothing is written, cells are what GDAL makes them
};

inline std::string write_raster(const std::string& path, const TestRaster& raster) {
  GDALAllRegister();
  char** options = nullptr;
  for (const std::string& o : raster.creation) options = CSLAddString(options, o.c_str());
  const GDALDatasetH out = GDALCreate(GDALGetDriverByName("GTiff"), path.c_str(), raster.columns, raster.rows,
                                      raster.bands, raster.type, options);
  CSLDestroy(options);
  EXPECT_NE(out, nullptr);
  std::array<double, 6> transform = raster.transform;
  if (raster.is_located) {
    EXPECT_EQ(GDALSetGeoTransform(out, transform.data()), CE_None);
  }
  if (!raster.crs.empty()) {
    const OGRSpatialReferenceH crs = OSRNewSpatialReference(nullptr);
    EXPECT_EQ(OSRSetFromUserInput(crs, raster.crs.c_str()), OGRERR_NONE);
    EXPECT_EQ(GDALSetSpatialRef(out, crs), CE_None);
    OSRDestroySpatialReference(crs);
  }
  for (int b = 1; b <= raster.bands; ++b) {
    const GDALRasterBandH band = GDALGetRasterBand(out, b);
    if (raster.nodata) {
      EXPECT_EQ(GDALSetRasterNoDataValue(band, *raster.nodata), CE_None);
    }
    if (raster.scale) {
      EXPECT_EQ(GDALSetRasterScale(band, *raster.scale), CE_None);
    }
    if (raster.offset) {
      EXPECT_EQ(GDALSetRasterOffset(band, *raster.offset), CE_None);
    }
    if (raster.value.empty()) continue;
    std::vector<double> part(raster.value.begin() + std::ptrdiff_t{b - 1} * raster.columns * raster.rows,
                             raster.value.begin() + std::ptrdiff_t{b} * raster.columns * raster.rows);
    EXPECT_EQ(GDALRasterIO(band, GF_Write, 0, 0, raster.columns, raster.rows, part.data(), raster.columns, raster.rows,
                           GDT_Float64, 0, 0),
              CE_None);
  }
  GDALClose(out);
  return path;
}

}  // namespace hydrotin::testing
