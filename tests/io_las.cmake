hydrotin_test(las_test SOURCES las_test.cpp DEPENDS io core)
hydrotin_test(las_damage_test SOURCES las_damage_test.cpp DEPENDS io core PRIVATE GDAL::GDAL)
hydrotin_test(laz_codec_test SOURCES laz_codec_test.cpp DEPENDS io core PRIVATE GDAL::GDAL)
hydrotin_test(las_writer_test SOURCES las_writer_test.cpp DEPENDS io core PRIVATE GDAL::GDAL)
# A program of its own: continuous integration runs it once more in a build with sanitizers.
hydrotin_test(las_robustness_test SOURCES las_robustness_test.cpp DEPENDS io core PRIVATE GDAL::GDAL)
target_include_directories(las_robustness_test PRIVATE ${PROJECT_SOURCE_DIR}/src/io)

find_package(benchmark QUIET)
if(HYDROTIN_BENCHMARKS AND benchmark_FOUND)
  add_executable(las_benchmark EXCLUDE_FROM_ALL las_benchmark.cpp)
  target_compile_definitions(las_benchmark PRIVATE HYDROTIN_SHARED="${HYDROTIN_SHARED}")
  target_link_libraries(las_benchmark PRIVATE plain_delaunay hydrotin::io hydrotin::options benchmark::benchmark)
endif()
