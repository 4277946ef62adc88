hydrotin_test(tiled_pits_test SOURCES tiled_pits_test.cpp DEPENDS tiling PRIVATE nlohmann_json::nlohmann_json GDAL::GDAL LABELS slow)
target_include_directories(tiled_pits_test PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
