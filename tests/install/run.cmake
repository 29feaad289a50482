# Install into a folder of its own, then build and run a program that uses what is there.
# usage: cmake -DBUILD=FOLDER -DCXX=COMPILER -DFLAGS=FLAGS -P run.cmake
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(prefix "${BUILD}/prefix")
file(REMOVE_RECURSE "${prefix}" "${BUILD}/consumer")
run(${CMAKE_COMMAND} --install "${BUILD}" --prefix "${prefix}")
run("${prefix}/bin/trivet" --version)
foreach(page man/man1/trivet.1 man/man1/trivet-fit-score.1 man/man1/trivet-library.1 bash-completion/completions/trivet
    zsh/site-functions/_trivet fish/vendor_completions.d/trivet.fish)
  if(NOT EXISTS "${prefix}/share/${page}")
    message(FATAL_ERROR "share/${page}: expected this page installed, found none")
  endif()
endforeach()
run(${CMAKE_COMMAND} -S "${CMAKE_CURRENT_LIST_DIR}" -B "${BUILD}/consumer" -G Ninja "-DCMAKE_CXX_COMPILER=${CXX}"
  "-DCMAKE_CXX_FLAGS=${FLAGS}" "-DCMAKE_PREFIX_PATH=${prefix}")
run(${CMAKE_COMMAND} --build "${BUILD}/consumer")
run("${BUILD}/consumer/consumer")
