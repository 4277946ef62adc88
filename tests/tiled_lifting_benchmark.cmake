# Lifting in tiles against lifting in memory; not a test: build and run tiled_lifting_benchmark by hand.
if(HYDROTIN_BENCHMARKS)
  add_executable(tiled_lifting_benchmark EXCLUDE_FROM_ALL tiled_lifting_benchmark.cpp)
  target_include_directories(tiled_lifting_benchmark PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
  target_link_libraries(tiled_lifting_benchmark PRIVATE
    hydrotin::tiling hydrotin::options CLI11::CLI11 fmt::fmt)
endif()
