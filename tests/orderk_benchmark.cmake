# Speed and memory of order k and of the polygons; not a test: build and run orderk_benchmark by hand.
find_package(Threads REQUIRED)
if(HYDROTIN_BENCHMARKS)
  add_executable(orderk_benchmark EXCLUDE_FROM_ALL orderk_benchmark.cpp)
  target_link_libraries(orderk_benchmark PRIVATE plain_delaunay hydrotin::optimize hydrotin::terrain hydrotin::options Threads::Threads)
endif()
