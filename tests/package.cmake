# The installed package as another project uses it.
add_test(NAME Package.ExternalProjectLinksTheRooms
  COMMAND ${CMAKE_COMMAND}
    -DBUILD=${PROJECT_BINARY_DIR} -DSOURCE=${CMAKE_CURRENT_SOURCE_DIR}/package
    -DWORK=${CMAKE_CURRENT_BINARY_DIR}/package -DGENERATOR=${CMAKE_GENERATOR}
    -DCXX=${CMAKE_CXX_COMPILER} "-DFLAGS=${CMAKE_CXX_FLAGS}" -DTYPE=${CMAKE_BUILD_TYPE}
    -P ${CMAKE_CURRENT_SOURCE_DIR}/package/check.cmake)
set_tests_properties(Package.ExternalProjectLinksTheRooms PROPERTIES TIMEOUT 300)
