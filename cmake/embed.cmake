# Make a file, or the files below a folder, a part of a target, as
#   std::span<const std::pair<std::string_view, std::string_view>> NAMESPACE::FUNCTION();  // paths and bytes
# A folder that is not there has no files.
function(trivet_embed target source_path namespace function)
  if(EXISTS "${source_path}" AND NOT IS_DIRECTORY "${source_path}")
    set(files "${source_path}")
    cmake_path(GET source_path PARENT_PATH folder)
  else()
    file(GLOB_RECURSE files CONFIGURE_DEPENDS "${source_path}/*")
    set(folder "${source_path}")
  endif()
  list(SORT files)
  set(entries "")
  set(blobs "")
  set(number 0)
  foreach(file IN LISTS files)
    file(RELATIVE_PATH path "${folder}" "${file}")
    string(APPEND blobs "extern \"C\" const char ${function}_${number}[], ${function}_${number}_end[];
__asm__(\".section .rodata\\n.global ${function}_${number}\\n.global ${function}_${number}_end\\n\"
        \"${function}_${number}:\\n.incbin \\\"${file}\\\"\\n${function}_${number}_end:\\n.byte 0\\n.text\\n\");\n")
    string(APPEND entries "      {\"${path}\", {${function}_${number}, ${function}_${number}_end}},\n")
    math(EXPR number "${number} + 1")
  endforeach()
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp")
  file(GENERATE OUTPUT "${source}" CONTENT
"#include <span>
#include <string_view>
#include <utility>
#include <vector>

${blobs}
namespace ${namespace} {
std::span<const std::pair<std::string_view, std::string_view>> ${function}();
std::span<const std::pair<std::string_view, std::string_view>> ${function}() {
  static const std::vector<std::pair<std::string_view, std::string_view>> files{
${entries}  };
  return files;
}
}  // namespace ${namespace}
")
  set_source_files_properties("${source}" PROPERTIES OBJECT_DEPENDS "${files}" SKIP_PRECOMPILE_HEADERS ON)
  target_sources(${target} PRIVATE "${source}")
endfunction()
