hydrotin_test(config_test SOURCES config_test.cpp DEPENDS app)

# The program as users call it.
hydrotin_test(app_test SOURCES app_test.cpp DEPENDS app PRIVATE nlohmann_json::nlohmann_json GDAL::GDAL)
target_compile_definitions(app_test PRIVATE HYDROTIN_PROGRAM="$<TARGET_FILE:hydrotin>")
add_dependencies(app_test hydrotin)
