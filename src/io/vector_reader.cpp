#include "hydrotin/vector_reader.h"

#include <ogr_api.h>
#include <ogr_srs_api.h>

#include <cmath>
#include <memory>
#include <string_view>
#include <type_traits>

#include "gdal_calls.h"

namespace hydrotin {
namespace {

struct ReferenceRelease {
  void operator()(OGRSpatialReferenceH reference) const { OSRRelease(reference); }
};
using Reference = std::unique_ptr<std::remove_pointer_t<OGRSpatialReferenceH>, ReferenceRelease>;
struct TransformationDestroyer {
  void operator()(OGRCoordinateTransformationH t) const { OCTDestroyCoordinateTransformation(t); }
};
using Transformation = std::unique_ptr<std::remove_pointer_t<OGRCoordinateTransformationH>, TransformationDestroyer>;
using Feature = std::unique_ptr<std::remove_pointer_t<OGRFeatureH>, decltype(&OGR_F_Destroy)>;
using Geometry = std::unique_ptr<std::remove_pointer_t<OGRGeometryH>, decltype(&OGR_G_DestroyGeometry)>;

/// The CRS a layer names. A GeoPackage without one is read as "Undefined Cartesian" or "Undefined geographic": that is
/// none.
OGRSpatialReferenceH named_reference(OGRLayerH layer) {
  OGRSpatialReferenceH reference = OGR_L_GetSpatialRef(layer);
  if (reference == nullptr) return nullptr;
  const char* name = OSRGetName(reference);
  return name != nullptr && std::string_view(name).starts_with("Undefined ") ? nullptr : reference;
}

class Reader {
 public:
  Reader(const std::filesystem::path& path, const VectorReadOptions& options)
      : path_(path),
        options_(options),
        dataset_(gdal::open(path, GDAL_OF_VECTOR)),
        is_field_found_(options.fields.size(), 0) {}

  VectorParts read() {
    const int layers = GDALDatasetGetLayerCount(dataset_.get());
    const gdal::MessageTrap trap;
    if (layers == 0) trap.fail(ErrorKind::input, path_, "has no vector layer");
    for (int i = 0; i < layers; ++i) read_layer(static_cast<std::uint32_t>(i));
    for (std::size_t i = 0; i < options_.fields.size(); ++i)
      if (is_field_found_[i] == 0)
        trap.fail(ErrorKind::input, path_, "has no attribute " + options_.fields[i], "see its layers with ogrinfo");
    return std::move(parts_);
  }

 private:
  [[nodiscard]] Reference reference_of(const std::string& wkt, const gdal::MessageTrap& trap) const {
    Reference reference(OSRNewSpatialReference(nullptr));
    if (OSRSetFromUserInput(reference.get(), wkt.c_str()) != OGRERR_NONE)
      trap.fail(ErrorKind::config, path_, "the CRS to read it in is not understood");
    OSRSetAxisMappingStrategy(reference.get(), OAMS_TRADITIONAL_GIS_ORDER);
    return reference;
  }

  [[nodiscard]] Transformation transformation_of(OGRLayerH layer, const gdal::MessageTrap& trap) const {
    if (options_.target_wkt.empty()) return nullptr;
    Reference source;
    if (OGRSpatialReferenceH own = named_reference(layer); own != nullptr) {
      source.reset(OSRClone(own));
      OSRSetAxisMappingStrategy(source.get(), OAMS_TRADITIONAL_GIS_ORDER);
    } else if (!options_.missing_crs_wkt.empty()) {
      source = reference_of(options_.missing_crs_wkt, trap);
    } else {
      return nullptr;
    }
    const Reference target = reference_of(options_.target_wkt, trap);
    if (OSRIsSame(source.get(), target.get()) != 0) return nullptr;
    Transformation transformation(OCTNewCoordinateTransformation(source.get(), target.get()));
    if (!transformation) trap.fail(ErrorKind::input, path_, "cannot be reprojected to the CRS of the terrain");
    return transformation;
  }

  void read_layer(std::uint32_t index) {
    const gdal::MessageTrap trap;
    OGRLayerH layer = GDALDatasetGetLayer(dataset_.get(), static_cast<int>(index));
    const Transformation transformation = transformation_of(layer, trap);
    OGR_L_ResetReading(layer);
    field_.clear();
    for (std::size_t i = 0; i < options_.fields.size(); ++i) {
      field_.push_back(OGR_FD_GetFieldIndex(OGR_L_GetLayerDefn(layer), options_.fields[i].c_str()));
      if (field_.back() >= 0) is_field_found_[i] = 1;
    }
    while (true) {
      const Feature feature(OGR_L_GetNextFeature(layer), OGR_F_Destroy);
      if (!feature) break;
      ++parts_.num_features;
      if (named_reference(layer) == nullptr) parts_.crs_was_missing = true;
      read_feature(feature.get(), index, transformation.get(), trap);
    }
    if (trap.has_failure()) trap.fail(ErrorKind::input, path_, "cannot be read to its end");
  }

  void read_feature(OGRFeatureH feature, std::uint32_t layer, OGRCoordinateTransformationH transformation,
                    const gdal::MessageTrap& trap) {
    OGRGeometryH own = OGR_F_GetGeometryRef(feature);
    if (own == nullptr || OGR_G_IsEmpty(own) != 0) {
      ++parts_.num_null;
      return;
    }
    const Geometry geometry(OGR_G_GetLinearGeometry(own, 0, nullptr), OGR_G_DestroyGeometry);
    const auto id = static_cast<std::int64_t>(OGR_F_GetFID(feature));
    if (!geometry) trap.fail(ErrorKind::input, path_, "feature " + std::to_string(id) + " cannot be understood");
    if (transformation != nullptr && OGR_G_Transform(geometry.get(), transformation) != OGRERR_NONE)
      trap.fail(ErrorKind::input, path_, "feature " + std::to_string(id) + " cannot be reprojected",
                "its coordinates do not fit the CRS that the file names");
    values_.clear();
    for (const int f : field_)
      values_.emplace_back(f >= 0 && OGR_F_IsFieldSetAndNotNull(feature, f) != 0 ? OGR_F_GetFieldAsString(feature, f)
                                                                                 : "");
    flatten(geometry.get(), id, layer, trap);
  }

  void flatten(OGRGeometryH geometry, std::int64_t id, std::uint32_t layer, const gdal::MessageTrap& trap) {
    const OGRwkbGeometryType type = wkbFlatten(OGR_G_GetGeometryType(geometry));
    const bool is_line = type == wkbLineString, is_polygon = type == wkbPolygon;
    if (type == wkbMultiLineString || type == wkbMultiPolygon || type == wkbGeometryCollection ||
        type == wkbMultiPoint) {
      for (int i = 0; i < OGR_G_GetGeometryCount(geometry); ++i)
        flatten(OGR_G_GetGeometryRef(geometry, i), id, layer, trap);
      return;
    }
    const bool is_wanted = options_.geometry == VectorGeometry::line ? is_line : is_polygon;
    if (!is_wanted || OGR_G_IsEmpty(geometry) != 0 || (is_line && OGR_G_GetPointCount(geometry) < 2)) {
      ++parts_.num_other;
      return;
    }
    if (is_line) add_ring(geometry, id, trap);
    for (int i = 0; is_polygon && i < OGR_G_GetGeometryCount(geometry); ++i)
      add_ring(OGR_G_GetGeometryRef(geometry, i), id, trap);
    parts_.ring_begin.push_back(parts_.point_begin.size() - 1);
    parts_.feature.push_back(id);
    parts_.layer.push_back(layer);
    parts_.value.insert(parts_.value.end(), values_.begin(), values_.end());
  }

  void add_ring(OGRGeometryH ring, std::int64_t id, const gdal::MessageTrap& trap) {
    for (int i = 0; i < OGR_G_GetPointCount(ring); ++i) {
      double x = 0, y = 0, z = 0;
      OGR_G_GetPoint(ring, i, &x, &y, &z);
      if (!std::isfinite(x) || !std::isfinite(y))
        trap.fail(ErrorKind::input, path_, "feature " + std::to_string(id) + " has a coordinate that is not finite");
      parts_.point.push_back({x, y, std::isfinite(z) ? z : 0.0});
    }
    parts_.point_begin.push_back(parts_.point.size());
  }

  const std::filesystem::path& path_;
  const VectorReadOptions& options_;
  gdal::Dataset dataset_;
  std::vector<std::uint8_t> is_field_found_;  // in some layer
  std::vector<int> field_;                    // of the layer: index or negative
  std::vector<std::string> values_;           // of the feature
  VectorParts parts_;
};

}  // namespace

VectorParts read_vector(const std::filesystem::path& path, const VectorReadOptions& options) {
  return Reader(path, options).read();
}

}  // namespace hydrotin
