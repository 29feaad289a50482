# cmake --install, and find_package(trivet) for those who link to it.
include(CMakePackageConfigHelpers)
install(TARGETS trivet RUNTIME)
install(TARGETS trivet_storage trivet_kernels trivet_engine EXPORT trivet_targets ARCHIVE)
foreach(floor storage kernels engine)
  install(DIRECTORY ${floor} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/trivet FILES_MATCHING PATTERN "*.hpp")
endforeach()
