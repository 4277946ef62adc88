hydrotin_test(outputs_test SOURCES outputs_test.cpp points_and_meshes_test.cpp DEPENDS io PRIVATE GDAL::GDAL)
hydrotin_test(vector_reader_test SOURCES vector_reader_test.cpp DEPENDS io)
