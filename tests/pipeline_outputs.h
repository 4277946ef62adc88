#pragma once

#include <cpl_conv.h>
#include <gdal.h>
#include <gtest/gtest.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "expected_error.h"
#include "hydrotin/mesh.h"
#include "hydrotin/pipeline.h"
#include "hydrotin/raster.h"
#include "tiling_fixture.h"

/// What users open, read back as they would: meshes, rasters and layers of a finished data set.
///
/// Units  thousandths of the unit of the CRS wherever coordinates are integers.

namespace hydrotin::testing {

/// Files of a folder with this extension, by name.
inline std::vector<std::string> files_in(const std::string& folder, const std::string& extension) {
  std::vector<std::string> out;
  std::error_code absent;
  for (const auto& entry : std::filesystem::directory_iterator(folder, absent))
    if (entry.path().extension() == extension) out.push_back(entry.path().string());
  std::sort(out.begin(), out.end());
  return out;
}

using Place = std::array<std::int64_t, 3>;

/// The meshes of all tiles as one surface.
struct Surface {
  std::vector<Place> vertex;                           ///< distinct, ascending
  std::vector<std::array<std::uint32_t, 3>> triangle;  ///< smallest vertex first, turning as in the file; ascending

  [[nodiscard]] std::vector<std::array<Place, 3>> triangles() const {
    std::vector<std::array<Place, 3>> out;
    for (const auto& t : triangle) out.push_back({vertex[t[0]], vertex[t[1]], vertex[t[2]]});
    return out;
  }
};

inline Surface read_surface(const std::string& dir) {
  std::vector<std::array<Place, 3>> corners;
  Surface out;
  for (const auto& path : files_in(dir + "/mesh", ".ply")) {
    const Mesh mesh = read_mesh(path);
    const auto place = [&](std::uint32_t v) {
      const MeshVertex& p = mesh.vertex[v];
      return Place{std::llround(p[0] * 1000), std::llround(p[1] * 1000), std::llround(p[2] * 1000)};
    };
    for (const auto& t : mesh.triangle) corners.push_back({place(t[0]), place(t[1]), place(t[2])});
  }
  for (const auto& t : corners) out.vertex.insert(out.vertex.end(), t.begin(), t.end());
  std::sort(out.vertex.begin(), out.vertex.end());
  out.vertex.erase(std::unique(out.vertex.begin(), out.vertex.end()), out.vertex.end());
  for (const auto& t : corners) {
    std::array<std::uint32_t, 3> index{};
    for (std::size_t i = 0; i < 3; ++i)
      index[i] =
          static_cast<std::uint32_t>(std::lower_bound(out.vertex.begin(), out.vertex.end(), t[i]) - out.vertex.begin());
    std::rotate(index.begin(), std::min_element(index.begin(), index.end()), index.end());
    out.triangle.push_back(index);
  }
  std::sort(out.triangle.begin(), out.triangle.end());
  return out;
}

/// What is wrong with a surface as a triangulation of a convex hull; empty if nothing is.
inline std::string fault_of(const Surface& s) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (std::size_t v = 1; v < s.vertex.size(); ++v)
    if (s.vertex[v][0] == s.vertex[v - 1][0] && s.vertex[v][1] == s.vertex[v - 1][1]) return "two heights at one place";
  std::size_t edges = 0;
  for (const auto& t : s.triangle) {
    const Place &a = s.vertex[t[0]], &b = s.vertex[t[1]], &c = s.vertex[t[2]];
    if ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) <= 0) return "a triangle turned over";
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = t[i], to = t[(i + 1) % 3];
      if (!sides.emplace(std::pair{from, to}, 1).second) return "an edge with two triangles on one side";
      edges += !sides.contains({to, from});
    }
  }
  if (s.vertex.size() + s.triangle.size() != edges + 1) return "Euler's formula does not hold";
  return {};
}

/// Plateaus without a way down or out: pits with outlets on the border.
inline std::size_t count_pits(const Surface& s) {
  std::vector<std::uint32_t> root(s.vertex.size());
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edge;
  for (const auto& t : s.triangle)
    for (std::size_t i = 0; i < 3; ++i) edge.emplace_back(std::minmax(t[i], t[(i + 1) % 3]));
  std::sort(edge.begin(), edge.end());
  for (const auto& [a, b] : edge)
    if (s.vertex[a][2] == s.vertex[b][2]) root[find(a)] = find(b);
  std::vector<std::uint8_t> drained(s.vertex.size());
  for (std::size_t i = 0; i < edge.size(); ++i) {
    const auto [a, b] = edge[i];
    const bool inner = (i > 0 && edge[i - 1] == edge[i]) || (i + 1 < edge.size() && edge[i + 1] == edge[i]);
    if (!inner) drained[find(a)] = drained[find(b)] = 1;
    if (s.vertex[a][2] > s.vertex[b][2]) drained[find(a)] = 1;
    if (s.vertex[b][2] > s.vertex[a][2]) drained[find(b)] = 1;
  }
  std::size_t pits = 0;
  for (std::uint32_t v = 0; v < root.size(); ++v) pits += find(v) == v && !drained[v];
  return pits;
}

struct CloseDataset {
  void operator()(void* dataset) const { GDALClose(dataset); }
};
using GdalDataset = std::unique_ptr<void, CloseDataset>;

inline GdalDataset open_dataset(const std::string& path, unsigned kind) {
  GDALAllRegister();
  return GdalDataset(GDALOpenEx(path.c_str(), kind | GDAL_OF_VERBOSE_ERROR, nullptr, nullptr, nullptr));
}

/// EPSG code of a CRS, or 0.
inline int epsg_of(OGRSpatialReferenceH reference) {
  if (reference == nullptr) return 0;
  const char* code = OSRGetAuthorityCode(reference, nullptr);
  return code == nullptr ? 0 : std::atoi(code);
}

inline int epsg_of_raster(const std::string& path) {
  const GdalDataset dataset = open_dataset(path, GDAL_OF_RASTER);
  return dataset ? epsg_of(GDALGetSpatialRef(dataset.get())) : -1;
}

inline int epsg_of_wkt(const std::string& wkt) {
  OGRSpatialReferenceH reference = OSRNewSpatialReference(wkt.c_str());
  if (reference == nullptr) return -1;
  OSRAutoIdentifyEPSG(reference);
  const int code = epsg_of(reference);
  OSRDestroySpatialReference(reference);
  return code;
}

/// One layer of layers.gpkg: its fields as numbers.
struct LayerContent {
  int epsg = 0;
  std::vector<std::map<std::string, double>> feature;
  std::vector<std::array<double, 4>> box;  ///< [features] x min, x max, y min, y max
};

inline LayerContent read_layer(const std::string& path, const char* name) {
  LayerContent out;
  const GdalDataset dataset = open_dataset(path, GDAL_OF_VECTOR);
  OGRLayerH layer = dataset ? GDALDatasetGetLayerByName(dataset.get(), name) : nullptr;
  if (layer == nullptr) {
    ADD_FAILURE() << path << " has no layer " << name;
    return out;
  }
  out.epsg = epsg_of(OGR_L_GetSpatialRef(layer));
  OGR_L_ResetReading(layer);
  while (OGRFeatureH feature = OGR_L_GetNextFeature(layer)) {
    auto& row = out.feature.emplace_back();
    for (int i = 0; i < OGR_F_GetFieldCount(feature); ++i)
      row[OGR_Fld_GetNameRef(OGR_F_GetFieldDefnRef(feature, i))] = OGR_F_GetFieldAsDouble(feature, i);
    OGREnvelope box{};
    OGR_G_GetEnvelope(OGR_F_GetGeometryRef(feature), &box);
    out.box.push_back({box.MinX, box.MaxX, box.MinY, box.MaxY});
    OGR_F_Destroy(feature);
  }
  return out;
}

/// Says where the tiles of the DEM and the one file differ; empty if they hold the same cells.
inline std::string difference_of_dems(const std::string& dir) {
  const Raster whole = read_raster(dir + "/dem.tif");
  std::vector<std::uint8_t> covered(whole.value.size());
  for (const auto& path : files_in(dir + "/dem", ".tif")) {
    const Raster part = read_raster(path);
    const auto column0 = std::llround((part.grid.x_min - whole.grid.x_min) / whole.grid.cell_x);
    const auto row0 = std::llround((whole.grid.y_max - part.grid.y_max) / whole.grid.cell_y);
    for (std::uint32_t r = 0; r < part.grid.num_rows; ++r)
      for (std::uint32_t c = 0; c < part.grid.num_columns; ++c) {
        const std::int64_t row = row0 + r, column = column0 + c;
        if (row < 0 || column < 0 || row >= whole.grid.num_rows || column >= whole.grid.num_columns)
          return path + " reaches beyond dem.tif";
        const auto cell = static_cast<std::size_t>(row) * whole.grid.num_columns + static_cast<std::size_t>(column);
        if (covered[cell]++ != 0) return path + " holds a cell that another tile holds";
        if (part.value[std::size_t{r} * part.grid.num_columns + c] != whole.value[cell])
          return path + ": row " + std::to_string(r) + " column " + std::to_string(c);
      }
  }
  for (std::size_t i = 0; i < covered.size(); ++i)
    if (!covered[i] && !whole.is_nodata(i)) return "dem.tif has a height that no tile has";
  return {};
}

/// Compares up to `samples` cells of dem.tif with the plane of the triangle under their centre.
inline void expect_dem_interpolates(const std::string& dir, double max_edge, std::size_t samples) {
  const Raster dem = read_raster(dir + "/dem.tif");
  const auto triangles = read_surface(dir).triangles();
  Random random(11);
  std::size_t with_height = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    const auto row = random.below(dem.grid.num_rows), column = random.below(dem.grid.num_columns);
    const double x = dem.grid.center_x(column) * 1000, y = dem.grid.center_y(row) * 1000;
    const std::size_t cell = std::size_t{row} * dem.grid.num_columns + column;
    bool any = false, close = false;
    for (const auto& t : triangles) {
      const auto cross = [&](std::size_t a, std::size_t b) {
        return static_cast<double>(t[b][0] - t[a][0]) * (y - static_cast<double>(t[a][1])) -
               static_cast<double>(t[b][1] - t[a][1]) * (x - static_cast<double>(t[a][0]));
      };
      const double c = cross(0, 1), a = cross(1, 2), b = cross(2, 0);
      if (a < 0 || b < 0 || c < 0) continue;
      double longest = 0;
      for (std::size_t e = 0; e < 3; ++e)
        longest = std::max(longest, std::hypot(static_cast<double>(t[(e + 1) % 3][0] - t[e][0]),
                                               static_cast<double>(t[(e + 1) % 3][1] - t[e][1])));
      if (max_edge > 0 && longest > max_edge * 1000) continue;
      any = true;
      const double z =
          (a * static_cast<double>(t[0][2]) + b * static_cast<double>(t[1][2]) + c * static_cast<double>(t[2][2])) /
          (a + b + c) / 1000;
      close = close || std::fabs(z - static_cast<double>(dem.value[cell])) < 1e-4;
    }
    with_height += any;
    EXPECT_EQ(any, !dem.is_nodata(cell)) << "row " << row << " column " << column;
    EXPECT_TRUE(close || !any) << "row " << row << " column " << column << ": " << dem.value[cell];
  }
  EXPECT_GT(with_height, samples / 20);
}

}  // namespace hydrotin::testing
