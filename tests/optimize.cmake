hydrotin_test(optimize_test SOURCES optimize_test.cpp DEPENDS optimize)
hydrotin_test(objectives_test SOURCES objectives_test.cpp DEPENDS optimize)
hydrotin_test(simple_polygon_test SOURCES simple_polygon_test.cpp DEPENDS optimize)
