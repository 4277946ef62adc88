hydrotin_test(synthetic_test SOURCES synthetic_test.cpp DEPENDS terrain)
