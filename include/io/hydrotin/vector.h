#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

/// GeoPackage writer: layers of points, lines and boxes with typed fields.
///
/// One transaction holds all features, so that millions of them are written in a minute; features keep the order in
/// which they came and no time stamp is stored, so that the same features give the same bytes. The file appears under
/// its name only by `finish()`.
///
/// Memory   Bounded: features go to the file as they come.
/// Threads  One writer belongs to one thread.
/// Errors   Error(storage) from every function.

namespace hydrotin {

enum class VectorGeometry : std::uint8_t { point, line, polygon };
enum class FieldType : std::uint8_t { integer, real, text };

struct VectorField {
  std::string name;
  FieldType type = FieldType::real;
};

/// One value of a field; its alternative must fit the field's type.
using FieldValue = std::variant<std::int64_t, double, std::string>;

struct VectorPoint {
  double x = 0, y = 0, z = 0;
};

class GeoPackageWriter {
 public:
  /// @param crs_wkt  CRS of all layers; empty = unknown.
  GeoPackageWriter(const std::filesystem::path& path, const std::string& crs_wkt);
  ~GeoPackageWriter();
  GeoPackageWriter(const GeoPackageWriter&) = delete;
  GeoPackageWriter& operator=(const GeoPackageWriter&) = delete;

  /// Adds a layer and returns its number. `with_z`: geometries carry heights.
  int add_layer(const std::string& name, VectorGeometry geometry, bool with_z, std::span<const VectorField> fields);

  /// Adds one feature. `values` in the order of the layer's fields.
  void add_point(int layer, const VectorPoint& point, std::span<const FieldValue> values);
  /// @param line  at least two points.
  void add_line(int layer, std::span<const VectorPoint> line, std::span<const FieldValue> values);
  /// The rectangle of a tile.
  void add_box(int layer, double x_min, double y_min, double x_max, double y_max, std::span<const FieldValue> values);
  /// @param ring  at least three points, first not repeated.
  void add_polygon(int layer, std::span<const VectorPoint> ring, std::span<const FieldValue> values);
  /// The same with holes: rings after the first.
  void add_polygon(int layer, std::span<const std::vector<VectorPoint>> rings, std::span<const FieldValue> values);

  /// Commits, closes and gives the file its final name. Without it nothing is left behind.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace hydrotin
