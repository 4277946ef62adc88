include(CMakePackageConfigHelpers)
set(HYDROTIN_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/hydrotin)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/hydrotin-config.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/hydrotin-config.cmake INSTALL_DESTINATION ${HYDROTIN_CMAKE_DIR})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/hydrotin-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(EXPORT hydrotin-targets NAMESPACE hydrotin:: DESTINATION ${HYDROTIN_CMAKE_DIR})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/hydrotin-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/hydrotin-config-version.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindLibdeflate.cmake ${CMAKE_CURRENT_LIST_DIR}/FindClp.cmake
  DESTINATION ${HYDROTIN_CMAKE_DIR})
install(FILES README.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY configs DESTINATION ${CMAKE_INSTALL_DATADIR}/hydrotin)
