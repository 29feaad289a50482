# cmake --install, and find_package(trivet) for those who link to the libraries.
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/trivet)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME development)  # the component of files that name no other

install(TARGETS trivet RUNTIME COMPONENT program)
if(TRIVET_BUILD_MPI)
  install(TARGETS trivet-mpi RUNTIME COMPONENT mpi)
endif()
# Manual pages, completions and the unit of systemd, which the program or the place of installation writes.
install(CODE "set(TRIVET \"$<TARGET_FILE:trivet>\")
  set(PAGES \"${PROJECT_BINARY_DIR}/pages\")
  set(MAN \"${CMAKE_INSTALL_MANDIR}\")
  set(DATA \"${CMAKE_INSTALL_DATADIR}\")
  set(BIN \"${CMAKE_INSTALL_BINDIR}\")
  set(SYSTEM \"lib/systemd/system\")
  set(UNIT \"${PROJECT_SOURCE_DIR}/docs/deploy/trivet.service\")" COMPONENT program)
install(SCRIPT "${PROJECT_SOURCE_DIR}/cmake/install_pages.cmake" COMPONENT program)
install(TARGETS trivet_storage trivet_kernels trivet_engine EXPORT trivet_targets ARCHIVE)
# The public headers, and what they include.
set(public_headers
  engine/common/progress.hpp engine/common/thread_limit.hpp
  engine/loaded_library/default_score.hpp engine/loaded_library/find_families.hpp engine/loaded_library/recognizer.hpp
  engine/meshing/surface_from_points.hpp
  engine/options/improvements.hpp engine/options/method.hpp engine/options/option.hpp engine/options/pose_limits.hpp
  engine/options/presets.hpp engine/options/recognize_options.hpp engine/options/train_options.hpp
  engine/recognition/estimate_camera.hpp engine/recognition/recognition_service.hpp engine/recognition/recognize.hpp
  engine/results/camera_check.hpp engine/results/explanation.hpp engine/results/recognize_result.hpp
  engine/results/rejected_pose.hpp engine/results/scene_view.hpp engine/results/stage_times.hpp
  engine/scene/read_scene.hpp
  engine/training/train.hpp engine/training/training_run.hpp
  storage/common/columns.hpp storage/common/result.hpp storage/common/shared.hpp
  storage/data/cloud.hpp storage/data/feature_index.hpp storage/data/file_pose.hpp storage/data/length_unit.hpp storage/data/mesh.hpp
  storage/data/model.hpp storage/data/neighborhoods.hpp storage/data/pca_basis.hpp storage/data/points.hpp storage/data/ppf_table.hpp
  storage/data/read_options.hpp storage/data/tri_spin_features.hpp
  storage/datasets/manifest.hpp
  storage/formats/declared_size.hpp storage/formats/memory_cloud.hpp storage/formats/read_cloud.hpp storage/formats/write_png.hpp
  storage/library/library.hpp storage/library/model_name.hpp)
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
foreach(header IN LISTS public_headers)
  install_header("${header}")
endforeach()

# The C interface, which needs none of them: libtrivet.so, trivet.h, and how pkg-config finds them wherever they are moved.
if(TRIVET_BUILD_C)
  install(TARGETS trivet_c EXPORT trivet_c_targets LIBRARY COMPONENT library NAMELINK_COMPONENT development)
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
