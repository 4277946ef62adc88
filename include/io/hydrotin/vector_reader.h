#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "hydrotin/vector.h"

/// Lines and polygons from every vector format GDAL reads: GeoPackage, shapefile, GeoJSON, FlatGeobuf and others.
///
/// All layers are read in their order, all features in theirs. Parts of multi-geometries and collections become parts;
/// curves become chains of segments. Everything is brought into one CRS.
///
/// Memory   all coordinates at once. Threads  Functions for different files may run concurrently.

namespace hydrotin {

struct VectorReadOptions {
  VectorGeometry geometry = VectorGeometry::line;  ///< line or polygon; other kinds are skipped and counted
  std::string target_wkt;             ///< CRS of the result; empty = as in the file, nothing is reprojected
  std::string missing_crs_wkt;        ///< of layers that name none; empty = they are taken to be in the target CRS
  std::vector<std::string> fields{};  ///< attributes wanted, as text
};

/// Parts as CSR. Part i has the rings ring_begin[i] .. ring_begin[i + 1] (a line has one), ring r the points
/// point[point_begin[r] .. point_begin[r + 1]). P = parts.
struct VectorParts {
  std::vector<std::size_t> ring_begin{0};
  std::vector<std::size_t> point_begin{0};
  std::vector<std::array<double, 3>> point;  ///< z = 0 where the file has none
  std::vector<std::int64_t> feature;         ///< [P] feature id in its layer
  std::vector<std::uint32_t> layer;          ///< [P]
  std::vector<std::string> value;            ///< [P x fields] row by row; empty where the feature has none
  std::uint64_t num_features = 0;            ///< read or skipped
  std::uint64_t num_null = 0;                ///< features without geometry, or with an empty one
  std::uint64_t num_other = 0;               ///< parts of other kinds, and lines of fewer than two points
  bool crs_was_missing = false;              ///< of a layer with features

  [[nodiscard]] std::size_t size() const { return feature.size(); }
  [[nodiscard]] std::span<const std::array<double, 3>> ring(std::size_t r) const {
    return {point.data() + point_begin[r], point.data() + point_begin[r + 1]};
  }
};

/// Fails: Error(input) with file and feature: it cannot be opened or read, has no vector layer, a coordinate cannot be
/// reprojected or is not finite; no layer has a field that is wanted.
[[nodiscard]] VectorParts read_vector(const std::filesystem::path& path, const VectorReadOptions& options);

}  // namespace hydrotin
