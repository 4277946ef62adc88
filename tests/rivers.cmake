find_package(Clp REQUIRED)
hydrotin_test(rivers_test SOURCES rivers_test.cpp DEPENDS rivers PRIVATE Clp::Clp)
hydrotin_test(river_window_test SOURCES river_window_test.cpp DEPENDS rivers)
if(HYDROTIN_BENCHMARKS)
  add_executable(rivers_benchmark EXCLUDE_FROM_ALL rivers_benchmark.cpp)
  target_link_libraries(rivers_benchmark PRIVATE hydrotin::rivers hydrotin::terrain Clp::Clp hydrotin::options)
endif()

# The command as users call it.
hydrotin_test(embed_command_test SOURCES embed_command_test.cpp DEPENDS app
              PRIVATE nlohmann_json::nlohmann_json Clp::Clp)
target_compile_definitions(embed_command_test PRIVATE HYDROTIN_PROGRAM="$<TARGET_FILE:hydrotin>")
add_dependencies(embed_command_test hydrotin)
