# Let the program write its manual pages and completions, and install them, and the unit of systemd.
# TRIVET is the built program, PAGES a folder to write into; MAN, DATA and SYSTEM are where they go, below the prefix;
# UNIT is the unit of a program in /usr/local/bin instead of BIN.
cmake_path(ABSOLUTE_PATH MAN BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")
cmake_path(ABSOLUTE_PATH DATA BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")
cmake_path(ABSOLUTE_PATH BIN BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")
cmake_path(ABSOLUTE_PATH SYSTEM BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")
function(write_page file)
  execute_process(COMMAND "${TRIVET}" ${ARGN} OUTPUT_FILE "${PAGES}/${file}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(MAKE_DIRECTORY "${PAGES}")
write_page(trivet.1 --man trivet)
file(READ "${PAGES}/trivet.1" main_page)
string(REGEX MATCHALL "trivet\\\\-[a-z\\-]+\\\\fR\\(1\\)" commands "${main_page}")  # names have the form trivet\-fit\-score\fR(1)
list(TRANSFORM commands REPLACE "trivet\\\\-([a-z\\-]+)\\\\fR\\(1\\)" "\\1")
list(TRANSFORM commands REPLACE "\\\\" "")
list(REMOVE_DUPLICATES commands)
set(manuals "${PAGES}/trivet.1")
foreach(command IN LISTS commands)
  write_page(trivet-${command}.1 --man ${command})
  list(APPEND manuals "${PAGES}/trivet-${command}.1")
endforeach()
write_page(trivet --completion bash)
write_page(_trivet --completion zsh)
write_page(trivet.fish --completion fish)

foreach(manual IN LISTS manuals)  # packed without name and time: the same bytes each time
  execute_process(COMMAND gzip -9nf "${manual}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
list(TRANSFORM manuals APPEND ".gz")
file(INSTALL ${manuals} DESTINATION "${MAN}/man1")
file(INSTALL "${PAGES}/trivet" DESTINATION "${DATA}/bash-completion/completions")
file(INSTALL "${PAGES}/_trivet" DESTINATION "${DATA}/zsh/site-functions")
file(INSTALL "${PAGES}/trivet.fish" DESTINATION "${DATA}/fish/vendor_completions.d")

file(READ "${UNIT}" unit)
if(CMAKE_INSTALL_PREFIX MATCHES "/_CPack_Packages/")  # an archive, which is unpacked elsewhere
  set(BIN /usr/local/bin)
endif()
string(REPLACE "/usr/local/bin" "${BIN}" unit "${unit}")
string(REGEX REPLACE "^#[^\n]*\n" "" unit "${unit}")  # how to install it
file(WRITE "${PAGES}/trivet.service" "${unit}")
file(INSTALL "${PAGES}/trivet.service" DESTINATION "${SYSTEM}")
