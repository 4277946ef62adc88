hydrotin_test(tiling_parts_test SOURCES tiling_parts_test.cpp DEPENDS tiling)
target_include_directories(tiling_parts_test PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
hydrotin_test(tiling_check_test SOURCES tiling_check_test.cpp DEPENDS tiling)
target_include_directories(tiling_check_test PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
