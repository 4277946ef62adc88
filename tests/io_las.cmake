hydrotin_test(las_test SOURCES las_test.cpp DEPENDS io core)
