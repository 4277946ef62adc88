hydrotin_test(orderk_test SOURCES orderk_test.cpp DEPENDS orderk)
