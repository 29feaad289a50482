# cpack -G DEB: packages for Debian 12, trivet, libtrivet0.1, libtrivet-dev, trivet-mpi and python3-trivet, of what is built;
# cpack -G TGZ: the programs and libraries in one archive. The same bytes again where SOURCE_DATE_EPOCH is set.
set(TRIVET_MAINTAINER "Trivet <trivet@localhost>" CACHE STRING "Who answers for the packages: Name <address>")
set(CPACK_PACKAGE_VENDOR "Trivet")
set(CPACK_PACKAGE_CONTACT "${TRIVET_MAINTAINER}")
set(CPACK_PACKAGE_CHECKSUM SHA256)
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(debian_version "${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")

# deb(COMPONENT PACKAGE SECTION TEXT [TARGET [LOCK_FILE]]): a package of what is installed as the component, with the documents that
# Debian asks for, and the bill of materials of the TARGET, and of its page by npm's LOCK_FILE. TEXT has lines of at most 79 letters.
function(deb component package section text)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_COMPONENTS_ALL "${CPACK_COMPONENTS_ALL}" PARENT_SCOPE)
  string(TOUPPER "${component}" key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${package} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${text}" PARENT_SCOPE)
  set(documents "${PROJECT_BINARY_DIR}/documents/${package}")
  file(WRITE "${documents}/copyright" "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: trivet

Files: *
Copyright: 2026 the authors of Trivet
License: Apache-2.0
 On Debian systems the text of this license is in
 /usr/share/common-licenses/Apache-2.0
")
  file(WRITE "${documents}/changelog.Debian" "trivet (${debian_version}) unstable; urgency=medium

  * All that changed is in changelog.gz.

 -- ${TRIVET_MAINTAINER}  Wed, 25 Nov 2026 00:00:00 +0000
")
  # A maintainer is whoever gives packages out: until one is named, lintian is told so.
  file(WRITE "${documents}/overrides/${package}" "${package}: bogus-mail-host Maintainer *
${package}: bogus-mail-host-in-debian-changelog *
")
  set(docs "${CMAKE_INSTALL_DATADIR}/doc/${package}")
  install(CODE "# without name and time: the same bytes each time
  execute_process(COMMAND gzip -9nc \"${PROJECT_SOURCE_DIR}/CHANGELOG.md\" OUTPUT_FILE \"${documents}/changelog.gz\"
    COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND gzip -9nkf \"${documents}/changelog.Debian\" COMMAND_ERROR_IS_FATAL ANY)"
    COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES "${documents}/copyright" "${documents}/changelog.gz" "${documents}/changelog.Debian.gz" DESTINATION "${docs}"
    COMPONENT ${component} EXCLUDE_FROM_ALL)
  if(ARGN)
    list(POP_FRONT ARGN target)
    install(CODE "execute_process(COMMAND \"${PROJECT_SOURCE_DIR}/scripts/sbom\" \"${PROJECT_BINARY_DIR}\" ${package} ${PROJECT_VERSION}
      \"$<TARGET_FILE:${target}>\" \"${documents}/sbom.cdx.json\" ${ARGN} COMMAND_ERROR_IS_FATAL ANY)"
      COMPONENT ${component} EXCLUDE_FROM_ALL)
    install(FILES "${documents}/sbom.cdx.json" DESTINATION "${docs}" COMPONENT ${component} EXCLUDE_FROM_ALL)
  endif()
  install(FILES "${documents}/overrides/${package}" DESTINATION "${CMAKE_INSTALL_DATADIR}/lintian/overrides"
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endfunction()

set(page_lock_file "")
if(EXISTS "${PROJECT_SOURCE_DIR}/web/dist/index.html")
  set(page_lock_file "${PROJECT_SOURCE_DIR}/web/package-lock.json")
endif()
deb(program trivet science
  "The program: trains libraries of models, recognizes them in scans of laser and
depth cameras with verified poses, and serves recognition over HTTP." trivet ${page_lock_file})
if(TRIVET_BUILD_C)
  set(library_package libtrivet${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  deb(library ${library_package} libs
    "The C interface of Trivet, for programs in any language." trivet_c)
  file(WRITE "${PROJECT_BINARY_DIR}/documents/triggers" "activate-noawait ldconfig\n")
  file(WRITE "${PROJECT_BINARY_DIR}/documents/shlibs"
    "libtrivet ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} ${library_package} (>= ${PROJECT_VERSION})\n")
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA "${PROJECT_BINARY_DIR}/documents/triggers;${PROJECT_BINARY_DIR}/documents/shlibs")
  deb(development libtrivet-dev libdevel
    "Headers, static libraries and CMake files of Trivet for C++, and what it takes
to build with its C interface.")
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${library_package} (= ${debian_version}), libeigen3-dev, libtbb-dev, libfmt-dev, \
libhdf5-dev, libflann-dev, liblz4-dev, libembree-dev, libpng-dev, libtiff-dev, zlib1g-dev, libutf8proc-dev, libxxhash-dev")
endif()
if(TRIVET_BUILD_MPI)
  deb(mpi trivet-mpi science
    "Trains libraries, recognizes scenes and runs studies over the processes of
Open MPI." trivet-mpi)
  set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "openmpi-bin")
endif()
if(TRIVET_BUILD_PYTHON)
  deb(python python3-trivet python
    "The Python package trivet: training, recognition and evaluation with NumPy
arrays." trivet_python)
  set(documents "${PROJECT_BINARY_DIR}/documents/python3-trivet")
  file(WRITE "${documents}/postinst" "#!/bin/sh\nset -e\n[ \"$1\" != configure ] || py3compile -p python3-trivet\n")
  file(WRITE "${documents}/prerm" "#!/bin/sh\nset -e\npy3clean -p python3-trivet\n")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${documents}/postinst;${documents}/prerm")
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")  # a module is of one version of Python
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), \
python3 (<< ${Python_VERSION_MAJOR}.${next_minor}), python3-numpy")
endif()
# Packages for Debian have it in their own form.
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT archive)
include(CPack)
