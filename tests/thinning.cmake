hydrotin_test(dem_points_test SOURCES dem_points_test.cpp DEPENDS tiling io
  PRIVATE GDAL::GDAL nlohmann_json::nlohmann_json)
target_include_directories(dem_points_test PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
hydrotin_test(thinning_test SOURCES thinning_test.cpp DEPENDS thinning)
hydrotin_test(tiled_thinning_test SOURCES tiled_thinning_test.cpp DEPENDS tiling
  PRIVATE nlohmann_json::nlohmann_json hdf5::hdf5)
target_include_directories(tiled_thinning_test PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
# Points kept, rounds and speed on any files; not a test: build and run thinning_benchmark by hand.
if(HYDROTIN_BENCHMARKS)
  add_executable(thinning_benchmark EXCLUDE_FROM_ALL thinning_benchmark.cpp)
  target_link_libraries(thinning_benchmark PRIVATE hydrotin::thinning hydrotin::io hydrotin::options)
endif()
