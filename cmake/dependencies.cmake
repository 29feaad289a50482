# Dependencies of the libraries, for the build and for find_package(trivet), which includes this file.
# Every library is a Debian 12 package; scripts/packages.txt lists them.
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(PNG REQUIRED)
find_package(TIFF 4.5 REQUIRED)  # version 4.5 has limits and errors per file
find_package(ZLIB REQUIRED)
find_package(embree 3.13 REQUIRED)

# trivet_library(NAME HEADER SUFFIXES LIBRARIES...): the target trivet::NAME for libraries whose own
# CMake files are absent or wrong. HEADER is looked for in the SUFFIXES of the include folders first.
function(trivet_library name header suffixes)
  if(TARGET trivet::${name})
    return()
  endif()
  find_path(TRIVET_${name}_INCLUDE_DIR ${header} PATH_SUFFIXES ${suffixes} REQUIRED)
  add_library(trivet::${name} INTERFACE IMPORTED)
  set_target_properties(trivet::${name} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${TRIVET_${name}_INCLUDE_DIR}")
  foreach(library IN LISTS ARGN)
    find_library(TRIVET_${library}_LIBRARY ${library} REQUIRED)
    mark_as_advanced(TRIVET_${library}_LIBRARY)
    set_property(TARGET trivet::${name} APPEND PROPERTY INTERFACE_LINK_LIBRARIES "${TRIVET_${library}_LIBRARY}")
  endforeach()
  mark_as_advanced(TRIVET_${name}_INCLUDE_DIR)
endfunction()

# FLANN pulls in the MPI build of HDF5, and its pkg-config file would link it: name the serial one.
trivet_library(hdf5 hdf5.h hdf5/serial hdf5_serial)
# FLANN's index serialization uses LZ4, which its CMake target does not name.
trivet_library(flann flann/flann.hpp "" flann_cpp lz4)
trivet_library(utf8proc utf8proc.h "" utf8proc)
trivet_library(xxhash xxhash.h "" xxhash)
if(TRIVET_BUILD_STEP)  # OpenCASCADE; its own CMake files ask for what only viewers need
  trivet_library(occt STEPControl_Reader.hxx opencascade TKSTEP TKSTEPBase TKXSBase TKMesh TKBO TKPrim TKTopAlgo
    TKGeomAlgo TKBRep TKGeomBase TKG3d TKG2d TKMath TKernel)
endif()
