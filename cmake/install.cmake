# cmake --install, and find_package(trivet) for those who link to the libraries.
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/trivet)

install(TARGETS trivet RUNTIME)
install(TARGETS trivet_storage trivet_kernels trivet_engine EXPORT trivet_targets ARCHIVE)
# Left out: headers that name a library which the public interface hides.
install(DIRECTORY storage kernels engine DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/trivet FILES_MATCHING PATTERN "*.hpp"
  PATTERN formats EXCLUDE PATTERN hdf5.hpp EXCLUDE PATTERN json_file.hpp EXCLUDE PATTERN parallel.hpp EXCLUDE)

install(EXPORT trivet_targets NAMESPACE trivet:: DESTINATION ${package_folder} FILE trivet_targets.cmake)
configure_package_config_file(cmake/trivetConfig.cmake.in ${PROJECT_BINARY_DIR}/trivetConfig.cmake
  INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/trivetConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/trivetConfig.cmake ${PROJECT_BINARY_DIR}/trivetConfigVersion.cmake
  cmake/dependencies.cmake DESTINATION ${package_folder})
