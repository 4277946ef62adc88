#include "hydrotin/vector_reader.h"

#include <gtest/gtest.h>

#include "expected_error.h"
#include "hydrotin/crs.h"
#include "temporary_folder.h"

namespace hydrotin {
namespace {

using testing::error_of;
using testing::TemporaryFolder;
using testing::write_text;

const char* const kMixed = R"({"type":"FeatureCollection","features":[
  {"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[3,45],[3.001,45]]}},
  {"type":"Feature","properties":{},"geometry":null},
  {"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[3,45]}},
  {"type":"Feature","properties":{},"geometry":{"type":"MultiLineString",
    "coordinates":[[[3,45],[3,45.001],[3,45.002]],[[3,45,7],[3.002,45,8]]]}},
  {"type":"Feature","properties":{},"geometry":{"type":"GeometryCollection","geometries":[
    {"type":"Polygon","coordinates":[[[3,45],[3.1,45],[3.1,45.1],[3,45]]]},
    {"type":"LineString","coordinates":[[3,45],[3.003,45]]}]}}]})";

TEST(VectorReader, Lines_AreFlattenedAndCounted) {
  const TemporaryFolder folder;
  write_text(folder / "mixed.geojson", kMixed);
  const VectorParts lines = read_vector(folder / "mixed.geojson", {});
  EXPECT_EQ(lines.num_features, 5u);
  EXPECT_EQ(lines.num_null, 1u);
  EXPECT_EQ(lines.num_other, 2u);  // the point and the polygon
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines.feature[1], lines.feature[2]);
  EXPECT_EQ(lines.ring(1).size(), 3u);
  EXPECT_EQ(lines.ring(2)[1], (std::array<double, 3>{3.002, 45, 8}));
  const VectorParts polygons = read_vector(folder / "mixed.geojson", {VectorGeometry::polygon, {}, {}});
  ASSERT_EQ(polygons.size(), 1u);
  EXPECT_EQ(polygons.ring(0).size(), 4u);
}

TEST(VectorReader, Reprojects) {
  const TemporaryFolder folder;
  write_text(folder / "mixed.geojson", kMixed);
  // The central meridian of EPSG:2154 is 3 degrees east: x = 700000 there.
  const std::string lambert = parse_crs("EPSG:2154", "test").wkt;
  const VectorParts lines = read_vector(folder / "mixed.geojson", {VectorGeometry::line, lambert, {}});
  EXPECT_FALSE(lines.crs_was_missing);
  EXPECT_NEAR(lines.ring(0)[0][0], 700000, 1e-3);
  EXPECT_NEAR(lines.ring(0)[1][0] - lines.ring(0)[0][0], 78.8, 0.2);  // 0.001 degrees at 45 degrees north
}

TEST(VectorReader, MissingCrs_IsTheOneGivenOrThatOfTheTerrain) {
  const TemporaryFolder folder;
  {
    GeoPackageWriter writer(folder / "lines.gpkg", "");
    const int layer = writer.add_layer("rivers", VectorGeometry::line, false, {});
    const VectorPoint line[] = {{3, 45, 0}, {3.001, 45, 0}};
    writer.add_line(layer, line, {});
    writer.finish();
  }
  const std::string lambert = parse_crs("EPSG:2154", "test").wkt, degrees = parse_crs("EPSG:4326", "test").wkt;
  const VectorParts as_is = read_vector(folder / "lines.gpkg", {VectorGeometry::line, {}, {}});
  EXPECT_EQ(as_is.ring(0)[0][0], 3);
  const VectorParts given = read_vector(folder / "lines.gpkg", {VectorGeometry::line, lambert, degrees});
  EXPECT_TRUE(given.crs_was_missing);
  EXPECT_NEAR(given.ring(0)[0][0], 700000, 1e-3);
  const VectorParts taken = read_vector(folder / "lines.gpkg", {VectorGeometry::line, lambert, {}});
  EXPECT_EQ(taken.ring(0)[0][0], 3);
}

TEST(VectorReader, AttributesComeAsTextForEveryPart) {
  const TemporaryFolder folder;
  write_text(folder / "a.geojson", R"({"type":"FeatureCollection","features":[
    {"type":"Feature","properties":{"name":"Lech","n":3},"geometry":{"type":"MultiLineString","coordinates":
      [[[0,0],[1,1]],[[1,1],[2,2]]]}},
    {"type":"Feature","properties":{"name":null},"geometry":{"type":"LineString","coordinates":[[0,0],[1,0]]}}]})");
  const VectorParts parts = read_vector(folder / "a.geojson", {VectorGeometry::line, {}, {}, {"n", "name"}});
  EXPECT_EQ(parts.value, (std::vector<std::string>{"3", "Lech", "3", "Lech", "", ""}));
  const VectorReadOptions unknown{VectorGeometry::line, {}, {}, {"depth"}};
  const std::string text =
      error_of([&] { static_cast<void>(read_vector(folder / "a.geojson", unknown)); }, ErrorKind::input);
  EXPECT_NE(text.find("depth"), std::string::npos);
}

TEST(VectorReader, BadFiles_GetAClearError) {
  const TemporaryFolder folder;
  EXPECT_NE(
      error_of([&] { static_cast<void>(read_vector(folder / "none.gpkg", {})); }, ErrorKind::input).find("none.gpkg"),
      std::string::npos);
  write_text(folder / "text.gpkg", "no geopackage");
  error_of([&] { static_cast<void>(read_vector(folder / "text.gpkg", {})); }, ErrorKind::input);
}

}  // namespace
}  // namespace hydrotin
