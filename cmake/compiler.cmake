# Compiler options of every target of the project.
add_library(trivet_compiler INTERFACE)
target_compile_features(trivet_compiler INTERFACE cxx_std_20)
target_compile_options(trivet_compiler INTERFACE
  -Wall -Wextra -Wconversion -Wshadow $<$<BOOL:${TRIVET_WARNINGS_AS_ERRORS}>:-Werror>
  # Same bits on every machine of one instruction set: no contraction that depends on inlining.
  -ffp-contract=off -fno-math-errno -fno-trapping-math
  # A program takes of a folder that is compiled together only what it calls.
  -ffunction-sections -fdata-sections
  # Looking for memory to free took the compiler a tenth of its time; up to 1 GB [kB] it frees nothing.
  $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1048576>)
target_link_options(trivet_compiler INTERFACE -Wl,--gc-sections)

# Hardening (tests/hardening.sh): the program ends at an overrun of the stack or of an array whose size is known; its addresses differ
# at each start, and data that the loader wrote is read-only. Containers are checked in storage and apps, where untrusted data enters:
# with checks in the kernels, too, training took 13 % and recognition 26 % more instructions.
include(CheckPIESupported)
check_pie_supported(LANGUAGES CXX)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
target_compile_options(trivet_compiler INTERFACE -fstack-protector-strong)
target_link_options(trivet_compiler INTERFACE -Wl,-z,relro,-z,now)
# Calls and returns that go elsewhere end it, where processor and system see to that. The C library's own start, which is not made
# for it in Debian 12, keeps the program from asking for it.
include(CheckCXXCompilerFlag)
check_cxx_compiler_flag(-fcf-protection TRIVET_HAS_CF_PROTECTION)
if(TRIVET_HAS_CF_PROTECTION)
  target_compile_options(trivet_compiler INTERFACE -fcf-protection)
endif()
if(NOT TRIVET_SANITIZE)  # the sanitizers check the same functions more thoroughly
  target_compile_options(trivet_compiler INTERFACE
    "$<$<CONFIG:Release,RelWithDebInfo,MinSizeRel>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=2>")
else()
  # The vptr check misfires inside TBB's flow graph; Clang 14 cannot compile coroutines with its check of function types.
  target_compile_options(trivet_compiler INTERFACE -fsanitize=${TRIVET_SANITIZE} -fno-sanitize=vptr
    $<$<CXX_COMPILER_ID:Clang>:-fno-sanitize=function>
    -fno-omit-frame-pointer -fno-sanitize-recover=all
    # Checks of every pointer take the compiler 40 % of its time; a null one ends the program anyway, and the fuzzer's compiler
    # checks the others.
    $<$<CXX_COMPILER_ID:GNU>:-fno-sanitize=null,object-size,nonnull-attribute,returns-nonnull-attribute,alignment>)
  target_link_options(trivet_compiler INTERFACE -fsanitize=${TRIVET_SANITIZE})
  target_compile_definitions(trivet_compiler INTERFACE TRIVET_NO_SIMD_CLONES _GLIBCXX_ASSERTIONS)
endif()

# compile_folders_together(TARGET SOURCES...): each folder's sources as one, since most of what a small source costs are the
# headers and templates that it shares with its like. -DCMAKE_UNITY_BUILD=OFF leaves each to itself.
function(compile_folders_together target)
  if(DEFINED CMAKE_UNITY_BUILD AND NOT CMAKE_UNITY_BUILD)
    return()
  endif()
  foreach(source IN LISTS ARGN)
    cmake_path(GET source PARENT_PATH folder)
    string(MAKE_C_IDENTIFIER "${folder}" group)
    set_source_files_properties("${source}" PROPERTIES UNITY_GROUP "${group}")
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # Anonymous namespaces of sources remain internal, although the sources are included now.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# compile_lightly(TARGET): what only passes on words and arrays takes two thirds of the time to compile, and runs as fast; with
# sanitizers, whose checks the optimizer goes through as well, three fourths without it.
function(compile_lightly target)
  if(TRIVET_SANITIZE AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_compile_options(${target} PRIVATE -O0)
  else()
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
endfunction()

# add_layer(NAME SOURCES...): a static library of them.
function(add_layer name)
  add_library(trivet_${name} STATIC ${ARGN})
  compile_folders_together(trivet_${name} ${ARGN})
  add_library(trivet::${name} ALIAS trivet_${name})
  target_include_directories(trivet_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/trivet>)
  target_link_libraries(trivet_${name} PRIVATE $<BUILD_INTERFACE:trivet_compiler>)
  target_compile_features(trivet_${name} PUBLIC cxx_std_20)
  # Headers that take a second or more to parse in nearly every source. CLI11 is not among them: it emits code wherever it is included.
  target_precompile_headers(trivet_${name} PRIVATE <Eigen/Geometry> <algorithm> <cmath> <filesystem> <functional>
    <optional> <span> <string> <vector>)
  set_target_properties(trivet_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON EXPORT_NAME ${name})
endfunction()
