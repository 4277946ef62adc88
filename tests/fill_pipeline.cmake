hydrotin_test(fill_pipeline_test SOURCES fill_pipeline_test.cpp DEPENDS tiling PRIVATE GDAL::GDAL)
target_compile_definitions(fill_pipeline_test PRIVATE HYDROTIN_PROGRAM="$<TARGET_FILE:hydrotin>")
add_dependencies(fill_pipeline_test hydrotin)
