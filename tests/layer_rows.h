#pragma once

#include <gdal.h>
#include <ogr_api.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <vector>

/// The content of the layers of a vector file, for comparisons.

namespace hydrotin::testing {

/// A feature: the places of its points, integers and texts as text; reals and heights as numbers.
struct LayerRow {
  std::string place, text;
  std::vector<double> real;
  friend bool operator<(const LayerRow& a, const LayerRow& b) {
    return std::tie(a.place, a.text, a.real) < std::tie(b.place, b.text, b.real);
  }
};

struct LayerRows {
  std::vector<std::string> field;  ///< without those hidden
  std::vector<LayerRow> row;       ///< ascending
};

inline std::map<std::string, LayerRows> read_layers(const std::string& path, const std::set<std::string>& hidden) {
  GDALAllRegister();
  const std::unique_ptr<void, decltype(&GDALClose)> file(
      GDALOpenEx(path.c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr), GDALClose);
  std::map<std::string, LayerRows> out;
  for (int l = 0; file && l < GDALDatasetGetLayerCount(file.get()); ++l) {
    OGRLayerH layer = GDALDatasetGetLayer(file.get(), l);
    LayerRows& rows = out[OGR_L_GetName(layer)];
    OGRFeatureDefnH fields = OGR_L_GetLayerDefn(layer);
    for (int f = 0; f < OGR_FD_GetFieldCount(fields); ++f)
      rows.field.emplace_back(OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(fields, f)));
    while (OGRFeatureH feature = OGR_L_GetNextFeature(layer)) {
      LayerRow& row = rows.row.emplace_back();
      for (int f = 0; f < OGR_FD_GetFieldCount(fields); ++f) {
        if (hidden.contains(rows.field[static_cast<std::size_t>(f)])) continue;
        if (OGR_Fld_GetType(OGR_FD_GetFieldDefn(fields, f)) == OFTReal)
          row.real.push_back(OGR_F_GetFieldAsDouble(feature, f));
        else
          row.text += OGR_F_GetFieldAsString(feature, f) + std::string(";");
      }
      OGRGeometryH shape = OGR_F_GetGeometryRef(feature);
      for (int p = 0; shape != nullptr && p < OGR_G_GetPointCount(shape); ++p) {
        char text[80];
        std::snprintf(text, sizeof text, "%.4f %.4f;", OGR_G_GetX(shape, p), OGR_G_GetY(shape, p));
        row.place += text;
        row.real.push_back(OGR_G_GetZ(shape, p));
      }
      OGR_F_Destroy(feature);
    }
    std::erase_if(rows.field, [&](const std::string& name) { return hidden.contains(name); });
    std::sort(rows.row.begin(), rows.row.end());
  }
  return out;
}

/// @param num_reals  so many of the reals of each feature must be equal, to 0.0001.
inline void expect_same_rows(const LayerRows& a, const LayerRows& b, std::size_t num_reals) {
  ASSERT_EQ(a.row.size(), b.row.size());
  for (std::size_t i = 0; i < a.row.size(); ++i) {
    ASSERT_EQ(a.row[i].place, b.row[i].place);
    ASSERT_EQ(a.row[i].text, b.row[i].text) << a.row[i].place;
    ASSERT_EQ(a.row[i].real.size(), b.row[i].real.size()) << a.row[i].place;
    for (std::size_t k = 0; k < std::min(num_reals, a.row[i].real.size()); ++k)
      ASSERT_NEAR(a.row[i].real[k], b.row[i].real[k], 1e-4) << a.row[i].place << a.row[i].text;
  }
}

}  // namespace hydrotin::testing
