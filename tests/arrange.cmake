hydrotin_test(arrange_test SOURCES arrange_test.cpp DEPENDS tiling)
target_include_directories(arrange_test PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
