hydrotin_test(tiled_rivers_test SOURCES tiled_rivers_test.cpp DEPENDS tiling rivers PRIVATE nlohmann_json::nlohmann_json GDAL::GDAL hdf5::hdf5 LABELS slow)
target_include_directories(tiled_rivers_test PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
