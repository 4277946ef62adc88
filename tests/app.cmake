hydrotin_test(config_test SOURCES config_test.cpp DEPENDS app)

# The program as users call it.
foreach(part app triangulate_command fill_command)
  hydrotin_test(${part}_test SOURCES ${part}_test.cpp DEPENDS app PRIVATE nlohmann_json::nlohmann_json GDAL::GDAL)
  target_compile_definitions(${part}_test PRIVATE HYDROTIN_PROGRAM="$<TARGET_FILE:hydrotin>")
  add_dependencies(${part}_test hydrotin)
endforeach()
