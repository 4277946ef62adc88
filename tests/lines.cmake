# River lines matched to a terrain.
hydrotin_test(line_walk_test SOURCES line_walk_test.cpp DEPENDS rivers)
hydrotin_test(line_insertion_test SOURCES line_insertion_test.cpp DEPENDS rivers)
hydrotin_test(network_cleaning_test SOURCES network_cleaning_test.cpp DEPENDS rivers terrain)
