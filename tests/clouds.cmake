hydrotin_test(clouds_test SOURCES clouds_test.cpp DEPENDS core)
