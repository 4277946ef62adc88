hydrotin_test(dem_points_test SOURCES dem_points_test.cpp DEPENDS tiling io
  PRIVATE GDAL::GDAL nlohmann_json::nlohmann_json)
target_include_directories(dem_points_test PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
