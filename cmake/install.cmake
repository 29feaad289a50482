# cmake --install, and find_package(trivet) for those who link to the libraries.
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/trivet)

install(TARGETS trivet RUNTIME)
# Manual pages and completions, which the program writes.
install(CODE "set(TRIVET \"$<TARGET_FILE:trivet>\")
  set(PAGES \"${PROJECT_BINARY_DIR}/pages\")
  set(MAN \"${CMAKE_INSTALL_MANDIR}\")
  set(DATA \"${CMAKE_INSTALL_DATADIR}\")")
install(SCRIPT "${PROJECT_SOURCE_DIR}/cmake/install_pages.cmake")
install(TARGETS trivet_storage trivet_kernels trivet_engine EXPORT trivet_targets ARCHIVE)
# The public headers, which stand at the top of storage and engine, and what they include.
function(install_header header)
  get_property(installed GLOBAL PROPERTY trivet_installed_headers)
  if(NOT header IN_LIST installed)
    set_property(GLOBAL APPEND PROPERTY trivet_installed_headers "${header}")
    cmake_path(GET header PARENT_PATH folder)
    install(FILES "${header}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/trivet/${folder}")
    file(STRINGS "${header}" includes REGEX "^#include \"")
    list(TRANSFORM includes REPLACE "#include \"(.*)\"" "\\1")
    foreach(included IN LISTS includes)
      install_header("${included}")
    endforeach()
  endif()
endfunction()
file(GLOB headers CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}" storage/*.hpp engine/*.hpp)
foreach(header IN LISTS headers)
  install_header("${header}")
endforeach()

# The C interface, which needs none of them: libtrivet.so, trivet.h, and how pkg-config finds them wherever they are moved.
if(TRIVET_BUILD_C)
  install(TARGETS trivet_c EXPORT trivet_c_targets LIBRARY)
  install(EXPORT trivet_c_targets NAMESPACE trivet:: DESTINATION ${package_folder} FILE trivet_c_targets.cmake)
  install(FILES c/trivet.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  set(pkgconfig_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
  file(RELATIVE_PATH prefix_from_pkgconfig "/prefix/${pkgconfig_folder}" /prefix)
  configure_file(cmake/trivet.pc.in ${PROJECT_BINARY_DIR}/trivet.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/trivet.pc DESTINATION ${pkgconfig_folder})
endif()

install(EXPORT trivet_targets NAMESPACE trivet:: DESTINATION ${package_folder} FILE trivet_targets.cmake)
configure_package_config_file(cmake/trivetConfig.cmake.in ${PROJECT_BINARY_DIR}/trivetConfig.cmake
  INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/trivetConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/trivetConfig.cmake ${PROJECT_BINARY_DIR}/trivetConfigVersion.cmake
  cmake/dependencies.cmake DESTINATION ${package_folder})
