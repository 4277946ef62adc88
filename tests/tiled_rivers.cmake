hydrotin_test(tiled_rivers_test SOURCES tiled_rivers_test.cpp DEPENDS tiling rivers PRIVATE nlohmann_json::nlohmann_json LABELS slow)
target_include_directories(tiled_rivers_test PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
hydrotin_test(tiled_river_outputs_test SOURCES tiled_river_outputs_test.cpp DEPENDS tiling rivers PRIVATE nlohmann_json::nlohmann_json hdf5::hdf5 LABELS slow)
target_include_directories(tiled_river_outputs_test PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
# The program once with tiles and once without.
hydrotin_test(river_layers_test SOURCES river_layers_test.cpp DEPENDS app PRIVATE nlohmann_json::nlohmann_json GDAL::GDAL LABELS slow)
target_compile_definitions(river_layers_test PRIVATE HYDROTIN_PROGRAM="$<TARGET_FILE:hydrotin>")
add_dependencies(river_layers_test hydrotin)
