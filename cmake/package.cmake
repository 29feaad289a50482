# cpack -G DEB: trivet, libtrivet0.1, libtrivet-dev, and where they are built trivet-mpi and python3-trivet; cpack -G TGZ: all
# in one archive. The same bytes again, where SOURCE_DATE_EPOCH says what time it is.
set(CPACK_PACKAGE_VENDOR "Trivet")
set(CPACK_PACKAGE_CONTACT "Trivet <trivet@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_CHECKSUM SHA256)
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program)
if(TRIVET_BUILD_C)
  list(APPEND CPACK_COMPONENTS_ALL library development)
endif()
if(TRIVET_BUILD_MPI)
  list(APPEND CPACK_COMPONENTS_ALL mpi)
endif()
if(TRIVET_BUILD_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

# deb(COMPONENT PACKAGE SECTION SUMMARY TEXT): and its copyright and changelog, which Debian asks for.
function(deb component package section summary text)
  string(TOUPPER "${component}" key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${package} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_COMPONENT_${key}_DESCRIPTION "${summary}\n${text}" PARENT_SCOPE)
  set(documents "${PROJECT_BINARY_DIR}/documents/${package}")
  file(READ "${PROJECT_SOURCE_DIR}/LICENSE" license)
  string(REGEX REPLACE "\n" "\n " license "${license}")
  file(WRITE "${documents}/copyright" "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: trivet

Files: *
Copyright: the authors of Trivet
License: Trivet
 ${license}")
  install(FILES "${documents}/copyright" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package}" COMPONENT ${component})
  # gzip without name and time: the same bytes each time
  install(CODE "execute_process(COMMAND gzip -9nc \"${PROJECT_SOURCE_DIR}/CHANGELOG.md\"
    OUTPUT_FILE \"${documents}/changelog.gz\" COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component})
  install(FILES "${documents}/changelog.gz" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package}" COMPONENT ${component})
endfunction()
deb(program trivet science "Recognizes known rigid objects in 3-D scans"
  "The program: trains libraries of models, recognizes them in scans of laser and depth cameras with verified poses, and serves
recognition over HTTP.")
set(library_package libtrivet${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
deb(library ${library_package} libs "Recognizes known rigid objects in 3-D scans (C library)" "The C interface of Trivet.")
deb(development libtrivet-dev libdevel "Recognizes known rigid objects in 3-D scans (headers)"
  "Headers, static libraries and CMake files of Trivet for C++, and its C interface.")
deb(mpi trivet-mpi science "Recognizes known rigid objects in 3-D scans (many machines)"
  "Trains libraries, recognizes scenes and runs studies over the processes of Open MPI.")
deb(python python3-trivet python "Recognizes known rigid objects in 3-D scans (Python)"
  "The Python package trivet: training, recognition and evaluation with NumPy arrays.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3-numpy")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "${library_package} (= ${PROJECT_VERSION}), libeigen3-dev, libtbb-dev, libfmt-dev, libhdf5-dev, libflann-dev, liblz4-dev, \
libembree-dev, libpng-dev, libtiff-dev, zlib1g-dev, libxxhash-dev")
include(CPack)
