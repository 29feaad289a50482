# Install into a folder of its own, then build and run a program that uses what is there.
# usage: cmake -DBUILD=FOLDER -DCXX=COMPILER -DFLAGS=FLAGS [-DCC=COMPILER -DDATA=FOLDER -DLIBDIR=FOLDER] -P run.cmake
# DATA   what tests/c/make_data.py makes; where it is given, the C interface is tested, too
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(prefix "${BUILD}/prefix")
file(REMOVE_RECURSE "${prefix}" "${BUILD}/consumer")
run(${CMAKE_COMMAND} --install "${BUILD}" --prefix "${prefix}")
run("${prefix}/bin/trivet" --version)
foreach(page man/man1/trivet.1.gz man/man1/trivet-fit-score.1.gz man/man1/trivet-library.1.gz bash-completion/completions/trivet
    zsh/site-functions/_trivet fish/vendor_completions.d/trivet.fish)
  if(NOT EXISTS "${prefix}/share/${page}")
    message(FATAL_ERROR "share/${page}: expected this page installed, found none")
  endif()
endforeach()
run(${CMAKE_COMMAND} -S "${CMAKE_CURRENT_LIST_DIR}" -B "${BUILD}/consumer" -G Ninja "-DCMAKE_CXX_COMPILER=${CXX}"
  "-DCMAKE_CXX_FLAGS=${FLAGS}" "-DCMAKE_PREFIX_PATH=${prefix}")
run(${CMAKE_COMMAND} --build "${BUILD}/consumer")
run("${BUILD}/consumer/consumer")

if(NOT DATA)
  return()
endif()
# Runs the program of docs/c.md, which has to find parts.
function(find_parts)
  execute_process(COMMAND ${ARGN} "${DATA}/parts.h5" "${DATA}/depths.u16" COMMAND_ECHO STDOUT
    COMMAND_ERROR_IS_FATAL ANY OUTPUT_VARIABLE found)
  message(STATUS "${found}")
  if(NOT found MATCHES "lever_0 score [01]\\.[0-9]+ at ")
    message(FATAL_ERROR "expected lever_0 among what was found")
  endif()
endfunction()

file(REMOVE_RECURSE "${BUILD}/c_consumer")
run(${CMAKE_COMMAND} -S "${CMAKE_CURRENT_LIST_DIR}/c" -B "${BUILD}/c_consumer" -G Ninja "-DCMAKE_C_COMPILER=${CC}"
  "-DCMAKE_C_FLAGS=${FLAGS}" "-DCMAKE_PREFIX_PATH=${prefix}" "-DGUIDE=${CMAKE_CURRENT_LIST_DIR}/../../docs/c.md")
run(${CMAKE_COMMAND} --build "${BUILD}/c_consumer")
find_parts("${BUILD}/c_consumer/find_parts")

# The example is built by pkg-config, too, from a prefix that was moved, and with the header alone in C++, without warnings.
find_program(PKG_CONFIG NAMES pkg-config pkgconf REQUIRED)
file(REMOVE_RECURSE "${BUILD}/prefix_moved")
file(RENAME "${prefix}" "${BUILD}/prefix_moved")
set(ENV{PKG_CONFIG_PATH} "${BUILD}/prefix_moved/${LIBDIR}/pkgconfig")
execute_process(COMMAND ${PKG_CONFIG} --cflags --libs trivet COMMAND_ERROR_IS_FATAL ANY OUTPUT_VARIABLE flags
  OUTPUT_STRIP_TRAILING_WHITESPACE)
separate_arguments(flags UNIX_COMMAND "${flags}")
separate_arguments(sanitize UNIX_COMMAND "${FLAGS}")
run(${CC} -std=c99 -Wall -Wextra -Wpedantic -Werror ${sanitize} "${BUILD}/c_consumer/find_parts.c" ${flags}
  -o "${BUILD}/c_consumer/by_pkg_config")
find_parts(${CMAKE_COMMAND} -E env "LD_LIBRARY_PATH=${BUILD}/prefix_moved/${LIBDIR}" "${BUILD}/c_consumer/by_pkg_config")
file(WRITE "${BUILD}/c_consumer/header.cpp" "#include <trivet.h>\nint main() { return trivet_version()[0] == 0; }\n")
run(${CXX} -std=c++98 -Wall -Wextra -Wpedantic -Wno-long-long -Werror -fsyntax-only "${BUILD}/c_consumer/header.cpp" ${flags})
