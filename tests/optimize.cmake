hydrotin_test(optimize_test SOURCES optimize_test.cpp DEPENDS optimize)
