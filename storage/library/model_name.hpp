/// Names of models in libraries, manifests, results and on the command line.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace trivet {

/// The rule for model names, in words.
inline constexpr std::string_view kModelNameRule =
    "letters and digits of any script, dots, dashes and underscores, at most 128 bytes of UTF-8, "
    "with "
    "a letter or digit first and without '..'";

/// Valid names consist of [A-Za-z0-9._-] and of UTF-8 beyond ASCII except controls, blanks,
/// bidirectional marks and unassigned characters. They have 1 to 128 bytes, do not begin with any
/// of "._-" and do not contain "..". Names are equal if their bytes are.
bool is_model_name(std::string_view name);

/// The model name for a file name, without folder and extension, in Unicode normal form C so that
/// it is the same from all file systems. Invalid names are repaired: each run of other characters
/// becomes an underscore, each run of dots a dot. Dots, dashes and underscores at both ends and
/// bytes beyond 128 are removed. If nothing is left, the name is "model".
std::string model_name_of(const std::filesystem::path& file);

}  // namespace trivet
