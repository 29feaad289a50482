# Every library is a Debian 12 package; scripts/install-packages lists them.
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(PNG REQUIRED)
find_package(embree 3.13 REQUIRED)

# FLANN pulls in the MPI build of HDF5, and its pkg-config file would link it: name the serial one.
set(HDF5_PREFER_PARALLEL OFF)
find_package(HDF5 REQUIRED COMPONENTS C)
if(HDF5_IS_PARALLEL)
  message(FATAL_ERROR "found the parallel HDF5; install libhdf5-dev (serial)")
endif()
add_library(trivet_hdf5 INTERFACE)
target_include_directories(trivet_hdf5 SYSTEM INTERFACE ${HDF5_C_INCLUDE_DIRS})
target_link_libraries(trivet_hdf5 INTERFACE ${HDF5_C_LIBRARIES})

# FLANN's index serialisation uses LZ4, which its CMake target does not name.
find_path(FLANN_INCLUDE_DIR flann/flann.hpp REQUIRED)
find_library(FLANN_CPP_LIBRARY flann_cpp REQUIRED)
find_library(LZ4_LIBRARY lz4 REQUIRED)
add_library(trivet_flann INTERFACE)
target_include_directories(trivet_flann SYSTEM INTERFACE ${FLANN_INCLUDE_DIR})
target_link_libraries(trivet_flann INTERFACE ${FLANN_CPP_LIBRARY} ${LZ4_LIBRARY})

find_library(XXHASH_LIBRARY xxhash REQUIRED)
