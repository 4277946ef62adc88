# Warnings and floating-point rules shared by every target of the project; private, never exported to users.
add_library(hydrotin_options INTERFACE)
target_compile_options(hydrotin_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow
  # Error-free transforms and exact predicates break silently when products are contracted into FMAs.
  -ffp-contract=off
  $<$<BOOL:${HYDROTIN_WERROR}>:-Werror>)
add_library(hydrotin::options ALIAS hydrotin_options)

# hydrotin_module(NAME SOURCES a.cpp ... [DEPENDS room ...] [PRIVATE library ...])
# One room: a static library whose public include root is include/NAME; `DEPENDS` are its arrows to other rooms,
# `PRIVATE` the third-party libraries whose headers stay inside it. Called from the room's own folder.
function(hydrotin_module name)
  cmake_parse_arguments(M "" "" "SOURCES;DEPENDS;PRIVATE" ${ARGN})
  list(TRANSFORM M_DEPENDS PREPEND "hydrotin::")
  add_library(hydrotin_${name} STATIC ${M_SOURCES})
  add_library(hydrotin::${name} ALIAS hydrotin_${name})
  set_target_properties(hydrotin_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(hydrotin_${name} PUBLIC cxx_std_20)
  target_include_directories(hydrotin_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include/${name}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/hydrotin/${name}>)
  target_link_libraries(hydrotin_${name} PUBLIC ${M_DEPENDS}
    PRIVATE $<BUILD_INTERFACE:hydrotin::options> ${M_PRIVATE})
  install(TARGETS hydrotin_${name} EXPORT hydrotin-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/${name}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hydrotin/${name})
endfunction()
