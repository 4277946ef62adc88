hydrotin_test(lifting_test SOURCES lifting_test.cpp DEPENDS terrain)
hydrotin_test(terrain_parts_test SOURCES terrain_parts_test.cpp DEPENDS terrain)
hydrotin_test(contour_tree_test SOURCES contour_tree_test.cpp DEPENDS terrain)
hydrotin_test(pit_hierarchy_test SOURCES pit_hierarchy_test.cpp DEPENDS terrain)
hydrotin_test(outlets_test SOURCES outlets_test.cpp DEPENDS terrain)
hydrotin_test(rasterize_test SOURCES rasterize_test.cpp DEPENDS terrain)

# Speed of the room; not a test: build and run terrain_benchmark by hand.
find_package(benchmark QUIET)
if(HYDROTIN_BENCHMARKS AND benchmark_FOUND)
  add_executable(terrain_benchmark EXCLUDE_FROM_ALL terrain_benchmark.cpp)
  target_link_libraries(terrain_benchmark PRIVATE hydrotin::terrain hydrotin::options benchmark::benchmark)
endif()
