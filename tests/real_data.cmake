hydrotin_test(real_data_test SOURCES real_data_test.cpp DEPENDS tiling PRIVATE GDAL::GDAL LABELS slow)
target_include_directories(real_data_test PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
hydrotin_test(inputs_test SOURCES inputs_test.cpp input_shapes_test.cpp pipeline_outputs_test.cpp DEPENDS tiling PRIVATE GDAL::GDAL)
target_include_directories(inputs_test PRIVATE ${PROJECT_SOURCE_DIR}/tiling)
