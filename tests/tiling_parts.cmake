hydrotin_test(tiling_parts_test SOURCES tiling_parts_test.cpp DEPENDS tiling)
target_include_directories(tiling_parts_test PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
