# River lines matched to a terrain.
find_package(Clp REQUIRED)
hydrotin_test(line_walk_test SOURCES line_walk_test.cpp DEPENDS rivers)
hydrotin_test(line_insertion_test SOURCES line_insertion_test.cpp DEPENDS rivers)
hydrotin_test(network_cleaning_test SOURCES network_cleaning_test.cpp DEPENDS rivers terrain)
hydrotin_test(embed_lines_test SOURCES embed_lines_test.cpp DEPENDS app PRIVATE nlohmann_json::nlohmann_json)
target_compile_definitions(embed_lines_test PRIVATE HYDROTIN_PROGRAM="$<TARGET_FILE:hydrotin>")
add_dependencies(embed_lines_test hydrotin)
hydrotin_test(river_tables_test SOURCES river_tables_test.cpp DEPENDS rivers PRIVATE Clp::Clp)
