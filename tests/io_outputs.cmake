hydrotin_test(outputs_test SOURCES outputs_test.cpp points_and_meshes_test.cpp DEPENDS io PRIVATE GDAL::GDAL)
