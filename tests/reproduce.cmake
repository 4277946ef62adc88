# Experiments of the thesis, run by scripts/reproduce-*.sh; not tests.
add_executable(reproduce_ch3 reproduce_ch3.cpp)
target_link_libraries(reproduce_ch3 PRIVATE hydrotin::orderk hydrotin::io hydrotin::options CLI11::CLI11 Threads::Threads)
add_test(NAME Reproduce.Chapter3RunsOnFewSets COMMAND reproduce_ch3 --runs 2 --workers 2
  --figures ${CMAKE_CURRENT_BINARY_DIR}/chapter3)

find_package(Clp REQUIRED)
add_executable(reproduce_ch7 reproduce_ch7.cpp)
target_link_libraries(reproduce_ch7 PRIVATE hydrotin::rivers hydrotin::terrain hydrotin::options CLI11::CLI11 Clp::Clp)
add_test(NAME Reproduce.Chapter7RunsOnASmallTerrain COMMAND reproduce_ch7 --river Triumph --side 3000)
