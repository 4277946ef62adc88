#include "hydrotin/vector.h"

#include <ogr_api.h>
#include <ogr_srs_api.h>

#include <cassert>
#include <utility>

#include "gdal_calls.h"
#include "hydrotin/finished_file.h"

namespace hydrotin {
namespace {

OGRwkbGeometryType geometry_type(VectorGeometry geometry, bool with_z) {
  switch (geometry) {
    case VectorGeometry::point:
      return with_z ? wkbPoint25D : wkbPoint;
    case VectorGeometry::line:
      return with_z ? wkbLineString25D : wkbLineString;
    case VectorGeometry::polygon:
      break;
  }
  return with_z ? wkbPolygon25D : wkbPolygon;
}

OGRFieldType field_type(FieldType type) {
  switch (type) {
    case FieldType::integer:
      return OFTInteger64;
    case FieldType::real:
      return OFTReal;
    case FieldType::text:
      break;
  }
  return OFTString;
}

using Geometry = std::unique_ptr<void, decltype(&OGR_G_DestroyGeometry)>;

Geometry make_geometry(OGRwkbGeometryType type) {
  return {OGR_G_CreateGeometry(type), OGR_G_DestroyGeometry};
}

void append(OGRGeometryH geometry, const VectorPoint& p, bool with_z) {
  with_z ? OGR_G_AddPoint(geometry, p.x, p.y, p.z) : OGR_G_AddPoint_2D(geometry, p.x, p.y);
}

}  // namespace

struct GeoPackageWriter::State {
  State(const std::filesystem::path& path) : file(path), fixed_date("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z") {}
  ~State() {
    const gdal::MessageTrap quiet;  // an unfinished file is thrown away: what GDAL says about it does not matter
    if (reference != nullptr) OSRDestroySpatialReference(reference);
    dataset.reset();
  }

  void store(int layer, Geometry geometry, std::span<const FieldValue> values);

  struct Layer {
    OGRLayerH handle = nullptr;
    bool with_z = false;
  };
  FinishedFile file;
  gdal::ThreadOption fixed_date;
  gdal::Dataset dataset;
  OGRSpatialReferenceH reference = nullptr;
  std::vector<Layer> layers;
};

void GeoPackageWriter::State::store(int layer, Geometry geometry, std::span<const FieldValue> values) {
  const OGRLayerH handle = layers[static_cast<std::size_t>(layer)].handle;
  const gdal::MessageTrap trap;
  const std::unique_ptr<void, decltype(&OGR_F_Destroy)> feature(OGR_F_Create(OGR_L_GetLayerDefn(handle)),
                                                                OGR_F_Destroy);
  assert(static_cast<int>(values.size()) == OGR_F_GetFieldCount(feature.get()));
  for (int i = 0; i < static_cast<int>(values.size()); ++i) {
    const FieldValue& value = values[static_cast<std::size_t>(i)];
    if (const auto* number = std::get_if<std::int64_t>(&value)) OGR_F_SetFieldInteger64(feature.get(), i, *number);
    if (const auto* real = std::get_if<double>(&value)) OGR_F_SetFieldDouble(feature.get(), i, *real);
    if (const auto* text = std::get_if<std::string>(&value)) OGR_F_SetFieldString(feature.get(), i, text->c_str());
  }
  OGR_F_SetGeometryDirectly(feature.get(), geometry.release());
  if (OGR_L_CreateFeature(handle, feature.get()) != OGRERR_NONE)
    trap.fail(ErrorKind::storage, file.final_path(), "cannot be written", "check the disk's free space");
}

GeoPackageWriter::GeoPackageWriter(const std::filesystem::path& path, const std::string& crs_wkt)
    : state_(std::make_unique<State>(path)) {
  gdal::register_drivers();
  const gdal::MessageTrap trap;
  for (const char* journal : {"-journal", "-wal", "-shm"}) {
    std::error_code ignored;  // leftovers of a killed writer would be replayed into the new file
    std::filesystem::remove(state_->file.temporary().string() + journal, ignored);
  }
  state_->dataset.reset(
      GDALCreate(GDALGetDriverByName("GPKG"), state_->file.temporary().c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  if (!state_->dataset) trap.fail(ErrorKind::storage, path, "cannot be created");
  if (!crs_wkt.empty()) {
    state_->reference = OSRNewSpatialReference(nullptr);
    OSRSetAxisMappingStrategy(state_->reference, OAMS_TRADITIONAL_GIS_ORDER);
    if (OSRSetFromUserInput(state_->reference, crs_wkt.c_str()) != OGRERR_NONE)
      trap.fail(ErrorKind::storage, path, "its coordinate reference system cannot be written");
  }
  if (GDALDatasetStartTransaction(state_->dataset.get(), FALSE) != OGRERR_NONE)
    trap.fail(ErrorKind::storage, path, "cannot start a transaction");
}

GeoPackageWriter::~GeoPackageWriter() = default;

int GeoPackageWriter::add_layer(const std::string& name, VectorGeometry geometry, bool with_z,
                                std::span<const VectorField> fields) {
  const gdal::MessageTrap trap;
  const OGRLayerH layer = GDALDatasetCreateLayer(state_->dataset.get(), name.c_str(), state_->reference,
                                                 geometry_type(geometry, with_z), nullptr);
  if (layer == nullptr) trap.fail(ErrorKind::storage, state_->file.final_path(), "cannot hold the layer " + name);
  for (const auto& field : fields) {
    const std::unique_ptr<void, decltype(&OGR_Fld_Destroy)> definition(
        OGR_Fld_Create(field.name.c_str(), field_type(field.type)), OGR_Fld_Destroy);
    if (OGR_L_CreateField(layer, definition.get(), FALSE) != OGRERR_NONE)
      trap.fail(ErrorKind::storage, state_->file.final_path(), "cannot hold the field " + field.name);
  }
  state_->layers.push_back({layer, with_z});
  return static_cast<int>(state_->layers.size()) - 1;
}

void GeoPackageWriter::add_point(int layer, const VectorPoint& point, std::span<const FieldValue> values) {
  const bool with_z = state_->layers[static_cast<std::size_t>(layer)].with_z;
  Geometry geometry = make_geometry(geometry_type(VectorGeometry::point, with_z));
  append(geometry.get(), point, with_z);
  state_->store(layer, std::move(geometry), values);
}

void GeoPackageWriter::add_line(int layer, std::span<const VectorPoint> line, std::span<const FieldValue> values) {
  assert(line.size() >= 2);
  const bool with_z = state_->layers[static_cast<std::size_t>(layer)].with_z;
  Geometry geometry = make_geometry(geometry_type(VectorGeometry::line, with_z));
  for (const auto& point : line) append(geometry.get(), point, with_z);
  state_->store(layer, std::move(geometry), values);
}

void GeoPackageWriter::add_box(int layer, double x_min, double y_min, double x_max, double y_max,
                               std::span<const FieldValue> values) {
  const VectorPoint ring[] = {{x_min, y_min, 0}, {x_max, y_min, 0}, {x_max, y_max, 0}, {x_min, y_max, 0}};
  add_polygon(layer, ring, values);
}

void GeoPackageWriter::add_polygon(int layer, std::span<const VectorPoint> ring, std::span<const FieldValue> values) {
  const std::vector<VectorPoint> shell(ring.begin(), ring.end());
  add_polygon(layer, std::span(&shell, 1), values);
}

void GeoPackageWriter::add_polygon(int layer, std::span<const std::vector<VectorPoint>> rings,
                                   std::span<const FieldValue> values) {
  assert(!rings.empty());
  const bool with_z = state_->layers[static_cast<std::size_t>(layer)].with_z;
  Geometry polygon = make_geometry(geometry_type(VectorGeometry::polygon, with_z));
  for (const auto& ring : rings) {
    assert(ring.size() >= 3);
    Geometry part = make_geometry(wkbLinearRing);
    for (const auto& point : ring) append(part.get(), point, with_z);
    append(part.get(), ring.front(), with_z);
    OGR_G_AddGeometryDirectly(polygon.get(), part.release());
  }
  state_->store(layer, std::move(polygon), values);
}

void GeoPackageWriter::finish() {
  const gdal::MessageTrap trap;
  if (GDALDatasetCommitTransaction(state_->dataset.get()) != OGRERR_NONE)
    trap.fail(ErrorKind::storage, state_->file.final_path(), "cannot be committed", "check the disk's free space");
  gdal::close_written(std::move(state_->dataset), trap, state_->file.final_path());
  state_->file.publish();
}

}  // namespace hydrotin
