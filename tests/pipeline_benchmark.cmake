# B', the yardstick that benchmarks divide by; see plain_delaunay.h.
add_library(plain_delaunay STATIC EXCLUDE_FROM_ALL plain_delaunay.cpp)
target_link_libraries(plain_delaunay PRIVATE hydrotin::terrain CGAL::CGAL hydrotin::options)

# Speed and memory of the whole program; not a test: build and run pipeline_benchmark by hand.
if(HYDROTIN_BENCHMARKS)
  add_executable(pipeline_benchmark EXCLUDE_FROM_ALL pipeline_benchmark.cpp)
  target_compile_definitions(pipeline_benchmark PRIVATE HYDROTIN_PROGRAM="$<TARGET_FILE:hydrotin>")
  target_link_libraries(pipeline_benchmark PRIVATE
    plain_delaunay hydrotin::io hydrotin::options CLI11::CLI11 fmt::fmt nlohmann_json::nlohmann_json)
  add_dependencies(pipeline_benchmark hydrotin)
endif()
