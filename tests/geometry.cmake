hydrotin_test(geometry_test SOURCES geometry_test.cpp DEPENDS geometry)
