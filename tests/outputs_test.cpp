#include <cpl_conv.h>
#include <gdal.h>
#include <gtest/gtest.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>

#include <cmath>
#include <memory>
#include <numeric>
#include <random>

#include "expected_error.h"
#include "hydrotin/crs.h"
#include "hydrotin/error.h"
#include "hydrotin/finished_file.h"
#include "hydrotin/raster.h"
#include "hydrotin/vector.h"
#include "shared_data.h"
#include "temporary_folder.h"

namespace hydrotin {
namespace {

using testing::error_of;
using testing::read_text;
using testing::TemporaryFolder;
using testing::write_text;

struct Close {
  void operator()(GDALDatasetH dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<void, Close>;

Dataset open(const std::filesystem::path& path, unsigned flags) {
  GDALAllRegister();
  return Dataset(GDALOpenEx(path.c_str(), flags | GDAL_OF_VERBOSE_ERROR, nullptr, nullptr, nullptr));
}

/// A slope with noise, some cells without height.
std::vector<float> heights(const RasterGrid& grid, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> value(grid.size());
  for (std::size_t i = 0; i < value.size(); ++i)
    value[i] = random() % 17 == 0
                   ? kNodata
                   : static_cast<float>(i % grid.num_columns) + static_cast<float>(random() % 1000) * 0.001F;
  return value;
}

const std::string& lambert93() {
  static const std::string wkt = parse_crs("EPSG:2154", "input.crs").wkt;
  return wkt;
}

TEST(Crs, UserInput_BecomesWktAndName) {
  const Crs crs = parse_crs("EPSG:2154", "input.crs");
  EXPECT_EQ(crs.name, "EPSG:2154");
  EXPECT_TRUE(crs.is_projected);
  EXPECT_EQ(crs.metres_per_unit, 1.0);
  EXPECT_EQ(parse_crs(crs.wkt, "input.crs").name, "EPSG:2154");
  EXPECT_EQ(parse_crs("epsg:26911", "input.crs").name, "EPSG:26911");
  EXPECT_FALSE(parse_crs("EPSG:4326", "input.crs").is_projected);
  EXPECT_NEAR(parse_crs("EPSG:2229", "input.crs").metres_per_unit, 0.3048006, 1e-6);
}

TEST(Crs, Nonsense_IsAConfigErrorThatNamesTheKey) {
  for (const char* text :
       {"", "  ", "Lambert", "EPSG:1", "EPSG:", "PROJCS[\"x\"", "/etc/passwd", "http://example.org/crs"}) {
    SCOPED_TRACE(text);
    const auto message = error_of([&] { (void)parse_crs(text, "input.crs"); }, ErrorKind::config);
    EXPECT_EQ(message.rfind("input.crs: ", 0), 0U) << message;
    EXPECT_NE(message.find("EPSG:2154"), std::string::npos) << message;
  }
}

TEST(Crs, FileWkt_IsNamedAndBroken_IsAnInputError) {
  EXPECT_TRUE(crs_from_wkt("", "a.las").is_unknown());
  EXPECT_EQ(crs_from_wkt(lambert93(), "a.las").name, "EPSG:2154");
  EXPECT_NE(error_of([] { (void)crs_from_wkt("PROJCS[nothing", "a.las"); }, ErrorKind::input).find("a.las"),
            std::string::npos);
}

TEST(Crs, Comparison_IgnoresNamesAndForms) {
  OGRSpatialReferenceH reference = OSRNewSpatialReference(nullptr);
  ASSERT_EQ(OSRImportFromEPSG(reference, 2154), OGRERR_NONE);
  char* wkt1 = nullptr;
  ASSERT_EQ(OSRExportToWkt(reference, &wkt1), OGRERR_NONE);
  const Crs old_form = crs_from_wkt(wkt1, "a.las");
  CPLFree(wkt1);
  OSRDestroySpatialReference(reference);
  EXPECT_TRUE(same_crs(old_form, parse_crs("EPSG:2154", "k")));
  EXPECT_FALSE(same_crs(parse_crs("EPSG:2154", "k"), parse_crs("EPSG:26911", "k")));
  EXPECT_FALSE(same_crs(parse_crs("EPSG:2154", "k"), Crs{}));
  EXPECT_TRUE(same_crs(Crs{}, Crs{}));
}

TEST(FinishedFile, OldResult_StaysUntilPublished) {
  const TemporaryFolder folder;
  write_text(folder / "a.txt", "old");
  {
    FinishedFile file(folder / "a.txt");
    write_text(file.temporary(), "half");
  }
  EXPECT_EQ(read_text(folder / "a.txt"), "old");
  FinishedFile file(folder / "a.txt");
  EXPECT_FALSE(std::filesystem::exists(file.temporary()));
  write_text(file.temporary(), "new");
  file.publish();
  EXPECT_EQ(read_text(folder / "a.txt"), "new");
  EXPECT_FALSE(std::filesystem::exists(file.temporary()));
}

TEST(FinishedFile, FolderThatCannotBeMade_IsAStorageError) {
  const TemporaryFolder folder;
  write_text(folder / "file", "");
  const auto message = error_of([&] { FinishedFile file(folder / "file" / "below.tif"); }, ErrorKind::storage);
  EXPECT_NE(message.find("cannot make this folder"), std::string::npos) << message;
}

TEST(Raster, GeoTiff_RoundTripsBitForBit) {
  const TemporaryFolder folder;
  for (const auto& [columns, rows] : {std::pair{1U, 1U}, {3U, 2U}, {300U, 517U}}) {
    const RasterGrid grid{700000.5, 6600000.25, 0.5, 0.5, columns, rows};
    const auto value = heights(grid, columns);
    write_geotiff(folder / "a.tif", grid, value, lambert93());
    const Raster back = read_raster(folder / "a.tif");
    EXPECT_EQ(back.grid, grid);
    EXPECT_EQ(back.value, value);
    EXPECT_TRUE(back.has_nodata);
    EXPECT_EQ(back.nodata, kNodata);
    EXPECT_TRUE(same_crs(crs_from_wkt(back.crs_wkt, "a.tif"), parse_crs("EPSG:2154", "k")));
    const auto first = read_text(folder / "a.tif");
    write_geotiff(folder / "a.tif", grid, value, lambert93());
    EXPECT_EQ(read_text(folder / "a.tif"), first);
  }
  const auto dataset = open(folder / "a.tif", GDAL_OF_RASTER);
  const auto* structure = GDALGetMetadataItem(dataset.get(), "COMPRESSION", "IMAGE_STRUCTURE");
  ASSERT_NE(structure, nullptr);
  EXPECT_STREQ(structure, "DEFLATE");
}

TEST(Raster, BrokenFiles_AreInputErrors) {
  const TemporaryFolder folder;
  EXPECT_NE(error_of([&] { (void)read_raster(folder / "none.tif"); }, ErrorKind::input).find("none.tif"),
            std::string::npos);
  write_text(folder / "text.tif", "no raster");
  error_of([&] { (void)read_raster(folder / "text.tif"); }, ErrorKind::input);
  const RasterGrid grid{0, 0, 1, 1, 600, 600};
  write_geotiff(folder / "a.tif", grid, heights(grid, 1), "");
  EXPECT_NE(error_of([&] { (void)read_raster(folder / "a.tif", 2); }, ErrorKind::input).find("band 2"),
            std::string::npos);
  error_of([&] { (void)read_raster(folder / "a.tif", 1, 1000); }, ErrorKind::input);
  const auto bytes = read_text(folder / "a.tif");
  write_text(folder / "cut.tif", bytes.substr(0, bytes.size() / 2));
  error_of([&] { (void)read_raster(folder / "cut.tif"); }, ErrorKind::input);
}

/// Tiles of one grid, 2 x 2, with their heights as one array.
struct TiledRaster {
  RasterGrid grid{238933, 3765382, 1, 1, 1100, 900};
  std::vector<float> value = heights(grid, 7);
  std::vector<std::filesystem::path> tiles;

  explicit TiledRaster(const TemporaryFolder& folder) {
    const std::uint32_t columns[] = {0, 611, 1100}, rows[] = {0, 333, 900};
    for (int r = 0; r < 2; ++r)
      for (int c = 0; c < 2; ++c) {
        RasterGrid part{grid.x_min + columns[c],     grid.y_max - rows[r], 1, 1,
                        columns[c + 1] - columns[c], rows[r + 1] - rows[r]};
        std::vector<float> cells;
        for (std::uint32_t row = rows[r]; row < rows[r + 1]; ++row)
          cells.insert(cells.end(), value.begin() + row * 1100 + columns[c],
                       value.begin() + row * 1100 + columns[c + 1]);
        tiles.push_back(folder / ("tiles/" + std::to_string(r) + std::to_string(c) + ".tif"));
        write_geotiff(tiles.back(), part, cells, lambert93());
      }
  }
};

TEST(Raster, Mosaic_HoldsEveryCellOfTheTiles) {
  const TemporaryFolder folder;
  const TiledRaster tiled(folder);
  write_virtual_mosaic(folder / "dem.vrt", tiled.tiles);
  write_cloud_optimized_geotiff(folder / "dem.tif", tiled.tiles);
  for (const char* name : {"dem.vrt", "dem.tif"}) {
    SCOPED_TRACE(name);
    const Raster back = read_raster(folder / name);
    EXPECT_EQ(back.grid, tiled.grid);
    EXPECT_EQ(back.value, tiled.value);
    EXPECT_EQ(back.nodata, kNodata);
    EXPECT_EQ(crs_from_wkt(back.crs_wkt, name).name, "EPSG:2154");
  }
  EXPECT_NE(read_text(folder / "dem.vrt").find(">tiles/00.tif<"), std::string::npos);
}

TEST(Raster, CloudOptimized_HasOverviewsAndTheSameBytesForAnyThreadsAndCache) {
  const TemporaryFolder folder;
  const TiledRaster tiled(folder);
  write_cloud_optimized_geotiff(folder / "a.tif", tiled.tiles);
  const auto bytes = read_text(folder / "a.tif");
  const auto cache_before = GDALGetCacheMax64();
  write_cloud_optimized_geotiff(folder / "b.tif", tiled.tiles, {.cache_bytes = 4 << 20, .num_threads = 2});
  EXPECT_EQ(read_text(folder / "b.tif"), bytes);
  EXPECT_EQ(GDALGetCacheMax64(), cache_before);
  const auto dataset = open(folder / "a.tif", GDAL_OF_RASTER);
  EXPECT_GE(GDALGetOverviewCount(GDALGetRasterBand(dataset.get(), 1)), 1);
  EXPECT_STREQ(GDALGetMetadataItem(dataset.get(), "LAYOUT", "IMAGE_STRUCTURE"), "COG");
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 3U) << "a.tif, b.tif and tiles: no temporary file is left";
}

TEST(Raster, TilesThatDoNotFit_AreRefused) {
  const TemporaryFolder folder;
  TiledRaster tiled(folder);
  const RasterGrid shifted{240033.5, 3765382, 1, 1, 4, 4};
  write_geotiff(folder / "shifted.tif", shifted, heights(shifted, 1), lambert93());
  const RasterGrid coarse{240033, 3765382, 2, 2, 4, 4};
  write_geotiff(folder / "coarse.tif", coarse, heights(coarse, 1), lambert93());
  const RasterGrid other{240033, 3765382, 1, 1, 4, 4};
  write_geotiff(folder / "other.tif", other, heights(other, 1), parse_crs("EPSG:26911", "k").wkt);
  for (const char* name : {"shifted.tif", "coarse.tif", "other.tif"}) {
    SCOPED_TRACE(name);
    auto tiles = tiled.tiles;
    tiles.push_back(folder / name);
    error_of([&] { write_virtual_mosaic(folder / "dem.vrt", tiles); }, ErrorKind::input);
    error_of([&] { write_cloud_optimized_geotiff(folder / "dem.tif", tiles); }, ErrorKind::input);
    EXPECT_FALSE(std::filesystem::exists(folder / "dem.tif"));
    EXPECT_FALSE(std::filesystem::exists(folder / "dem.vrt"));
  }
}

TEST(Hillshade, Image_LiesWhereTheDemLies) {
  const TemporaryFolder folder;
  const TiledRaster tiled(folder);
  write_cloud_optimized_geotiff(folder / "dem.tif", tiled.tiles);
  write_hillshade(folder / "hillshade.png", folder / "dem.tif", 200);
  const auto image = open(folder / "hillshade.png", GDAL_OF_RASTER);
  ASSERT_TRUE(image);
  EXPECT_EQ(GDALGetRasterXSize(image.get()), 200);
  EXPECT_EQ(GDALGetRasterYSize(image.get()), 164);
  double transform[6];
  ASSERT_EQ(GDALGetGeoTransform(image.get(), transform), CE_None);
  EXPECT_NEAR(transform[0], 238933, 1e-6);
  EXPECT_NEAR(transform[3], 3765382, 1e-6);
  EXPECT_NEAR(transform[1], 5.5, 1e-9);
  EXPECT_EQ(crs_from_wkt(GDALGetProjectionRef(image.get()), "hillshade.png").name, "EPSG:2154");
  EXPECT_TRUE(std::filesystem::exists(folder / "hillshade.wld"));
}

TEST(Hillshade, Slope_IsShadedAsItsNormalSays) {
  const TemporaryFolder folder;
  const RasterGrid grid{0, 64, 1, 1, 64, 64};
  std::vector<float> value(grid.size());
  for (std::size_t i = 0; i < value.size(); ++i) value[i] = 0.5F * static_cast<float>(i % 64);  // rises to the east
  std::fill(value.begin(), value.begin() + 64 * 8, kNodata);
  write_geotiff(folder / "dem.tif", grid, value, lambert93());
  write_hillshade(folder / "hillshade.png", folder / "dem.tif");
  const Raster image = read_raster(folder / "hillshade.png");
  // Normal (-0.5, 0, 1) / |.|, light from azimuth 315, altitude 45: (-1/2, 1/2, 1/sqrt 2).
  const double cosine = (0.25 + std::sqrt(0.5)) / std::sqrt(1.25);
  EXPECT_NEAR(image.value[64 * 32 + 32], 1 + 254 * cosine, 1.0);
  EXPECT_TRUE(image.has_nodata);
  EXPECT_TRUE(image.is_nodata(0));
  EXPECT_FALSE(image.is_nodata(64 * 63));
}

TEST(Hillshade, TinyDem_GivesAnImage) {
  const TemporaryFolder folder;
  for (const auto& [columns, rows] : {std::pair{1U, 1U}, {2U, 1U}, {2U, 2U}, {1U, 5U}}) {
    const RasterGrid grid{0, 64, 1, 1, columns, rows};
    write_geotiff(folder / "dem.tif", grid, std::vector<float>(grid.size(), 3.0F), lambert93());
    write_hillshade(folder / "hillshade.png", folder / "dem.tif");
    EXPECT_EQ(read_raster(folder / "hillshade.png").grid.num_columns, columns);
  }
}

TEST(GeoPackage, Layers_RoundTrip) {
  const TemporaryFolder folder;
  const VectorField tile_fields[] = {{"id", FieldType::integer}, {"name", FieldType::text}};
  const VectorField pit_fields[] = {{"z_before", FieldType::real}, {"depth", FieldType::real}};
  const auto write = [&](const std::filesystem::path& path) {
    GeoPackageWriter writer(path, lambert93());
    const int tiles = writer.add_layer("tiles", VectorGeometry::polygon, false, tile_fields);
    const int pits = writer.add_layer("pits", VectorGeometry::point, true, pit_fields);
    const int rivers = writer.add_layer("rivers", VectorGeometry::line, true, {});
    for (std::int64_t i = 0; i < 300; ++i) {
      const auto x = static_cast<double>(i);
      writer.add_box(tiles, x, 0, x + 1, 2, std::vector<FieldValue>{i, "tile " + std::to_string(i)});
      writer.add_point(pits, {x, -x, 0.25 * x}, std::vector<FieldValue>{0.1 * x, 1e-3});
    }
    const VectorPoint line[] = {{0, 0, 9}, {1, 1, 8}, {2, 3, 7}};
    writer.add_line(rivers, line, {});
    EXPECT_FALSE(std::filesystem::exists(path));
    writer.finish();
  };
  write(folder / "a.gpkg");
  const auto dataset = open(folder / "a.gpkg", GDAL_OF_VECTOR);
  ASSERT_TRUE(dataset);
  ASSERT_EQ(GDALDatasetGetLayerCount(dataset.get()), 3);
  OGRLayerH tiles = GDALDatasetGetLayerByName(dataset.get(), "tiles");
  OGRLayerH pits = GDALDatasetGetLayerByName(dataset.get(), "pits");
  OGRLayerH rivers = GDALDatasetGetLayerByName(dataset.get(), "rivers");
  for (OGRLayerH layer : {tiles, pits, rivers}) {
    OGRSpatialReferenceH reference = OGR_L_GetSpatialRef(layer);
    ASSERT_NE(reference, nullptr);
    EXPECT_STREQ(OSRGetAuthorityCode(reference, nullptr), "2154");
  }
  ASSERT_EQ(OGR_L_GetFeatureCount(tiles, TRUE), 300);
  ASSERT_EQ(OGR_L_GetFeatureCount(pits, TRUE), 300);
  for (int i = 0; i < 300; ++i) {
    OGRFeatureH tile = OGR_L_GetNextFeature(tiles);
    EXPECT_EQ(OGR_F_GetFieldAsInteger64(tile, 0), i);
    EXPECT_EQ(OGR_F_GetFieldAsString(tile, 1), "tile " + std::to_string(i));
    EXPECT_EQ(OGR_G_Area(OGR_F_GetGeometryRef(tile)), 2.0);
    OGR_F_Destroy(tile);
    OGRFeatureH pit = OGR_L_GetNextFeature(pits);
    EXPECT_EQ(OGR_F_GetFieldAsDouble(pit, 0), 0.1 * i);
    EXPECT_EQ(OGR_G_GetZ(OGR_F_GetGeometryRef(pit), 0), 0.25 * i);
    OGR_F_Destroy(pit);
  }
  OGRFeatureH river = OGR_L_GetNextFeature(rivers);
  EXPECT_EQ(OGR_G_GetPointCount(OGR_F_GetGeometryRef(river)), 3);
  EXPECT_EQ(OGR_G_GetZ(OGR_F_GetGeometryRef(river), 2), 7.0);
  OGR_F_Destroy(river);
  write(folder / "b.gpkg");
  EXPECT_EQ(read_text(folder / "a.gpkg"), read_text(folder / "b.gpkg")) << "same features, same bytes";
}

TEST(GeoPackage, WithoutFinish_NothingIsLeft) {
  const TemporaryFolder folder;
  const VectorField fields[] = {{"id", FieldType::integer}};
  {
    GeoPackageWriter writer(folder / "a.gpkg", "");
    const int layer = writer.add_layer("pits", VectorGeometry::point, false, fields);
    writer.add_point(layer, {1, 2, 0}, std::vector<FieldValue>{std::int64_t{1}});
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(GeoPackage, FolderThatCannotBeMade_IsAStorageError) {
  const TemporaryFolder folder;
  write_text(folder / "file", "");
  error_of([&] { GeoPackageWriter writer(folder / "file" / "a.gpkg", ""); }, ErrorKind::storage);
}

TEST(GeoPackage, ManyFeatures_AreQuick) {
  const TemporaryFolder folder;
  const VectorField fields[] = {{"depth", FieldType::real}};
  GeoPackageWriter writer(folder / "a.gpkg", lambert93());
  const int layer = writer.add_layer("pits", VectorGeometry::point, false, fields);
  for (int i = 0; i < 100'000; ++i) {
    const FieldValue values[] = {0.5 * i};
    writer.add_point(layer, {700000.0 + i % 1000, 6600000.0 + i / 1000, 0}, values);
  }
  writer.finish();
  const auto dataset = open(folder / "a.gpkg", GDAL_OF_VECTOR);
  EXPECT_EQ(OGR_L_GetFeatureCount(GDALDatasetGetLayer(dataset.get(), 0), TRUE), 100'000);
}

TEST(Raster, RealDem_IsReadWithItsGrid) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const Raster dem = read_raster(testing::shared_path("quickstart/Blanca_in_Pozo_USGS_UTM11_NAD83_SC12_1m.tif"));
  EXPECT_EQ(dem.grid, (RasterGrid{238933, 3765382, 1, 1, 271, 281}));
  EXPECT_EQ(dem.nodata, -9999.0F);
  EXPECT_EQ(crs_from_wkt(dem.crs_wkt, "dem").name, "EPSG:26911");
  std::size_t valid = 0;
  for (std::size_t i = 0; i < dem.value.size(); ++i) valid += dem.is_nodata(i) ? 0 : 1;
  EXPECT_NEAR(static_cast<double>(valid) / static_cast<double>(dem.grid.size()), 0.692, 0.001);
}

}  // namespace
}  // namespace hydrotin
